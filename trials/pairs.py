"""Random gear pairs through the quasi-static chain, relief and motion: what must never happen.

``make trial NAME=pairs`` draws until 2 000 pairs are valid (seed fixed before the first run),
computes
each cold and hot with deviations of every kind, designs a relief, moves it, exchanges and scales
it, and writes trials/records/pairs.md. ``python trials/pairs.py 50`` prints a short one.
"""

from __future__ import annotations

import sys
import time
import warnings
from collections import Counter
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from thermogear import Gear, GearPair, MeshModel, Operating, Temperatures, mesh_cycle, simulate
from thermogear.base.errors import InputError
from thermogear.base.materials import LUBRICANTS
from thermogear.base.units import ZERO_CELSIUS
from thermogear.base.vocabulary import STATUS
from thermogear.dynamics.models import from_excitation
from thermogear.gears.deviations import (
    BasePitchDifference,
    Deviation,
    FlankTable,
    PathTable,
    PitchError,
    PressureAngleError,
    Relief,
)
from thermogear.gears.loaded import loaded_contact
from thermogear.gears.relief import optimise_tip_relief
from thermogear.mesh.excite import excitation
from thermogear.mesh.thermal import HotPair, ThermalDeviation

Floats = NDArray[np.float64]
Random = np.random.Generator

SEED = 13_2026
PAGE = Path(__file__).parents[1] / "trials" / "records" / "pairs.md"
POSITIONS = 2000
STEP = 0.01
NEAR = 3
"""Positions beside a change of the contact set that are not compared."""
FINER = 20
"""A pair that nearly leaves is steep, not broken: what is no step falls with finer positions."""
SEARCH = 6
"""Evaluations from each start of the search for a relief: most of a trial's time goes there."""
SOMETIMES_NONE = {"jam_temperature", "proportional_jam_temperature"}
"""Heat that never closes the gap has no jam temperature."""
NO_CORNERS = {"edge_contact_share"}
"""The textbook's springs know no corner."""
FILM = ("film_thickness", "film_parameter")
"""Boundless where a pair carries nothing."""
EDGE = {"contact_pressure"}
"""Not valid where a tip corner carries; the data say where."""


@dataclass(frozen=True)
class Drawn:
    """One random pair with its state; plain numbers, so that the draw costs nothing."""

    pair: GearPair
    deviations: tuple[Deviation, ...]
    operating: Operating


@dataclass
class Found:
    """What one pair showed: counts of what must not happen, and the worst of each symmetry."""

    counts: Counter[str] = field(default_factory=Counter)
    worst: dict[str, float] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)

    def see(self, what: str, value: float) -> None:
        self.worst[what] = max(self.worst.get(what, 0.0), value)


def draw_pair(rng: Random) -> GearPair:
    """10 to 150 teeth, 14.5 to 28 deg, x -0.6 to 0.9, rims from one module, 0.5 to 20 mm."""
    module = float(np.exp(rng.uniform(np.log(0.5e-3), np.log(20e-3))))
    angle = float(np.radians(rng.uniform(14.5, 28.0)))
    teeth, shifts = rng.integers(10, 151, 2), rng.uniform(-0.6, 0.9, 2)
    rims, widths = rng.uniform(1.0, 8.0, 2), rng.uniform(3.0, 20.0, 2)
    opened, roughness = rng.choice([0.0, rng.uniform(0.0, 0.08)]), rng.uniform(0.05e-6, 1e-6, 2)
    gears = []
    for z, x, rim, width, ra in zip(teeth, shifts, rims, widths, roughness, strict=True):
        root = (0.5 * z - 1.25 + x) * module
        gears.append(
            Gear(
                int(z),
                module,
                pressure_angle=angle,
                profile_shift=float(x),
                face_width=float(width) * module,
                bore_radius=float(max(root - rim * module, 0.2 * root)),
                roughness=float(ra),
            )
        )
    tight = GearPair(*gears)
    return GearPair(*gears, tight.centre_distance + opened * module) if opened else tight


