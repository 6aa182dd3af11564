"""Answers of a steady pair: geometry, heat, backlash, film and scuffing."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from thermogear.base.errors import InputError, ThermogearError
from thermogear.base.limits import FINE, LIMITS, LOOK
from thermogear.base.materials import NEVER, Material
from thermogear.base.units import ZERO_CELSIUS
from thermogear.case.case import GearCase
from thermogear.mesh.scuffing_rating import Scuffing, flash_rating, integral_rating
from thermogear.results.answer import Answer
from thermogear.study.answers.asked import Asked, answer, undecided
from thermogear.study.scuffing import load_stage, not_steel, steel

Floats = NDArray[np.float64]

MESH, HEAT, GAP = "Does it mesh?", "How hot does it run?", "What is left of the backlash?"
FILM = "Is there a film, does it scuff?"

UNSETTLED = "the heat balance did not settle"


# --- does it mesh -----------------------------------------------------------------------------


def mesh(asked: Asked) -> Iterator[Answer]:
    pair = asked.case.pair
    gears = (("pinion", pair.pinion), ("wheel", pair.wheel))
    module = pair.pinion.module
    yield answer(
        MESH, "contact_ratio", f"The contact ratio is {pair.contact_ratio:.3f}.", pair.contact_ratio
    )
    form = [
        1e6 * (start - gear.form_radius)
        for start, (_, gear) in zip(pair.start_radii, gears, strict=True)
    ]
    least = int(np.argmin(form))
    cut = [name for name, gear in gears if gear.undercut]
    yield answer(
        MESH,
        "form_clearance",
        f"The flank in use begins {form[least]:.0f} µm above the involute's end on the "
        f"{gears[least][0]}" + (f"; undercut: {' and '.join(cut)}." if cut else "; no undercut."),
        form[least],
    )
    tips = [gear.tip_thickness / module for _, gear in gears]
    thin = int(np.argmin(tips))
    yield answer(
        MESH,
        "tip_thickness",
        f"The thinner tip, the {gears[thin][0]}'s, is {tips[thin]:.2f} modules thick.",
        tips[thin],
    )
    clear = [c / module for c in pair.tip_clearances]
    close = int(np.argmin(clear))
    yield answer(
        MESH,
        "tip_clearance",
        f"The {gears[close][0]}'s tip clears the other root by {clear[close]:.3f} modules.",
        clear[close],
    )


# --- how hot ----------------------------------------------------------------------------------


def heat(asked: Asked) -> Iterator[Answer]:
    oil, teeth = asked.bodies
    kind = f"oil_{asked.case.stated.lubricant.kind}"
    how = "computed" if asked.case.computed else "given"
    held = "oil" in asked.case.gearbox.measured
    of_teeth = _tooth_limit(asked.case)
    for point in asked.points:
        warm, at = float(oil[point]) - ZERO_CELSIUS, asked.at(point)
        if not np.isfinite(warm) or not (held or asked.settled(point)):
            yield undecided(HEAT, "oil_temperature", UNSETTLED, limit=kind, at=at)
            yield undecided(HEAT, "tooth_temperature", UNSETTLED, limit=of_teeth, at=at)
            continue
        said = "given" if held else how
        yield answer(
            HEAT, "oil_temperature", f"The oil is at {warm:.0f} °C ({said}).", warm,
            limit=kind, at=at,
        )  # fmt: skip
        if not asked.settled(point):
            yield undecided(HEAT, "tooth_temperature", UNSETTLED, limit=of_teeth, at=at)
            continue
        hottest = float(teeth[point]) - ZERO_CELSIUS
        flash = float(np.fmax.reduce(asked.hot["flash_temperature"][point]))
        yield answer(
            HEAT,
            "tooth_temperature",
            f"The teeth are at {hottest:.0f} °C ({how}), the flash adds up to {flash:.0f} K.",
            hottest,
            limit=of_teeth,
            at=at,
        )


def _tooth_limit(case: GearCase) -> str:
    """The limit of the gear that stands least heat; steel's where nobody knows better."""

    def of(material: Material) -> str:
        if f"teeth_{material.name}" in LIMITS:
            return f"teeth_{material.name}"
        if not steel(material):
            return "teeth_unknown"
        tempered = ZERO_CELSIUS + 500.0 <= material.tempering_temperature < NEVER
        return "teeth_tempered" if tempered else "teeth_steel"

    pair = case.pair
    names = [of(one.material) for one in (pair.pinion, pair.wheel)]
    return min(names, key=lambda n: LIMITS[n].most if n in LIMITS else -np.inf)


# --- backlash -----------------------------------------------------------------------------------


def gap(asked: Asked) -> Iterator[Answer]:
    cold = 2e6 * float(asked.hot["cold_half_backlash"].flat[0])
    for point in asked.points:
        at = asked.at(point)
        if not asked.settled(point):
            for name in ("backlash", "jam_margin"):
                yield undecided(GAP, name, UNSETTLED, at=at)
            continue
        left = 2e6 * float(asked.hot["least_half_backlash"][point])
        yield answer(
            GAP,
            "backlash",
            f"Of {cold:.0f} µm cold, {left:.0f} µm are left hot along the line of action.",
            left,
            at=at,
            verdict=FINE if left > 0.0 else LOOK,
        )
        jam = float(asked.hot["jam_temperature"][point]) - ZERO_CELSIUS
        hot = float(asked.bodies[1][point]) - ZERO_CELSIUS
        if not np.isfinite(jam):
            free = left > 0.0
            sentence = f"No heat of the gears alone {'jams' if free else 'frees'} the pair."
            verdict = FINE if free else LOOK
            yield answer(GAP, "jam_margin", sentence, float("nan"), at=at, verdict=verdict)
            continue
        yield answer(
            GAP,
            "jam_margin",
            "It jams with teeth at {jam:.0f °C} and the housing as it is, {off:.0f K} "
            f"{'above' if jam > hot else 'below'} what they have.",
            jam - hot,
            at=at,
            figures={"jam": jam, "off": abs(jam - hot)},
        )
    yield _worst_moment(asked)


