"""Claims of section 5: the tests, their table, what is concluded from them."""

from __future__ import annotations

import numpy as np

from thermogear.base.display import HERTZ, MICROMETRE, MILLIMETRE, PERCENT, SPEED, Display
from thermogear.base.vocabulary import UNDEFORMED
from thermogear.measured.published import (
    THESIS_5_2,
    allowed,
    rounded_error,
    unstated_processing,
)
from thermogear.measured.verdicts import Row
from thermogear.signals.integration import trapezoid_factor
from thermogear.thesis.claim import Claim, Finding, Verdict, listed, verdict_of
from thermogear.thesis.evidence import Evidence

PUBLISHED = "thermogear.measured.published.THESIS_5_2"
COMPARE = "thermogear.study.compare.compare"
MODELS = ("with heat", "without heat")
QUANTITIES = {"frequency": Display("Hz"), "displacement": MICROMETRE}
LINES, TEETH = THESIS_5_2.measured.lines, THESIS_5_2.measured.teeth or 0
"""Of the printed table."""


def _row(e: Evidence, number: int, quantity: str) -> Row:
    return e.comparison.row(LINES[number].speed, quantity)


def _platform(e: Evidence) -> Finding:
    pair = e.case.pair
    return Finding(
        f"module {MILLIMETRE(pair.pinion.module):g} mm, {pair.pinion.teeth}:{pair.wheel.teeth}, "
        f"{np.degrees(pair.pinion.pressure_angle):g}°",
        f"centre distance {MILLIMETRE(pair.centre_distance):.4g} mm, contact ratio "
        f"{pair.contact_ratio:.6f}",
        Verdict.REPRODUCED,
        "The stated geometry makes a sound pair; face width, shifts, bores and quality, which its "
        "vibration depends on, are not stated.",
    )


def _tested_speeds(e: Evidence) -> Finding:
    speeds = [SPEED(line.speed) for line in LINES]
    implied = [SPEED(line.shaft_speed(TEETH)) for line in LINES]
    ratio = e.bundle("mesh", "consistent", UNDEFORMED)["frequency_ratio"].values
    return Finding(
        f"nominal {listed(speeds, '.0f')} rpm",
        f"the measured lines imply {listed(implied, '.1f')} rpm; ω_h = {listed(ratio, '.2f')}",
        Verdict.ASSUMED,
        "If the main lines are the mesh lines, the shaft did not turn at the nominal speeds. All "
        "of them lie far below the range 1.1 to 1.3 of the diagrams.",
    )


def _integrated(e: Evidence) -> Finding:
    highest = max(line.frequency for line in LINES)
    rates = (5120.0, 25600.0)
    lost = [PERCENT(float(trapezoid_factor(highest, rate=rate)) - 1.0) for rate in rates]
    return Finding(
        f"two sums lose {listed(lost, '.1f')} % at {highest:g} Hz and {listed(rates, '.0f')} Hz",
        f"the printed displacements imply {listed([line.acceleration_g for line in LINES])} g",
        Verdict.UNDECIDED,
        "Rate, filter, window and integration are not stated, and they decide the amplitude. "
        "Accelerations as high are implausible on a housing, whose motion is not the relative "
        f"displacement of the teeth either. {e.rig_trains.attrs['sentence']}",
    )


def _near_mesh(e: Evidence) -> Finding:
    offsets = [line.frequency - HERTZ(TEETH * line.speed) for line in LINES]
    share = [PERCENT(o / line.frequency) for o, line in zip(offsets, LINES, strict=True)]
    return Finding(
        f"off the nominal mesh frequency by {listed(offsets, '+.2f')} Hz",
        f"that is {listed(share, '+.2f')} %",
        verdict_of(max(abs(s) for s in share) < 1.0),
        "Within a per cent; the rest is the speed's tolerance.",
    )


def _measured_line(e: Evidence, number: int) -> Finding:
    line = LINES[number]
    return Finding(
        f"{line.frequency:g} Hz",
        f"implies {SPEED(line.shaft_speed(TEETH)):.1f} rpm instead of {SPEED(line.speed):.0f}",
        Verdict.ASSUMED,
        "Measured values are taken as printed, as the mesh line of a shaft near its nominal speed.",
    )


def _measured_amplitude(e: Evidence, number: int) -> Finding:
    line = LINES[number]
    found = unstated_processing(line.frequency, highest=max(one.frequency for one in LINES))
    total = PERCENT(float(np.sqrt(sum(part**2 for part in found.values()))))
    return Finding(
        f"{MICROMETRE(line.displacement):g} µm",
        f"implies {line.acceleration_g:.1f} g; unstated processing alone leaves ±{total:.0f} %",
        Verdict.UNDECIDED,
        "It is a housing's motion after a chain that is not described; whether it is the relative "
        "displacement of the teeth cannot be told.",
    )