def draw_deviations(rng: Random, pair: GearPair) -> tuple[Deviation, ...]:
    """Some of every kind; heights in modules as grades from fine to coarse have them."""
    module, active = pair.pinion.module, pair.path.e - pair.path.a
    sides = ("both", "both", "drive", "back")
    found: list[Deviation] = []

    def height(most: float) -> float:
        return float(module * rng.uniform(0.0, most))

    for gear, body in (("pinion", pair.pinion), ("wheel", pair.wheel)):
        for end in ("tip", "root"):
            if rng.random() < 0.5:
                shape = ("linear", "parabolic")[int(rng.integers(2))]
                length = float(active * rng.uniform(0.05, 0.9))
                side = sides[int(rng.integers(4))]
                found.append(
                    Relief(
                        gear, amount=height(0.015), length=length, end=end, shape=shape, flank=side
                    )
                )
        if rng.random() < 0.3:
            found.append(PressureAngleError(gear, float(rng.uniform(-2e-3, 2e-3))))
        if rng.random() < 0.3:
            radius = np.linspace(body.form_radius, body.tip_radius, int(rng.integers(2, 30)))
            added = module * rng.uniform(-2e-3, 2e-3, radius.size)
            found.append(
                FlankTable(gear, radius=radius, added=added, flank=sides[int(rng.integers(4))])
            )
        if rng.random() < 0.2:
            errors = module * rng.uniform(-2e-3, 2e-3, body.teeth)
            found.append(PitchError(gear, tuple(errors)))
    if rng.random() < 0.3:
        s = np.sort(rng.uniform(pair.path.a, pair.path.e, int(rng.integers(2, 9))))
        found.append(PathTable(s=s, added=module * rng.uniform(-2e-3, 2e-3, s.size)))
    if rng.random() < 0.3:
        found.append(BasePitchDifference(float(rng.uniform(-5e-4, 5e-4))))
    return tuple(found)


def draw_operating(rng: Random, pair: GearPair) -> Operating:
    """Bodies and housing -20 to 160 degC each, loads from hardly any to heavy, any speed."""
    bodies = ZERO_CELSIUS + rng.uniform(-20.0, 160.0, 5)
    module = pair.pinion.module
    line_load = 1e6 * module / 1e-3 * float(np.exp(rng.uniform(np.log(1e-3), np.log(0.08))))
    torque = line_load * pair.face_width * pair.pinion.base_radius
    tip_speed = float(np.exp(rng.uniform(np.log(0.1), np.log(60.0))))
    oils = [one for _, one in sorted(LUBRICANTS.items())]
    return Operating(
        speed=np.array([tip_speed / pair.pinion.tip_radius]),
        torque=np.array([torque]),
        lubricant=oils[int(rng.integers(len(oils)))],
        oil_temperature=ZERO_CELSIUS + float(rng.uniform(20.0, 120.0)),
        temperatures=Temperatures(
            reference=ZERO_CELSIUS + 20.0,
            pinion_addendum=float(bodies[0]),
            pinion_bore=float(bodies[1]),
            wheel_addendum=float(bodies[2]),
            wheel_bore=float(bodies[3]),
            housing=float(bodies[4]),
        ),
        half_backlash=float(module * rng.uniform(0.01, 0.06)),
    )


def draws(count: int, seed: int = SEED) -> tuple[list[Drawn], Counter[str]]:
    """``count`` valid pairs and what refused the others, by reason."""
    rng = np.random.default_rng(seed)
    found: list[Drawn] = []
    refused: Counter[str] = Counter()
    while len(found) < count:
        try:
            pair = draw_pair(rng)
        except InputError as error:
            refused[reason(error)] += 1
            continue
        found.append(Drawn(pair, draw_deviations(rng, pair), draw_operating(rng, pair)))
    return found, refused


def reason(error: InputError) -> str:
    """Why a pair was refused, without its numbers."""
    text = error.why or str(error)
    for words in ("interference", "pointed", "undercut", "hits", "contact ratio"):
        if words in text:
            return words
    return "no meshing position" if "meshing position" in text else error.field


WHOLE = np.arange(POSITIONS) / POSITIONS


def trial(drawn: Drawn, search: bool = True, phase: Floats = WHOLE) -> Found:
    """All that one pair is put through; ``search`` for a relief too, which takes longest.

    ``phase`` where the loaded contact is solved, neighbours 1/:data:`POSITIONS` apart.
    """
    found = Found()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for name, step in (
            ("cycle", cycles),
            ("contact", partial(contacts, phase=phase)),
            ("symmetry", symmetries),
            *((("relief", reliefs),) if search else ()),
        ):
            try:
                step(drawn, found)
            except Exception as error:  # the trial counts every kind
                found.counts["exceptions"] += 1
                found.notes.append(f"{name}: {type(error).__name__}: {error}")
    return found


