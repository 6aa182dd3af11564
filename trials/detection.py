"""Does a detection table hold? Records of other pairs of the class, by another integration.

``make trial NAME=detection``: a table of 60 pairs names, before any record is made, the smallest
crack
of a pinion's tooth and the smallest spall of a wheel's that one indicator sees in the same machine.
Then 50 fresh pairs with each, and 200 healthy ones, are integrated by the code below (Runge and
Kutta in metres and seconds, other steps than the package's) and get other noise: how often is the
change detected, the tooth found, and how often is a healthy one called changed?
``python trials/detection.py 6`` prints a short one.
"""

from __future__ import annotations

import sys
import warnings
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numba import njit
from numpy.typing import NDArray

from thermogear import load_case
from thermogear.analysis.order_statistics import proportion
from thermogear.base.plan import gather
from thermogear.case.case import gear_case
from thermogear.case.faults import fault_words
from thermogear.gears.deviations import GEARS
from thermogear.mesh.series import series_mesh
from thermogear.results.tables import in_words
from thermogear.signals.indicators import gear_indicators
from thermogear.signals.synchronous import shared_step
from thermogear.study.detection import DetectionPlan, against, detection_plan
from thermogear.study.diagnosis import INDICATORS, loudest_teeth
from thermogear.study.series import series_parts
from thermogear.views.pages.detect import first_seen

Floats = NDArray[np.float64]

SEED = 62_2026
"""Of the trial's noise; fixed before the first run."""
FIRST = 700
"""Drawing of the first fresh pair: the table knows drawings 0 to 59."""
FAULTY, HEALTHY = 100, 200
STEPS = 160
"""Steps of a mesh period; the package takes 192 of other equations."""
TURNS = 3
"""Turns that are followed; the last is the record."""
SAMPLES, BASELINE, BLOCK = 80, 59, 50
PAGE = Path(__file__).parents[1] / "trials" / "records" / "detection.md"
CASE = """
[gears]
module = "3 mm"
face_width = "20 mm"
[gears.pinion]
teeth = 17
profile_shift = 0.2
[gears.wheel]
teeth = 22
[flanks]
accuracy = 6
seed = 1
[oil]
temperature = "60 degC"
[operating]
speed = "1500 rpm"
torque = "80 N m"
[temperatures]
pinion_addendum = "70 degC"
wheel_addendum = "60 degC"
pinion_bore_below_addendum = "0 K"
wheel_bore_below_addendum = "0 K"
housing_below_addendum = "0 K"
[[faults]]
kind = "crack"
gear = "pinion"
tooth = 6
share = 0.4
[[faults]]
kind = "spall"
gear = "wheel"
tooth = 15
length = "1.5 mm"
depth = "0.15 mm"
width_share = 0.8
"""


@dataclass(frozen=True)
class Named:
    """What the table named: a fault's place among the variants, and what sees it."""

    variant: int
    indicator: str
    words: str


def table(parts: int) -> tuple[DetectionPlan, list[Named], Floats]:
    """The plan at one load, what its table names, and the class's limits (gear, indicator)."""
    plan = detection_plan(gear_case(load_case(CASE)), parts=parts)
    plan = replace(plan, torques=plan.torques[1:2])
    data = gather(plan)
    at = in_words(data).isel(pinion_speed=[0], pinion_torque=[0], signal=[0])
    rows = [r for r in first_seen(at) if r["question"] == "same machine" and r["state"] == "hot"]
    named = []
    for number, (row, family) in enumerate(zip(rows, plan.families, strict=True)):
        if not row["by"]:
            raise SystemExit(f"{row['fault']}: no size is seen, nothing to try")
        sizes = [fault_words(fault) for fault in family]
        place = 2 + 3 * number + sizes.index(row["seen"])
        named.append(Named(place, row["by"][0], row["seen"]))
    healthy = data["value"].values[0, 0, 0, :, :2, 0]
    return plan, named, np.asarray(np.nanmax(healthy, axis=0))


def integrated(plan: DetectionPlan, parts: list[tuple[object, ...]]) -> Floats:
    """x'' + e'' [m/s^2] of each part over its turn, (part, sample): m x'' + c x' + k f(x) =
    F - m e'', from static contact, in metres and seconds."""
    hot, point = plan._scenes[0, 0, 0]
    mesh = series_mesh(hot, parts, plan.turn)  # type: ignore[arg-type]
    mass, force = float(point.equivalent_mass[0]), float(point.mean_force[0])
    period = 2.0 * np.pi / float(point.mesh_frequency[0])
    k, bend = (
        _resampled(curve, plan, order, period)
        for curve, order in ((mesh.stiffness, 0), (mesh.spring_error, 2))
    )
    b = mesh.half_backlash.mean(axis=1)
    damping = 2.0 * float(point.damping_ratio[0]) * np.sqrt(mesh.stiffness.mean(axis=1) * mass)
    return _last_turn(k, bend, b, force, damping, mass, period / STEPS, plan.turn * SAMPLES)


