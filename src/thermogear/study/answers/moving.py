"""Answers of a moving pair: speeds, dynamic factor, transmission error and relief."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from thermogear.base.errors import InputError
from thermogear.base.limits import FINE, USUAL_ERROR
from thermogear.case.case import GearCase
from thermogear.case.thermal_state import HOT, UNDEFORMED
from thermogear.gears.deviations import Relief
from thermogear.gears.dynamic_factor import DynamicFactor, dynamic_factor
from thermogear.gears.iso6336 import iso6336_stiffness
from thermogear.mesh.elastic import elastic_pair
from thermogear.mesh.model import MeshModel
from thermogear.mesh.operating import Operating
from thermogear.mesh.thermal import HotPair
from thermogear.results.answer import Answer
from thermogear.study.answers.asked import Asked, answer, undecided
from thermogear.study.speeds import LOST, rpm, told

Floats = NDArray[np.float64]

SPEEDS = "At which speeds does it resonate?"
LOADS, ERROR = "How large is the dynamic factor?", "How large is the transmission error?"

RELIEFS = (0.25, 0.5, 0.75, 1.0, 1.25, 1.5)
"""Tip reliefs that are tried, over the mean deflection of the loaded teeth."""


# --- speeds -------------------------------------------------------------------------------------


def speeds(asked: Asked) -> Iterator[Answer]:
    found = asked.speeds
    if found is None:
        why = asked.still(asked.hardest) or "its mesh has no stiffness that moves"
        for name in ("resonance", "contact_loss", "back_contact", "coexisting"):
            yield undecided(SPEEDS, name, why)
        return
    place = asked.hardest
    natural = float(np.sqrt(asked.hot["mean_stiffness"][place] / asked.case.equivalent_mass))
    main = natural / asked.case.pair.pinion.teeth
    own = asked.case.stated.speed
    nearest = float(own[np.argmin(np.abs(own / main - 1.0))])
    tops = ", ".join(f"{factor:.2f} at {rpm(speed)}" for speed, factor in found.peaks()[:4])
    peaks = f"; greatest dynamic factors: {tops} rpm" if tops else "; no peak stands out"
    yield answer(
        SPEEDS,
        "resonance",
        f"The mesh frequency meets the natural one, {natural / (2e3 * np.pi):.2f} kHz, at "
        f"{rpm(main)} rpm{peaks}.",
        100.0 * abs(nearest / main - 1.0),
    )
    speed, share = found.column("pinion_speed"), found.column("contact_loss_share")
    moving = np.isfinite(asked.motion["contact_loss_share"])
    parted = asked.motion["contact_loss_share"][moving] > LOST
    struck = asked.motion["mesh_force_min"][moving] < 0.0
    ends = (float(speed.min()), float(speed.max()))
    for name, ranges, happens, never, own_points in (
        ("contact_loss", found.lost, "Flanks lose contact", "Flanks keep contact",
         parted),
        ("back_contact", found.back, "Teeth hit the back side", "No tooth hits the back side",
         struck),
    ):  # fmt: skip
        over = f"from {rpm(speed.min())} to {rpm(speed.max())} rpm"
        most = f", for up to {100.0 * share.max():.0f} % of the time" * (name == "contact_loss")
        sentence = f"{happens} {told(ranges, ends=ends)}{most}." if ranges else f"{never} {over}."
        value = 100.0 * float(np.mean(own_points)) if own_points.size else float("nan")
        if not own_points.size:
            words = f"{sentence[0].lower()}{sentence[1:]}"
            sentence = f"Not decided at its own speeds, too slow to vibrate; faster, {words}"
        yield answer(SPEEDS, name, sentence, value)
    several = found.several
    yield answer(
        SPEEDS,
        "coexisting",
        f"Two motions exist {told(several, ends=ends)}: it may jump there, up and down elsewhere."
        if several
        else "One motion exists at every speed looked at: no jump.",
        2.0 if _here(own, several) else 1.0,
    )


def _here(own: Floats, ranges: list[tuple[float, float]]) -> float:
    """Share of the case's own speeds that lie in one of the ranges, half a step allowed."""
    inside = [any(low * 0.9875 <= v <= high * 1.0125 for low, high in ranges) for v in own]
    return float(np.mean(inside)) if inside else 0.0


# --- dynamic factor and error -------------------------------------------------------------------


def loads(asked: Asked) -> Iterator[Answer]:
    case = asked.case
    grade = _class(case)
    for point in asked.points:
        at = asked.at(point)
        own = float(asked.motion["dynamic_factor"][point]) if asked.moves(point) else float("nan")
        rated = _rated_factor(asked, point, grade)
        if isinstance(rated, str) or not np.isfinite(own):
            still = asked.still(point) or "it turns too slowly to vibrate"
            why = rated if isinstance(rated, str) else still
            mine = f"computed {own:.2f}; " if np.isfinite(own) else ""
            yield undecided(LOADS, "dynamic_factor", f"{mine}{why}", at=at)
            continue
        said = "" if case.accuracy else ", profiles as measured"
        words = f"class {grade}" + (said if case.accuracy or case.measured_class else ", assumed")
        yield answer(
            LOADS,
            "dynamic_factor",
            f"The vibration computed gives {own:.2f}; ISO 6336-1 method B "
            f"{float(rated.factor):.2f} ({words}, resonance ratio {float(rated.ratio):.2f}).",
            own,
            most=float(rated.factor),
            at=at,
        )


