"""Claims of section 4: motion with and without heat, parameters, bifurcations."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from thermogear.base.arrays import Dataset
from thermogear.base.display import CELSIUS, PERCENT
from thermogear.base.parameters import PARAMETERS
from thermogear.base.vocabulary import UNDEFORMED, told_labels
from thermogear.dynamics.models import TorsionalModel
from thermogear.thesis import base_sets, motions
from thermogear.thesis.claim import Claim, Finding, Verdict, listed, verdict_of
from thermogear.thesis.evidence import Evidence

LABEL, CASCADE = "thermogear.analysis.labels.label", "thermogear.analysis.continuation.cascade"
DIAGRAM = "thermogear.analysis.diagram.orbit_diagram"
RUN, WARMING = "thermogear.study.run.run", "thermogear.thesis.motions.warming"
SET = "It holds for a set of numbers of ours, found by search; none is given."
SYMBOLS = {row: PARAMETERS[name].symbol for row, name in motions.SWEPT.items()}


def _no_torus(*models: TorsionalModel) -> str:
    """The argument against quasi-periodic motion of ``models``, with what is left of an area.

    A period of the excitation takes every area of the phase plane to exp(-4 pi zeta/omega_h) of
    itself (Liouville: the divergence is -2 zeta, the period 2 pi/omega_h).
    """
    left = [np.exp(-4.0 * np.pi * np.divide(m.damping_ratio, m.frequency)) for m in models]
    shown = " to ".join(f"{float(area):.3f}" for area in sorted(left))
    return (
        "Quasi-periodic motion is impossible in this equation: a period shrinks every area of the "
        f"phase plane to {shown} of itself here, so no closed curve can stay."
    )


def _points(e: Evidence, name: str, row: str) -> Dataset:
    """The points of one row of a ready-made case."""
    points = e.groups[f"base_sets/{name}"]
    return points.isel(point=np.flatnonzero(points["row"].values == row))


def _labels(e: Evidence, row: str) -> list[tuple[float, str]]:
    """(value, label in words) of the ready-made row."""
    here = _points(e, "table-4.2", row)
    return list(zip(here["value"].values.tolist(), told_labels(here).tolist(), strict=True))


def _solver(e: Evidence) -> Finding:
    found = motions.solver_orders(e.row_points)
    steps = np.log(found["steps"])
    smooth, kinked = (-np.polyfit(steps, np.log(found[n]), 1)[0] for n in ("smooth", "rattling"))
    return Finding(
        f"order {smooth:.2f} in lasting contact, {kinked:.2f} when the teeth rattle",
        f"event-exact maps; {int(found['steps'][-1])} Runge-Kutta steps a period are "
        f"{found['rattling'][-1]:.1e} off after 8 periods",
        Verdict.REPRODUCED,
        "The solver works, but it is of fourth order only while no edge of the backlash is "
        "crossed; labels here rest on the exact maps.",
    )


def _four_views(e: Evidence) -> Finding:
    motion = e.groups["motion"]
    needed = ("displacement", "velocity", "section_displacement", "line_amplitude")
    have = [name for name in needed if name in motion]
    return Finding(
        f"{len(have)} of {len(needed)} views stored for {motion['label'].size} motions of the rig",
        "history, phase plane, section and spectrum, undeformed and hot",
        verdict_of(len(have) == len(needed)),
        "All four are drawn for both cases.",
    )


def _cold_motion(e: Evidence) -> Finding:
    w = e.warming.sel(row="thesis").isel(temperature=0)
    rig = e.groups["motion"]["label"].sel(state=UNDEFORMED).values.ravel()
    return Finding(
        f"{w['label'].item()}, {int(w['section_points'])} section point, multiplier "
        f"{float(w['multiplier']):.4f}",
        f"the rig undeformed: {', '.join(sorted(set(map(str, rig))))} at every speed",
        verdict_of(w["label"].item() == "period-1", assumption=True),
        f"{SET} Both repeat with the mesh.",
    )


def _less_stable(e: Evidence) -> Finding:
    thesis, right = (e.warming["multiplier"].sel(row=r).values for r in ("thesis", "consistent"))
    flip = CELSIUS(float(e.warming["flip"].sel(row="thesis")))
    return Finding(
        f"largest multiplier {thesis[0]:.4f} cold; period doubling at {flip:.4g} °C",
        f"{right[0]:.4f} cold to {right[-1]:.4f} hottest: ever further from its loss",
        Verdict.ASSUMED if thesis[1] > thesis[0] else Verdict.CONTRADICTED,
        "It does if heat stiffens the mesh, as the document has it. With the stiffness falling as "
        "E(T) does, the same motion becomes more stable. " + SET,
    )


def _fluctuates(e: Evidence) -> Finding:
    here = _points(e, "section-4.1", "thesis")
    half = here["half_order_amplitude"].values
    swing = here["peak_to_peak_displacement"].values
    return Finding(
        f"half-order amplitude {listed(np.where(half < 1e-9, 0.0, half))} over the temperatures",
        f"swing {listed(swing, '.4g')}, in half backlashes",
        verdict_of(bool(half[-1] > 1e-6), assumption=True),
        "Past the flip every second mesh period differs: the history alternates. With the "
        "consistent sign nothing of it appears.",
    )


def _thicker(e: Evidence) -> Finding:
    w = e.warming
    turns = [w["section_points"].sel(row=r).values for r in ("thesis", "consistent")]
    return Finding(
        f"the orbit closes after {listed(turns[0], '.0f')} periods as temperature rises",
        f"{listed(turns[1], '.0f')} periods",
        verdict_of(int(turns[0][-1]) > 1, assumption=True),
        "Two loops beside each other look like one thick line; it is an orbit of two periods.",
    )


def _spread(e: Evidence) -> Finding:
    w = e.warming.sel(row="thesis")
    count = w["section_points"].values
    return Finding(
        f"settled section of {listed(count, '.0f')} points over the temperatures",
        "the same",
        verdict_of(bool(count[-1] > 8)),
        "A settled motion of two periods has two points, however hot. A region of points is a "
        "transient not waited for, or chaos, which is not met here.",
    )


def _half_line(e: Evidence) -> Finding:
    lines = {
        row: _points(e, "section-4.1", row)["half_order_amplitude"].values
        for row in ("thesis", "consistent")
    }
    return Finding(
        f"{listed(np.where(lines['thesis'] < 1e-9, 0.0, lines['thesis']))} half backlashes",
        f"at most {lines['consistent'].max():.1e}",
        verdict_of(bool(lines["thesis"][-1] > lines["thesis"][0] + 1e-6), assumption=True),
        "With heat as the document has it (stiffening) and a set next to a flip. Falling stiffness "
        "moves away from it.",
    )


def _to_torus(e: Evidence) -> Finding:
    w = e.warming.sel(row="thesis")
    return Finding(
        f"{w['label'].values[0]} to {w['label'].values[-1]}",
        "a half-frequency line is the mark of period doubling",
        verdict_of("quasi" in str(w["label"].values[-1])),
        _no_torus(motions.hottest(e.rows("section-4.1"), "thesis")),
    )


def _end(e: Evidence, row: str, place: int, wanted: tuple[str, ...], why: str = "") -> Finding:
    value, name = _labels(e, row)[place]
    holds = name.split(" for ")[0] in wanted
    return Finding(
        f"{name} at {SYMBOLS[row]} = {value:g}",
        "the same equation",
        verdict_of(holds, assumption=True),
        why or SET,
    )


def _torus_end(e: Evidence, row: str, place: int) -> Finding:
    model = e.row_points.model("none", **{motions.SWEPT[row]: e.row_points.ends[row][place]})
    return _end(e, row, place, ("quasi-periodic",), _no_torus(model))


def _multiplier_grows(e: Evidence) -> Finding:
    data = e.diagrams["zeta/none"].sel(direction=-1).isel(start=0)
    mu = np.hypot(data["multiplier_real"].values, data["multiplier_imag"].values)
    periodic, chaos = (int((data["label"].values == name).sum()) for name in (1, 2))
    lost = float(e.flips["value"].sel(row="zeta", heat="none").values[0])
    return Finding(
        f"multiplier {mu[-1]:.3f} at the start, 1 at ζ = {lost:.6f}; {periodic} values periodic, "
        f"{chaos} chaotic by the faster rule",
        "the same equation",
        verdict_of(motions.stability_falls(e.diagrams["zeta/none"]), assumption=True),
        "The multiplier of the first motion rises at every step down to its loss, and every period "
        f"loses its stability in turn. {SET}",
    )


def _omega_complex(e: Evidence) -> Finding:
    names = motions.sequence(e.diagrams["omega/none"], falling=False)
    return Finding(
        ", ".join(names) + " as ω_h rises",
        f"with E(T): {', '.join(motions.sequence(e.diagrams['omega/consistent'], falling=False))}",
        verdict_of(len(names) > 3, assumption=True),
        "A cascade run backwards, with windows. " + SET,
    )


def _epsilon_double(e: Evidence) -> Finding:
    first, second = e.flips["value"].sel(row="epsilon", heat="none").values[:2]
    names = [name for _, name in _labels(e, "epsilon")]
    return Finding(
        f"period-2 between ε = {first:.6f} and {second:.6f}",
        f"labels along the row: {', '.join(names)}",
        verdict_of("period-2" in names, assumption=True),
        SET,
    )


def _route(e: Evidence, row: str, falling: bool, wanted: tuple[str, ...]) -> Finding:
    names = motions.sequence(e.diagrams[f"{row}/none"], falling)
    hot = motions.sequence(e.diagrams[f"{row}/consistent"], falling)
    values = e.flips["value"].sel(row=row, heat="none").values
    gaps = np.diff(values[np.isfinite(values)])
    ratios = gaps[:-1] / gaps[1:]
    return Finding(
        f"{', '.join(names)}; flips at {listed(values, '.6f')}",
        f"with E(T): {', '.join(hot)}",
        verdict_of(all(name in names for name in wanted), assumption=True),
        f"Successive flips come nearer by factors of {listed(ratios)} (4.67 in the limit): period "
        f"doubling into chaos. {SET}",
    )


def _two_to_one(e: Evidence) -> Finding:
    flip = float(e.flips["value"].sel(row="omega", heat="none").values[0])
    ends = _labels(e, "omega")
    return Finding(
        f"period-2 below and period-1 above ω_h = {flip:.7f}",
        f"{ends[-1][1]} at {ends[-1][0]:g}, {ends[0][1]} at {ends[0][0]:g}",
        verdict_of(ends[0][1] == "period-1" and np.isfinite(flip), assumption=True),
        SET,
    )


def _amplitude_grows(e: Evidence) -> Finding:
    first, last = e.row_points.ends["omega"]
    spread = [motions.swing(e.row_points.model("none", frequency=value)) for value in (last, first)]
    (low_std, low), (high_std, high) = spread
    return Finding(
        f"standard deviation {low_std:.3f} at ω_h = {last:g}, {high_std:.3f} at {first:g}",
        f"peak to peak {low:.3f} and {high:.3f}, in half backlashes",
        verdict_of(high_std > low_std),
        "In the set that shows the other rows the amplitude falls. No set with a constant F_h was "
        "found in which the motion becomes simpler and larger at once.",
    )


def _diagrams(e: Evidence) -> Finding:
    values = next(iter(e.diagrams.values())).sizes["direction"]
    count = len(e.diagrams)
    return Finding(
        f"{count} diagrams over ζ, ω_h and ε, {values} directions each",
        "without heat, with the document's heat, with E(T)",
        verdict_of(count == 9, assumption=True),
        f"Heat is that at {CELSIUS(e.row_points.temperature):.0f} °C. {SET}",
    )


def _beside(e: Evidence, heat: str) -> int:
    """Values of the three diagrams at which the two directions end on different motions."""
    return sum(motions.coexisting(e.diagrams[f"{row}/{heat}"]) for row in motions.SWEPT)


def _structure(e: Evidence) -> Finding:
    counts = {
        heat: np.isfinite(e.flips["value"].sel(heat=heat).values).sum(axis=-1).tolist()
        for heat in motions.HEATS[:3]
    }

    def said(heat: str) -> str:
        return ", ".join(
            f"{SYMBOLS[row]} {count}"
            for row, count in zip(motions.SWEPT, counts[heat], strict=True)
        )

    return Finding(
        f"flips up to the range's end, {e.size.flips} at most: {said('none')} without, "
        f"{said('thesis')} with heat",
        f"{said('consistent')} with E(T); values with a second motion beside: "
        f"{_beside(e, 'none')} without, {_beside(e, 'thesis')} and {_beside(e, 'consistent')} "
        "with heat",
        verdict_of(counts["none"] == counts["thesis"] == counts["consistent"], assumption=True),
        "Over ζ and ε the cascade stays and shifts. Over ω_h it stays too unless the smaller gap "
        "lets the teeth hit the back side. Section 4.1 itself has heat change the period.",
    )


def _zeta_sequence(e: Evidence, wanted: str) -> Finding:
    names = motions.sequence(e.diagrams["zeta/none"], falling=True)
    ends = [e.row_points.model("none", damping_ratio=zeta) for zeta in e.row_points.ends["zeta"]]
    return Finding(
        f"as ζ falls: {', '.join(names)}",
        f"with E(T): {', '.join(motions.sequence(e.diagrams['zeta/consistent'], falling=True))}",
        verdict_of(wanted in names, assumption=True),
        _no_torus(*ends) if wanted == "quasi-periodic" else SET,
    )


def _same_points(e: Evidence) -> Finding:
    first = e.flips["value"].sel(flip=1)
    cold = first.sel(heat="none").values
    shifts = {
        heat: PERCENT(first.sel(heat=heat).values / cold - 1.0)
        for heat in ("thesis", "consistent", "backlash")
    }
    worst = max(abs(x) for x in shifts["backlash"])
    return Finding(
        f"first flip moves by {listed(shifts['thesis'], '+.2f')} % (ζ, ω_h, ε)",
        f"{listed(shifts['consistent'], '+.2f')} %; the closing gap alone moves it by "
        f"{worst:.1e} %",
        verdict_of(max(abs(x) for x in shifts["thesis"]) < 10.0, assumption=True),
        "While no tooth hits the back side the gap can be moved out of the equation: it cannot "
        "shift a bifurcation. What shifts it is the stiffness, up or down with its sign.",
    )


def _scattered(e: Evidence) -> Finding:
    extra = {key: motions.scatter(data) for key, data in e.diagrams.items()}
    hot = max(v for key, v in extra.items() if not key.endswith("none"))
    cold = max(v for key, v in extra.items() if key.endswith("none"))
    return Finding(
        f"points of a periodic section beyond its period: {cold} without, {hot} with heat",
        "the same",
        verdict_of(hot > cold),
        "A settled orbit of n periods has n points. Scatter is what a transient leaves that is not "
        "waited for; near a flip that takes hundreds of periods. With heat some values have a "
        "second motion beside the first, which a diagram from several starts shows too.",
    )


def _indicates(e: Evidence) -> Finding:
    v = e.flips["value"].sel(row="zeta")
    cold, thesis, right = (float(v.sel(heat=h)[0]) for h in ("none", "thesis", "consistent"))
    return Finding(
        f"period-1 is lost at ζ = {thesis:.4f} instead of {cold:.4f}",
        f"at {right:.4f} with E(T): heat makes it last longer",
        verdict_of(thesis > cold, assumption=True),
        "True for a stiffening by heat, false for the softening that steel shows; the scatter it "
        "is inferred from does not exist.",
    )


_P = "4.2, table"
_ROWS = (
    ("4.1.1", "4.1", "statement", "The equation is solved by Runge-Kutta of fourth order.", _solver,
     ("thermogear.thesis.motions.solver_orders", "thermogear.dynamics.integrate.simulate"), ""),
    ("4.1.2", "4.1", "statement",
     "History, phase plane, section and spectrum are had for both cases.", _four_views, (RUN,),
     "base-1-0"),
    ("4.1.3", "4.1", "statement", "Without heat the motion is stable and of one period.",
     _cold_motion, (LABEL, WARMING), "base-1-0"),
    ("4.1.4", "4.1", "statement", "With heat the motion is less stable.", _less_stable,
     (WARMING, "thermogear.analysis.continuation.continuation"), "warming"),
    ("4.1.5", "4.1", "statement", "From 100 to 160 °C the history fluctuates more.", _fluctuates,
     (RUN,), "base-1-0"),
    ("4.1.6", "4.1", "statement", "From 100 to 160 °C the phase trajectory thickens.", _thicker,
     (WARMING,), "base-1-0"),
    ("4.1.7", "4.1", "statement", "From 100 to 160 °C the section's points spread out.", _spread,
     (WARMING,), "base-1-0"),
    ("4.1.8", "4.1", "statement", "A line at half the frequency grows.", _half_line, (RUN,),
     "base-1-0"),
    ("4.1.9", "4.1", "statement", "The line marks a passage to quasi-periodic motion.", _to_torus,
     (LABEL,), "base-1-0"),
    ("4.2.1", _P, "table entry", "ζ from 0.18: of one period.",
     lambda e: _end(e, "zeta", 0, ("period-1",)), (LABEL, RUN), "diagram-zeta"),
    ("4.2.2", _P, "table entry", "ζ to 0.10: quasi-periodic.",
     lambda e: _torus_end(e, "zeta", -1), (LABEL, RUN), "diagram-zeta"),
    ("4.2.3", _P, "table entry", "Stability falls with ζ.", _multiplier_grows, (DIAGRAM,),
     "diagram-zeta"),
    ("4.2.4", _P, "table entry", "ω_h from 1.1: quasi-periodic.",
     lambda e: _torus_end(e, "omega", -1), (LABEL, RUN), "diagram-omega"),
    ("4.2.5", _P, "table entry", "ω_h to 1.3: periodic and more stable.",
     lambda e: _end(e, "omega", 0, ("period-1", "period-2")),
     (LABEL, RUN), "diagram-omega"),
    ("4.2.6", _P, "table entry", "Between, the bifurcations are complex.", _omega_complex,
     (DIAGRAM,), "diagram-omega"),
    ("4.2.7", _P, "table entry", "ε from 0.1: of one period.",
     lambda e: _end(e, "epsilon", 0, ("period-1",)), (LABEL, RUN), "diagram-epsilon"),
    ("4.2.8", _P, "table entry", "Then of two periods.", _epsilon_double, (LABEL, CASCADE),
     "diagram-epsilon"),
    ("4.2.9", _P, "table entry", "ε to 0.9: quasi-periodic.",
     lambda e: _torus_end(e, "epsilon", -1), (LABEL, RUN), "diagram-epsilon"),
    ("4.2.10", "4.2", "statement", "Less damping leads over several periods to chaos.",
     lambda e: _route(e, "zeta", True, ("period-1", "period-2", "chaotic")), (DIAGRAM, CASCADE),
     "diagram-zeta"),
    ("4.2.11", "4.2", "statement",
     "Raising the frequency passes a bifurcation from two periods to one.", _two_to_one,
     (CASCADE,), "diagram-omega"),
    ("4.2.12", "4.2", "statement", "With it the vibration grows.", _amplitude_grows,
     ("thermogear.thesis.motions.swing", "thermogear.dynamics.integrate.simulate"),
     "diagram-omega"),
    ("4.2.13", "4.2", "statement", "A larger ε doubles periods on the way to chaos.",
     lambda e: _route(e, "epsilon", False, ("period-1", "period-2", "period-4", "chaotic")),
     (DIAGRAM, CASCADE), "diagram-epsilon"),
    ("4.3.1", "4.3", "statement",
     "Diagrams over ζ, ω_h and ε were drawn with and without heat.", _diagrams, (DIAGRAM,),
     "diagram-zeta"),
    ("4.3.2", "4.3", "statement", "Heat acts mainly on stability, and not on the structure.",
     _structure, (CASCADE, "thermogear.thesis.motions.flips"), "diagram-omega"),
    ("4.3.3", "4.3", "statement", "Over ζ: one period is met.",
     lambda e: _zeta_sequence(e, "period-1"), (DIAGRAM,), "diagram-zeta"),
    ("4.3.4", "4.3", "statement", "Over ζ: two periods are met.",
     lambda e: _zeta_sequence(e, "period-2"), (DIAGRAM,), "diagram-zeta"),
    ("4.3.5", "4.3", "statement", "Over ζ: four periods are met.",
     lambda e: _zeta_sequence(e, "period-4"), (DIAGRAM,), "diagram-zeta"),
    ("4.3.6", "4.3", "statement", "Over ζ: quasi-periodic motion is met.",
     lambda e: _zeta_sequence(e, "quasi-periodic"), (DIAGRAM,), "diagram-zeta"),
    ("4.3.7", "4.3", "statement", "Over ζ: chaos is met.",
     lambda e: _zeta_sequence(e, "chaotic"), (DIAGRAM,), "diagram-zeta"),
    ("4.3.8", "4.3", "statement", "With and without heat the bifurcations lie nearly alike.",
     _same_points, (CASCADE, "thermogear.thesis.motions.flips"), "diagram-zeta"),
    ("4.3.9", "4.3", "statement", "With heat the section's points are more scattered.", _scattered,
     (DIAGRAM, "thermogear.thesis.motions.scatter"), "diagram-zeta"),
    ("4.3.10", "4.3", "statement", "So heat makes periodic motion less stable.", _indicates,
     (CASCADE,), "warming"),
)  # fmt: skip

IMPOSSIBLE = ("4.1.7", "4.3.9", *base_sets.TORUS)
"""Statements that an argument excludes for settled motion, in whatever base set."""
NO_SET = "It says nothing of a base set, so it has no share of the sampled ones."
CHOSEN = (
    "It holds for all {count} sampled base sets by choice (100 %, no interval): a set is kept "
    "where all three rows begin at period-1 and end in chaos."
)
DRAWN = "All nine are drawn for each of the {count} sampled base sets, so it has no interval."
WITHOUT_INTERVAL = {
    "4.1.1": NO_SET, "4.1.2": NO_SET, "4.2.1": CHOSEN, "4.2.5": CHOSEN, "4.2.7": CHOSEN,
    "4.3.1": DRAWN, "4.3.3": CHOSEN,
}  # fmt: skip
"""Claims that no sampled base set can decide -> why."""


def _over_sets(claim: Claim) -> Claim:
    """A claim whose verdict is its share of the sampled base sets, or which says why it is none."""

    def judge(e: Evidence) -> Finding:
        finding, count = claim.judge(e), len(e.base_sets)
        if claim.number in WITHOUT_INTERVAL:
            why = WITHOUT_INTERVAL[claim.number].format(count=count)
            return replace(finding, argument=f"{finding.argument} {why}")
        hits, low, high = base_sets.share(e.base_sets, claim.number)
        excluded = Verdict.CONTRADICTED if claim.number in IMPOSSIBLE else Verdict.UNDECIDED
        open_sets = sum(claim.number not in base_set.holds for base_set in e.base_sets)
        share = (
            f"It holds for {hits} of {count} sampled base sets that meet the table"
            f"{f', {open_sets} of them not judged' * (open_sets > 0)} "
            f"({PERCENT(hits / count):.0f} %, 95 % interval {PERCENT(low):.0f} to "
            f"{PERCENT(high):.0f} %)."
        )
        return replace(
            finding,
            verdict=Verdict.ASSUMED if hits else excluded,
            argument=f"{finding.argument} {share}",
        )

    return replace(claim, judge=judge)


CLAIMS = tuple(_over_sets(Claim(*row)) for row in _ROWS)