def _simulated_line(e: Evidence, number: int, model: int) -> Finding:
    row = _row(e, number, "frequency")
    forced = HERTZ(TEETH * row.speed)
    value = row.simulated[model]
    own = e.groups["motion"].isel(operating=number, bundle=0, state=-1 if model == 0 else 0)
    peak = float(own["line_frequency"].values[1 + int(np.argmax(own["line_amplitude"].values[1:]))])
    return Finding(
        f"{value:g} Hz printed; the model is forced at {forced:.3f} Hz",
        f"our main line: {peak:.3f} Hz",
        verdict_of(abs(value / forced - 1.0) < 1e-4),
        "A model forced with the mesh answers at the mesh frequency or a simple fraction or "
        "multiple of it, hot or cold: the printed line is none of them.",
    )


def _simulated_amplitude(e: Evidence, number: int, model: int) -> Finding:
    row = _row(e, number, "displacement")
    motion = (
        e.groups["motion"].isel(operating=number).sel(state="hot" if model == 0 else UNDEFORMED)
    )
    swing = e.sensitivity.data.sel(output="swing")
    low, high = float(swing["low"]), float(swing["high"])
    ours = []
    for bundle in ("thesis", "consistent"):
        one = motion.sel(bundle=bundle)
        place = int(np.argmin(np.abs(one["order"].values - 1.0)))
        ours.append(MICROMETRE(float(one["line_amplitude"].values[place])))
    return Finding(
        f"{MICROMETRE(row.simulated[model]):g} µm printed; {ours[0]:.3g} µm with the thesis's "
        "bundle",
        f"{ours[1]:.3g} µm with the consistent one",
        Verdict.UNDECIDED,
        "Torque, width, backlash, damping and error of the test are not stated. In the ranges of "
        f"the sensitivity study the swing (twice an amplitude) runs from {low:.2g} to {high:.2g} "
        "µm at its speed; the printed value needs a larger error or load than assumed, or is none "
        "of the teeth's motion.",
    )


def _error(e: Evidence, number: int, quantity: str, model: int) -> Finding:
    row = _row(e, number, quantity)
    printed = THESIS_5_2.errors[MODELS[model], quantity, number]
    low, high = rounded_error(
        simulated=row.simulated[model], measured=row.measured, quantity=quantity
    )
    agrees = allowed(printed, low=low, high=high)
    return Finding(
        f"printed {printed} %",
        f"recomputed {PERCENT(abs(row.errors[model])):.2f} %, {low:.2f} to {high:.2f} % as the "
        "entries are rounded",
        verdict_of(agrees),
        "From the table's own entries." if agrees else
        "The table's own entries give another value, however they were rounded.",
    )  # fmt: skip


def _trends(e: Evidence) -> Finding:
    gains = [PERCENT(abs(row.errors[1]) - abs(row.errors[0])) for row in e.comparison.rows]
    better = sum(gain > 0 for gain in gains)
    return Finding(
        f"the model with heat is nearer in {better} of {len(gains)} entries",
        f"by {listed(gains, '.2f')} percentage points",
        verdict_of(better == len(gains)),
        "As far as the printed numbers go.",
    )


def _much_smaller(e: Evidence) -> Finding:
    rows = [row for row in e.comparison.rows if row.quantity == "displacement"]
    gains = [PERCENT(abs(row.errors[1]) - abs(row.errors[0])) for row in rows]
    u = [PERCENT(row.u_val) for row in rows]
    resolved = [row for row in rows if row.verdict != "not resolvable"]
    return Finding(
        f"displacement errors smaller by {listed(gains, '.1f')} percentage points",
        f"validation uncertainty {listed(u, '.1f')} %: {len(resolved)} of {len(rows)} resolvable",
        Verdict.UNDECIDED if not resolved else Verdict.ASSUMED,
        "What the unstated processing can do to an amplitude is larger than the improvement; the "
        "frequency column cannot carry thermal information at all.",
    )


def _more_accurate(e: Evidence) -> Finding:
    change = e.sensitivity.data.sel(output="swing_change")
    low, high = float(change["low"]), float(change["high"])
    row = _row(e, 0, "displacement")
    printed = PERCENT(row.simulated[0] / row.simulated[1] - 1.0)
    return Finding(
        f"printed: heat raises the displacement by {printed:.1f} % at the lowest speed",
        f"ours, over the unstated inputs: {low:+.1f} to {high:+.1f} %",
        Verdict.UNDECIDED,
        "Even the sign of heat's effect on the amplitude depends on inputs that are not stated, "
        "and the tests cannot resolve it.",
    )