def _worst_moment(asked: Asked) -> Answer:
    try:
        course = asked.warming
    except ThermogearError as error:
        return undecided(GAP, "warm_up_backlash", str(error), limit="backlash")
    worst = course.worst
    least, steady = 2e6 * worst.half_backlash, 2e6 * float(course.half_backlash[-1])
    start = float(course.temperatures["pinion_body"][0]) - ZERO_CELSIUS
    held = " and ".join(name.replace("_", " ") for name in course.held)
    how = f" with {held} held" if held else ""
    how += "" if asked.case.computed else " by the heat balance"
    words = f"Warming up from {start:.0f} °C{how} it is"
    sentence = f"{words} never less than when steady, {least:.0f} µm."
    if least < steady - 0.005 * abs(steady) - 0.05:
        sentence = (
            f"{words} least after {worst.time / 60.0:.3g} min: {least:.0f} µm, {steady:.0f} µm "
            "when steady."
        )
    return answer(
        GAP, "warm_up_backlash", sentence, least,
        limit="backlash", at=asked.at(asked.hardest), verdict=FINE if least > 0.0 else LOOK,
    )  # fmt: skip


# --- film and scuffing --------------------------------------------------------------------------


def film(asked: Asked) -> Iterator[Answer]:
    case, oil = asked.case, asked.bodies[0]
    stage, assumed = load_stage(case)
    whose = ", assumed" * assumed
    for point in asked.points:
        at = asked.at(point)
        film = asked.hot["film_parameter"][point]
        least = float(np.nanmin(film)) if np.isfinite(film).any() else float("nan")
        if not asked.settled(point):
            yield undecided(FILM, "film", UNSETTLED, at=at)
        elif not np.isfinite(least):
            yield undecided(FILM, "film", "no film could be computed", at=at)
        else:
            acting = "boundary" if least < 1.0 else "mixed" if least < 3.0 else "full film"
            yield answer(
                FILM, "film", f"The least film parameter is {least:.2f} ({acting}).", least, at=at
            )
        torque, speed = (float(asked.hot[f"pinion_{n}"][point]) for n in ("torque", "speed"))
        why = unrated(case, torque, float(oil[point]))
        if why:
            for name in ("scuffing_margin", "scuffing_safety"):
                yield undecided(FILM, name, why, at=at)
            continue
        state = Scuffing(
            lubricant=case.stated.lubricant, oil_temperature=float(oil[point]), load_stage=stage
        )
        for name, words in (
            ("scuffing_margin", _flash_words),
            ("scuffing_safety", _integral_words),
        ):
            yield _rated(name, partial(words, case, torque, speed, state, whose), at)


def unrated(case: GearCase, torque: float, oil: float) -> str:
    """Why scuffing is not rated at ``torque`` [N m] and ``oil`` [K]; empty where it is."""
    if other := not_steel(case):
        return f"the rating is for steel on steel, not {other}"
    if torque <= 0.0:
        return "there is no load"
    return "" if np.isfinite(oil) else UNSETTLED


def _rated(name: str, make: Callable[[], tuple[str, float, dict[str, Any]]], at: str) -> Answer:
    try:
        sentence, value, figures = make()
    except InputError as error:
        return undecided(FILM, name, str(error), at=at)
    return answer(FILM, name, sentence, value, at=at, figures=figures)


def _flash_words(
    case: GearCase, torque: float, speed: float, state: Scuffing, whose: str
) -> tuple[str, float, dict[str, Any]]:
    found = flash_rating(case.pair, torque, speed, state)
    figures = {
        "contact": float(found.contact) - ZERO_CELSIUS,
        "limit": found.limit - ZERO_CELSIUS,
        "stage": state.load_stage,
        "margin": float(found.margin),
        "safety": float(found.safety),
    }
    return (
        "By flash temperature, with the standard's friction and bulk, the contact reaches "
        f"{{contact:.0f °C}} of {{limit:.0f °C}} (stage {{stage:g}}{whose}): margin {{margin:.0f "
        "K}, safety {safety:.2f}.",
        figures["margin"],
        figures,
    )


def _integral_words(
    case: GearCase, torque: float, speed: float, state: Scuffing, whose: str
) -> tuple[str, float, dict[str, Any]]:
    found = integral_rating(case.pair, torque, speed, state)
    figures = {
        "integral": float(found.integral) - ZERO_CELSIUS,
        "limit": found.limit - ZERO_CELSIUS,
        "stage": state.load_stage,
        "safety": float(found.safety),
    }
    return (
        "By integral temperature it is {integral:.0f °C} of {limit:.0f °C} (stage {stage:g}"
        f"{whose}): safety {{safety:.2f}}.",
        figures["safety"],
        figures,
    )