@njit
def _last_turn(
    k: Floats, bend: Floats, b: Floats, force: float, damping: Floats, mass: float, h: float,
    samples: int,
) -> Floats:  # fmt: skip
    """Pull on the mass [m/s^2] (part, sample) over the last of the turns, by classic Runge-Kutta.

    ``k`` and ``bend`` at half steps (half step, part), ``h`` the step [s].
    """
    count = len(k) // 2
    out = np.empty((len(b), samples))
    for part in range(len(b)):
        half, c = b[part], damping[part]
        x, v = half + force / k[0, part], 0.0
        for step in range(TURNS * count):
            here = 2 * (step % count)
            mid, after = here + 1, (here + 2) % (2 * count)
            a0 = (force - c * v - k[here, part] * (x - min(max(x, -half), half))) / mass
            f1 = a0 - bend[here, part]
            x2, v2 = x + 0.5 * h * v, v + 0.5 * h * f1
            f2 = (force - c * v2 - k[mid, part] * (x2 - min(max(x2, -half), half))) / mass
            f2 -= bend[mid, part]
            x3, v3 = x + 0.5 * h * v2, v + 0.5 * h * f2
            f3 = (force - c * v3 - k[mid, part] * (x3 - min(max(x3, -half), half))) / mass
            f3 -= bend[mid, part]
            x4, v4 = x + h * v3, v + h * f3
            f4 = (force - c * v4 - k[after, part] * (x4 - min(max(x4, -half), half))) / mass
            f4 -= bend[after, part]
            place = step - (TURNS - 1) * count
            if place >= 0 and (place * samples) % count == 0:
                out[part, place * samples // count] = a0
            x += h / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4)
            v += h / 6.0 * (f1 + 2.0 * f2 + 2.0 * f3 + f4)
    return out


def _resampled(curve: Floats, plan: DetectionPlan, order: int, period: float) -> Floats:
    """A curve (part, position) at half steps (half step, part), differentiated so often [1/s]."""
    lines = np.fft.rfft(curve, axis=1)[:, : plan.case.harmonics * plan.turn + 1]
    rate = 2j * np.pi * np.arange(lines.shape[1]) / (plan.turn * period)
    count = 2 * STEPS * plan.turn
    bent = np.fft.irfft(lines * rate**order, count, axis=1)
    return np.asarray(bent.T * (count / curve.shape[1]))


def averaged(
    plan: DetectionPlan, curve: Floats, gear: int, noise: float, seed: int, n: int
) -> Floats:
    """``n`` averages of a record over a turn of a gear, each with noise of its own, (n, sample)."""
    turn = plan.teeth[gear] * SAMPLES
    mean = curve.reshape(-1, turn).mean(axis=0)
    drawn = np.random.default_rng([SEED, seed, gear])
    # white up to the table's half samples, of which this band has more
    spread = noise * np.sqrt(SAMPLES / 64.0 / plan.averaged[gear])
    return np.asarray(mean + spread * drawn.normal(size=(n, turn)))


def orders(plan: DetectionPlan, gear: int) -> dict[str, int]:
    own, mate = plan.teeth[gear], plan.teeth[1 - gear]
    return {
        "highest": plan.case.harmonics * own,
        "step": shared_step(mesh_order=own, mate_order=mate),
    }


def value(plan: DetectionPlan, rows: Floats, gear: int, name: str) -> Floats:
    """One indicator of averages, the fourth moment of the residual for NA4, as in the table."""
    found = gear_indicators(rows, mesh_order=plan.teeth[gear], **orders(plan, gear))
    return found["residual_fourth" if name == "na4" else name]


def records(plan: DetectionPlan, count: int, first: int, variant: int | None) -> Iterator[Floats]:
    """The motions of so many fresh parts, with a fault or without."""
    fault = None if variant is None else plan.variants[variant][0]
    file = plan.case.file.model_copy(update={"faults": () if fault is None else (fault,)})
    drawn = replace(plan.case, file=file)
    for begin in range(first, first + count, BLOCK):
        end = min(begin + BLOCK, first + count)
        yield from integrated(plan, list(series_parts(drawn, end)[begin:]))