def _rated_factor(asked: Asked, point: int, grade: int) -> DynamicFactor | str:
    torque, speed = (float(asked.hot[f"pinion_{n}"][point]) for n in ("torque", "speed"))
    try:
        return dynamic_factor(asked.case.pair, torque, speed, grade=grade)
    except InputError as error:
        return f"ISO 6336-1 does not cover it: {error}"


def errors(asked: Asked) -> Iterator[Answer]:
    swing = {
        name: 1e6 * np.ptp(cycle["transmission_error"], axis=-1)
        for name, cycle in (("cold", asked.cold), ("hot", asked.hot))
    }
    for point in asked.points:
        if why := asked.unsettled(point):
            yield undecided(ERROR, "transmission_error", why, at=asked.at(point))
            continue
        warm = float(swing["hot"][point])
        sentence = (
            f"Static and loaded it is {float(swing['cold'][point]):.2f} µm peak to peak "
            f"undeformed, {warm:.2f} µm hot."
        )
        yield answer(
            ERROR,
            "transmission_error",
            sentence,
            warm,
            most=_usual_error(asked.case, float(asked.hot["pinion_torque"][point])),
            at=asked.at(point),
        )
    yield _relief(asked)


def _class(case: GearCase) -> int:
    """The class of ISO 1328-1 that the flanks are of, the worse gear's; 6 where none is known."""
    return max((one for one in (case.accuracy, case.measured_class) if one), default=6)


def _usual_error(case: GearCase, torque: float) -> float:
    """What a pair of the accuracy class usually has [um]: unloaded, and 0.43 w/c' of the load."""
    classes, errors_of = zip(*USUAL_ERROR, strict=True)
    unloaded = float(np.interp(float(_class(case)), classes, errors_of))
    load = torque / (case.pair.pinion.pitch_radius * case.pair.face_width)
    single = float(iso6336_stiffness(case.pair, load).single)
    return unloaded + (0.43e6 * load / single if single > 0.0 else 0.0)


def _relief(asked: Asked) -> Answer:
    """The best of a few tip reliefs at the hardest point, hot, and the same one undeformed."""
    case, model, point = asked.case, asked.model, asked.hardest
    if why := asked.still(point):
        return undecided(ERROR, "relief", why)
    if any(isinstance(one, Relief) for one in case.deviations):
        return answer(
            ERROR, "relief", "The flanks have one; `thermogear relief` looks for a better.",
            float("nan"), verdict=FINE,
        )  # fmt: skip
    force = float(asked.hot["normal_force"][point])
    deflection = force / float(asked.hot["mean_stiffness"][point])
    length = case.pair.path.e - case.pair.path.d
    states = {}
    for number_of, (name, state) in enumerate((("cold", UNDEFORMED), ("hot", HOT))):
        asked.progress("relief", number_of, 2)
        operating = state.operating(case, model).part(slice(point, point + 1))
        states[name] = [
            _swing(case, model, operating, amount=share * deflection, length=length)
            for share in (0.0, *RELIEFS)
        ]
    asked.progress("relief", 2, 2)
    cold, hot = (np.array(states[name]) for name in ("cold", "hot"))
    best, other = int(np.argmin(hot)), int(np.argmin(cold))
    amounts = np.array([0.0, *RELIEFS]) * 1e6 * deflection
    gain = 100.0 * (1.0 - hot[best] / hot[0])
    if gain < 1.0:
        sentence = (
            "No tip relief of both gears makes it smaller, hot: the flanks themselves decide."
        )
    else:
        sentence = (
            f"A linear tip relief of {amounts[best]:.1f} µm on both gears makes it "
            f"{hot[0]:.2f} → {hot[best]:.2f} µm hot; the best one undeformed, {amounts[other]:.1f} "
            f"µm, leaves {hot[other]:.2f} µm hot."
        )
    return answer(ERROR, "relief", sentence, gain, at=asked.at(point))


def _swing(
    case: GearCase, model: MeshModel, operating: Operating, amount: float, length: float
) -> float:
    """Static error peak to peak [um] with a tip relief of ``amount`` [m] on both gears."""
    cut = tuple(Relief(gear, amount=amount, length=length) for gear in ("pinion", "wheel"))
    hot = HotPair(case.pair, replace(operating, housing=case.housing), model)
    loaded = elastic_pair(hot, (*case.deviations, *(cut if amount else ())))
    curves = loaded.over(np.arange(case.mesh_positions) / case.mesh_positions)
    return float(1e6 * np.ptp(curves.transmission_error[0]))