def cycles(drawn: Drawn, found: Found) -> None:
    """Cold and hot cycle under both bundles, then the motion of the consistent one."""
    cold = replace(drawn.operating, temperatures=drawn.operating.temperatures.cold())
    for model in (MeshModel.consistent(), MeshModel.thesis()):
        textbook = model.stiffness != "loaded"
        for operating in (cold, drawn.operating):
            cycle = mesh_cycle(
                drawn.pair,
                operating,
                model,
                deviations=drawn.deviations,
                path_positions=61,
                mesh_positions=128,
            )
            status = STATUS[int(cycle["status"][0])]
            found.counts[status] += 1
            film = {name: cycle[name].where(cycle["line_load"] > 0.0, 0.0) for name in FILM}
            corner = cycle["edge_contact"] > 0
            flanks = {"hertz_pressure": cycle["hertz_pressure"].where(~corner, 0.0)}
            allowed = SOMETIMES_NONE | (NO_CORNERS if textbook else set())
            count_nan(cycle.assign(film | flanks), found, allowed)
            if float(cycle["load_share"].min()) < 0.0:
                found.counts["negative shares"] += 1
            if float(cycle["mesh_stiffness"].min()) <= 0.0:
                found.counts["stiffness not above 0"] += 1
            if model.name.startswith("consistent") and status == "ok":
                move(drawn, cycle, found)


def move(drawn: Drawn, cycle: xr.Dataset, found: Found) -> None:
    """A few periods of the motion from rest."""
    (excited,) = excitation(cycle, drawn.pair, damping_ratio=0.05)
    assert excited is not None
    run = simulate(from_excitation(excited), periods=8, discard=16, samples_per_period=16)
    found.counts["motions"] += 1
    if not all(np.all(np.isfinite(run[name].values)) for name in ("x", "v")):
        found.counts["NaN"] += 1
        found.notes.append("motion: not finite")


def count_nan(data: xr.Dataset, found: Found, allowed: set[str]) -> None:
    """Count the variables that hold a NaN without leave."""
    for name, values in data.data_vars.items():
        if name in allowed or values.dtype.kind != "f":
            continue
        if not np.all(np.isfinite(values.values)):
            found.counts["NaN"] += 1
            found.notes.append(f"NaN in {name}")


def hot_flanks(drawn: Drawn) -> tuple[Deviation, ...]:
    """The deviations with the growth of the hot gears among them."""
    hot = HotPair(drawn.pair, drawn.operating, MeshModel.consistent())
    return (*drawn.deviations, ThermalDeviation(hot))


def contacts(drawn: Drawn, found: Found, phase: Floats) -> None:
    """The hot pair's contact at many positions: shares, balance, and no step without a cause."""
    force = drawn.operating.torque / drawn.pair.pinion.base_radius
    deviations = hot_flanks(drawn)
    for flank in ("drive", "back"):
        mesh = loaded_contact(
            drawn.pair, force, phase, deviations=deviations, flank=flank
        ).squeeze()
        found.counts["not converged"] += int((mesh["status"].values != 0).sum())
        count_nan(mesh, found, EDGE)
        share = mesh["load_share"].values
        found.counts["negative shares"] += int((share < 0.0).sum())
        found.see("shares off 1", float(np.abs(share.sum(axis=-1) - 1.0).max()))
        stiffness = mesh["tangent_stiffness"].values
        steps = np.abs(np.diff(stiffness)) / stiffness[1:]
        # beyond either end of the window a change may be near
        ends = (-1, len(phase) - 1)
        changed = [*ends, *np.flatnonzero(np.any(np.diff(share > 0.0, axis=0), axis=1))]
        for place in changed:
            steps[max(place - NEAR, 0) : max(place + NEAR + 1, 0)] = 0.0
        for place in np.flatnonzero(steps > STEP).tolist():
            found.counts["steep places"] += 1
            fine = np.linspace(phase[place], phase[place + 1], FINER + 1)
            near = loaded_contact(drawn.pair, force, fine, deviations=deviations, flank=flank)[
                "tangent_stiffness"
            ].values.ravel()
            left = float((np.abs(np.diff(near)) / near[1:]).max())
            found.see("step at a steep place, looked at closer", left)
            if left > STEP:
                found.counts["steps above 1 %"] += 1
                found.notes.append(f"{flank}: step {left:.4f} at {place}")
        found.see("step", float(steps.max()))