def main(faulty: int, healthy: int, parts: int, page: Path | None) -> dict[str, tuple[int, int]]:
    """Run it, print or write the table, and return every count with what it is of."""
    warnings.simplefilter("ignore")
    plan, named, limits = table(parts)
    noise = float(plan.level[0])
    counts: dict[str, tuple[int, int]] = {}
    for number, fault in enumerate(named):
        each, gear = faulty // len(named), plan.variants[fault.variant][1]
        first = FIRST + number * each
        both = zip(
            records(plan, each, first, None), records(plan, each, first, fault.variant), strict=True
        )
        entry = plan.entry(plan.variants[fault.variant][0])  # type: ignore[arg-type]
        seen = near = exact = 0
        for part, (before, after) in enumerate(both, start=first):
            own = averaged(plan, before, gear, noise=noise, seed=2 * part, n=BASELINE)
            (row,) = averaged(plan, after, gear, noise=noise, seed=2 * part + 1, n=1)
            limit = value(plan, own, gear, fault.indicator).max()
            seen += bool(value(plan, row, gear, fault.indicator) > limit)
            (tooth,) = loudest_teeth(
                row[None] - own.mean(axis=0), teeth=plan.teeth[gear],
                contact_ratio=plan.case.pair.contact_ratio, **orders(plan, gear),
            ).tolist()  # fmt: skip
            exact += tooth == entry
            near += (tooth - entry + 1) % plan.teeth[gear] <= 2
        words = f"{fault.words}, {fault.indicator}"
        counts[f"{words}: detected"] = seen, each
        counts[f"{words}: tooth or a neighbour"] = near, each
        counts[f"{words}: the very tooth"] = exact, each
    false_own = dict.fromkeys(range(len(named)), 0)
    false_class = dict.fromkeys(range(len(named)), 0)
    first = FIRST + faulty
    for part, curve in enumerate(records(plan, healthy, first, None), start=first):
        for number, fault in enumerate(named):
            gear = plan.variants[fault.variant][1]
            own = averaged(plan, curve, gear, noise=noise, seed=2 * part, n=BASELINE)
            (row,) = averaged(plan, curve, gear, noise=noise, seed=2 * part + 1, n=1)
            got = float(value(plan, row, gear, fault.indicator))
            beyond, _ = against(
                np.array([got]), healthy=value(plan, own, gear, fault.indicator)[None], axis=1
            )
            false_own[number] += int(beyond[0])
            limit = limits[gear, INDICATORS.index(fault.indicator)]
            false_class[number] += got > limit
    for number, fault in enumerate(named):
        whose = f"{fault.indicator} of the {GEARS[plan.variants[fault.variant][1]]}"
        counts[f"healthy, {whose}: beyond its own limit"] = (
            false_own[number], healthy,
        )  # fmt: skip
        counts[f"healthy, {whose}: beyond the class's limit"] = (
            false_class[number], healthy,
        )  # fmt: skip
    lines = []
    for name, (hits, of) in counts.items():
        share = proportion(hits, of=of)
        lines.append(
            f"| {name} | {hits} of {of} | {100 * share.low:.1f} to {100 * share.high:.1f} |"
        )
    text = f"""# Detection: does a table hold for other pairs and another integration?

Made by `make trial NAME=detection`. {plan.teeth[0]}/{plan.teeth[1]} teeth, module 3 mm, class 6,
1500 rpm, 80 N m, hot. A table of {parts} pairs (drawings 0 to 59) named these sizes as the smallest
that the indicator beside them sees in the same machine; the records are of drawings from {FIRST}
on, integrated by the script's own code, with other noise ({noise:.0f} m/s²). A limit is the
greatest of {BASELINE} healthy averages of the same pair; the class's limit is the table's. The
tooth is that over whose contact the change is loudest.

The sizes are the smallest at which any of 15 indicators saw 57 of 60 pairs or more: such a choice
flatters, and a fresh pair is detected less often than the table says.

Two earlier trials on other pairs each changed one thing. The first looked for the tooth in one
pitch alone, and found the very tooth of the crack in 39 of 50; the contact ratio is taken into
account since. In both, 45 and 41 of 50 spalls were detected where the table had 58 of 60: its
contact was solved at 64 positions of a mesh period, too few, and is at 96 now.

| what | count | interval of 95 % [%] |
|---|---|---|
{chr(10).join(lines)}
"""
    if page is None:
        print(text)
    else:
        page.write_text(text, encoding="utf-8")
    return counts


if __name__ == "__main__":
    asked = sys.argv[1:]
    short = int(asked[0]) if asked else 0
    if short:
        main(short, short, 8, None)
    else:
        main(FAULTY, HEALTHY, 60, PAGE)