def _entries() -> list[Claim]:
    found = []
    for number, line in enumerate(LINES):
        rpm = f"{SPEED(line.speed):.0f} rpm"
        for q, (quantity, scale) in enumerate(QUANTITIES.items()):
            place = f"5.2, table, {rpm}, {quantity}"
            base = f"5.2.{100 * (number + 1) + 10 * q}"
            judge = _measured_line if quantity == "frequency" else _measured_amplitude
            other = _simulated_line if quantity == "frequency" else _simulated_amplitude
            value = scale(getattr(line, quantity))
            found.append(
                Claim(
                    base, place, "table entry", f"Measured {quantity} {value:g} {scale.unit}.",
                    lambda e, n=number, f=judge: f(e, n),  # type: ignore[misc]
                    (PUBLISHED, COMPARE), "experiment",
                )
            )  # fmt: skip
            for m, model in enumerate(MODELS):
                shown = scale(getattr(THESIS_5_2.models[model].lines[number], quantity))
                found.append(
                    Claim(
                        f"{base[:-1]}{1 + m}", place, "table entry",
                        f"Simulated {quantity} {shown:g} {scale.unit} {model}.",
                        lambda e, n=number, m=m, f=other: f(e, n, m),  # type: ignore[misc]
                        (PUBLISHED, "thermogear.study.run.run"), f"motion-0-{number}",
                    )
                )  # fmt: skip
                printed = THESIS_5_2.errors[model, quantity, number]
                found.append(
                    Claim(
                        f"{base[:-1]}{3 + m}", place, "table entry",
                        f"Error of the {quantity} {printed} % {model}.",
                        lambda e, n=number, m=m, q=quantity: _error(e, n, q, m),  # type: ignore[misc]
                        (COMPARE,), "experiment",
                    )
                )  # fmt: skip
    return sorted(found, key=lambda claim: int(claim.number.split(".")[-1]))


_ROWS = (
    ("5.1.1", "5.1", "statement", "A rig with a pair of module 5 mm, 25:75, 20° was built.",
     _platform, ("thermogear.gears.pair.GearPair",), ""),
    ("5.1.2", "5.1", "statement", "It was measured at 1000, 2000 and 3000 rpm.", _tested_speeds,
     (PUBLISHED,), "experiment"),
    ("5.1.3", "5.1", "statement",
     "Acceleration was filtered and integrated twice to displacement.", _integrated,
     ("thermogear.signals.integration.trapezoid_factor", "thermogear.thesis.experiment.stored"),
     "rig-trains"),
    ("5.2.1", "5.2", "statement", "The measured main lines lie near the mesh frequency.",
     _near_mesh, (PUBLISHED,), "experiment"),
    ("5.2.2", "5.2", "figure", "At 1000 rpm the main line is measured at 419.7 Hz.",
     lambda e: _measured_line(e, 0), (PUBLISHED,), "experiment"),
    ("5.2.3", "5.2", "figure", "There the simulation with heat gives 413 Hz.",
     lambda e: _simulated_line(e, 0, 0), (COMPARE,), "motion-0-0"),
    ("5.2.4", "5.2", "figure", "There the simulation without heat gives 411 Hz.",
     lambda e: _simulated_line(e, 0, 1), (COMPARE,), "motion-0-0"),
    ("5.2.5", "5.2", "figure", "The measured displacement there is 10.4 µm.",
     lambda e: _measured_amplitude(e, 0), (PUBLISHED,), "experiment"),
    ("5.2.6", "5.2", "figure", "The simulated displacement with heat is 8.7 µm.",
     lambda e: _simulated_amplitude(e, 0, 0), (COMPARE,), "motion-0-0"),
    ("5.2.7", "5.2", "figure", "The simulated displacement without heat is 8.17 µm.",
     lambda e: _simulated_amplitude(e, 0, 1), (COMPARE,), "motion-0-0"),
    ("5.2.8", "5.2", "statement", "At the other speeds it is alike.", _trends, (COMPARE,),
     "experiment"),
    ("5.2.9", "5.2", "statement", "With heat the errors are much smaller.", _much_smaller,
     (COMPARE, "thermogear.measured.published.unstated_processing"), "experiment"),
    ("5.2.10", "5.2", "statement", "So the model with heat predicts more accurately.",
     _more_accurate, (COMPARE, "thermogear.study.sensitivity.sensitivity"), "sensitivity"),
)  # fmt: skip

CLAIMS = (*(Claim(*row) for row in _ROWS), *_entries())