def symmetries(drawn: Drawn, found: Found) -> None:
    """Gears exchanged, and everything twice as large: the same mesh."""
    pair = drawn.pair
    force = float(drawn.operating.torque[0]) / pair.pinion.base_radius
    # teeth have other numbers in the exchanged pair
    own = [d for d in drawn.deviations if not isinstance(d, PitchError)]
    phase = (np.arange(40) + 0.37) / 40.0  # whole periods choose the teeth
    here = loaded_contact(pair, force, phase, deviations=own)
    other = pair.swapped()
    there = loaded_contact(
        other,
        force,
        (pair.path.e - pair.path.a) / pair.base_pitch - phase,
        deviations=[exchanged(d, pair) for d in own],
    )
    large = scaled(pair, 2.0)
    twice = loaded_contact(large, 4.0 * force, phase, deviations=[enlarged(d, 2.0) for d in own])
    # beyond the path the lever is that about the pinion: exchanged pairs differ where one carries
    flanks = on_path(pair, here) & on_path(other, there)
    everywhere = np.ones_like(flanks)
    for what, other_mesh, factor, where in (
        ("exchange", there, 1.0, flanks),
        ("scale", twice, 2.0, everywhere),
    ):
        for name in ("tangent_stiffness", "transmission_error"):
            known = here[name].values
            apart = np.abs(other_mesh[name].values / factor - known)[where] / np.abs(known).max()
            found.see(f"{what}, {name.replace('_', ' ')}", float(apart.max(initial=0.0)))
    found.counts["positions on the path alone"] += int(flanks.sum())


def on_path(pair: GearPair, mesh: xr.Dataset) -> NDArray[np.bool_]:
    """Positions at which nothing carries before A or beyond E."""
    s, share = mesh["pair_position"].values, mesh["load_share"].values
    return ~np.any((share > 0.0) & ((s < pair.path.a) | (s > pair.path.e)), axis=-1)


def exchanged(deviation: Deviation, pair: GearPair) -> Deviation:
    """The same deviation of the pair with its gears exchanged."""
    if isinstance(deviation, PathTable):
        s, added = np.asarray(deviation.s), np.asarray(deviation.added)
        return replace(deviation, s=(pair.line_of_action - s)[::-1], added=added[::-1])
    if isinstance(deviation, BasePitchDifference):
        return BasePitchDifference(-np.asarray(deviation.strain))
    assert isinstance(deviation, Relief | PressureAngleError | FlankTable)
    return replace(deviation, gear="wheel" if deviation.gear == "pinion" else "pinion")


def scaled(pair: GearPair, factor: float) -> GearPair:
    """The pair with every length times ``factor``."""
    lengths = ("module", "face_width", "bore_radius", "tip_radius")
    gears = [
        replace(gear, **{name: factor * getattr(gear, name) for name in lengths})
        for gear in (pair.pinion, pair.wheel)
    ]
    return GearPair(*gears, factor * pair.centre_distance)


def enlarged(deviation: Deviation, factor: float) -> Deviation:
    """The deviation with every length times ``factor``."""
    if isinstance(deviation, Relief):
        amount, length = factor * deviation.amount, factor * deviation.length
        return replace(deviation, amount=amount, length=length)
    if isinstance(deviation, FlankTable):
        radius, added = np.asarray(deviation.radius), np.asarray(deviation.added)
        return replace(deviation, radius=factor * radius, added=factor * added)
    if isinstance(deviation, PathTable):
        s, added = np.asarray(deviation.s), np.asarray(deviation.added)
        return replace(deviation, s=factor * s, added=factor * added)
    return deviation


def reliefs(drawn: Drawn, found: Found) -> None:
    """A tip relief of both gears alike beside heat and other deviations: never worse than none."""
    force = float(drawn.operating.torque[0]) / drawn.pair.pinion.base_radius
    kept = [d for d in hot_flanks(drawn) if not (isinstance(d, Relief) and d.end == "tip")]
    design = optimise_tip_relief(
        drawn.pair, force, deviations=kept, positions=24, symmetric=True, evaluations=SEARCH
    )
    found.counts["reliefs"] += 1
    values = (design.unrelieved, design.relieved, design.pinion.amount, design.pinion.length)
    if not np.all(np.isfinite(values)):
        found.counts["NaN"] += 1
    if design.relieved > design.unrelieved:
        found.counts["relief worse than none"] += 1


NEVER = (
    "exceptions",
    "NaN",
    "negative shares",
    "steps above 1 %",
    "not_converged",
    "not converged",
    "stiffness not above 0",
    "relief worse than none",
)
"""What must not happen once."""


def all_trials(drawn: Sequence[Drawn], workers: int = 2) -> Iterator[Found]:
    """The trials in order, by several processes."""
    if workers < 2:
        yield from map(trial, drawn)
        return
    with ProcessPoolExecutor(workers) as pool:
        yield from pool.map(trial, drawn, chunksize=4)


def page(count: int, refused: Counter[str], found: Sequence[Found], seconds: float) -> str:
    """The table of trials/records/pairs.md."""
    counts: Counter[str] = sum((one.counts for one in found), Counter())
    worst: dict[str, float] = {}
    for one in found:
        for what, value in one.worst.items():
            worst[what] = max(worst.get(what, 0.0), value)
    asked = count + refused.total()
    lines = [
        "# Trial of random pairs",
        "",
        f"Made by `make trial NAME=pairs` (seed {SEED}): {count} valid pairs of "
        "10 to 150 teeth, 14.5 to",
        "28 degrees, profile shifts of -0.6 to 0.9, rims from one module, modules of 0.5 to 20 mm,",
        "bodies and housing of -20 to 160 degrees Celsius each, deviations of every kind, loads of",
        "1 to 80 N per mm of width and mm of module. Each is computed cold and hot under both",
        f"bundles, at {POSITIONS} positions of the loaded contact on both flanks, "
        "with a search for",
        "a tip relief, in motion, with its gears exchanged, and twice as large.",
        "",
        f"Of {asked} pairs drawn {refused.total()} were refused, "
        f"{100.0 * refused.total() / asked:.1f} %: "
        + ", ".join(f"{why} {n}" for why, n in refused.most_common())
        + ".",
        "",
        "| what must not happen | times |",
        "|---|---:|",
        *(
            f"| {what.replace('not_converged', 'cycle not converged')} | {counts[what]} |"
            for what in NEVER
        ),
        "",
        "| beside it | |",
        "|---|---:|",
        f"| cycles in play | {counts['ok']} |",
        f"| cycles jammed, a status | {counts['jammed']} |",
        f"| neighbours more than 1 % apart that are no step | {counts['steep places']} |",
        f"| motions | {counts['motions']} |",
        f"| tip reliefs searched | {counts['reliefs']} |",
        *(f"| worst {what} | {value:.1e} |" for what, value in sorted(worst.items())),
        "",
        f"Steps are relative, between neighbours more than {NEAR} positions "
        "from a change of the set",
        "of pairs that carry. Exchange and scale are relative to the greatest value. Where kinks",
        "of two profiles lie closer together than the samples of a flank, the exchanged pair may",
        "find the other of two neighbouring valleys.",
        "",
    ]
    print(f"{seconds:.0f} s")
    return "\n".join(lines)


def main(words: Sequence[str]) -> int:
    count = int(words[0]) if words else 2000
    began = time.perf_counter()
    drawn, refused = draws(count)
    found = []
    for number, one in enumerate(all_trials(drawn)):
        found.append(one)
        if any(one.counts[what] for what in NEVER):
            print(f"pair {number}: {'; '.join(one.notes) or dict(one.counts)}", flush=True)
        if sys.stderr.isatty() or (number + 1) % 100 == 0:
            print(f"\r{number + 1} of {count}", end="", file=sys.stderr, flush=True)
    print(file=sys.stderr)
    text = page(count, refused, found, time.perf_counter() - began)
    if words:
        print(text)
    else:
        PAGE.write_text(text, "utf-8")
        print(PAGE.relative_to(Path.cwd()) if PAGE.is_relative_to(Path.cwd()) else PAGE)
    return int(any(one.counts[what] for one in found for what in NEVER))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
