"""Answers of a steady pair: geometry, heat, backlash, film and scuffing, the teeth's roots."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from thermogear.base.errors import InputError, ThermogearError
from thermogear.base.limits import FINE, LIMITS, LOOK, OPEN
from thermogear.base.materials import NEVER, Material
from thermogear.base.units import ZERO_CELSIUS
from thermogear.base.vocabulary import STILL
from thermogear.case.case import GearCase
from thermogear.case.thermal_state import HOT, UNDEFORMED
from thermogear.gears.geometry import Gear
from thermogear.gears.iso6336 import root_factors, single_contact
from thermogear.gears.pair import GearPair
from thermogear.gears.root_stress import root_stress
from thermogear.heat.transient import HOTTEST
from thermogear.mesh.elastic import loaded_pair, turn_phases
from thermogear.mesh.scuffing_rating import (
    FlashRating,
    IntegralRating,
    Scuffing,
    flash_rating,
    integral_rating,
)
from thermogear.results.answer import Answer
from thermogear.study.answers.asked import (
    MOST_WETTED,
    NO_BATH,
    WARMEST_USUAL,
    Asked,
    answer,
    undecided,
)
from thermogear.study.answers.moving import rated_factor
from thermogear.study.scuffing import borne_by, load_stage, not_steel, steel
from thermogear.study.warm_up import FLAT, least_between, no_bath_from

MESH, HEAT, GAP = "Does it mesh?", "How hot does it run?", "What is left of the backlash?"
FILM, ROOT = "Is there a film, does it scuff?", "How much does the root carry?"
POSITIONS = 60
"""Mesh phases at which the stress of the roots is looked at."""

PARTS = {"deviations": "flank deviations", "speed": "centrifugal growth", "heat": "heat"}
"""What takes or gives backlash, as it is named."""
BORES = {"free": "bores free", "rigid": "bores held", "shaft": "bores filled by their shafts"}
"""How bores are held while the gears grow, as it is said."""


# --- does it mesh -----------------------------------------------------------------------------


def mesh(asked: Asked) -> Iterator[Answer]:
    pair = asked.case.pair
    gears = (("pinion", pair.pinion), ("wheel", pair.wheel))
    module = pair.pinion.module
    yield answer(
        MESH, "contact_ratio", f"The contact ratio is {pair.contact_ratio:.3f}.", pair.contact_ratio
    )
    form = [
        max(1e6 * (start - gear.form_radius), 0.0)
        for start, (_, gear) in zip(pair.start_radii, gears, strict=True)
    ]
    least = int(np.argmin(form))
    cut = [name for name, gear in gears if gear.undercut]
    yield answer(
        MESH,
        "form_clearance",
        f"The flank in use begins {form[least]:.0f} µm above the involute's end on the "
        f"{gears[least][0]}"
        + (f"; undercut: {' and '.join(cut)}" if cut else "; no undercut")
        + (", which shortens the path of contact." if pair.cut_short else "."),
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
    (oil, teeth), used = asked.bodies, asked.case.stated.lubricant
    kind = f"oil_{used.kind}"
    held = "oil" in asked.case.gearbox.measured
    of_teeth = _tooth_limit(asked.case)
    for point in asked.points:
        warm, at = float(oil[point]) - ZERO_CELSIUS, asked.at(point)
        why = asked.lost(point)
        if why and not (held and np.isfinite(warm)):
            excess, figures = _excess(asked, point)
            cause = f"{why}; {excess}" if excess else why
            yield undecided(HEAT, "oil_temperature", cause, limit=kind, at=at, figures=figures)
            yield undecided(HEAT, "tooth_temperature", why, limit=of_teeth, at=at)
            continue
        how, figures = ("given", {}) if held else _how(asked, point, 0)
        sentence = f"The oil is at {warm:.0f} °C ({how})."
        if none := asked.no_bath(point):
            excess, more = _excess(asked, point)
            sentence = f"{sentence[:-1]}: {none}" + (f"; {excess}." if excess else ".")
            figures = {**figures, **more, "hottest_bath": used.hottest_bath - ZERO_CELSIUS}
        yield answer(
            HEAT, "oil_temperature", sentence, warm, limit=kind, at=at, figures=figures,
            verdict=LOOK if none else "",
        )  # fmt: skip
        if why := asked.unsettled(point):
            yield undecided(HEAT, "tooth_temperature", why, limit=of_teeth, at=at)
            continue
        hottest = float(teeth[point]) - ZERO_CELSIUS
        how, figures = _how(asked, point, 1)
        flash = "the pair is jammed"
        if not asked.still(point):
            figures = {**figures, "flash": float(asked.hot["greatest_flash_temperature"][point])}
            flash = f"the flash adds up to {{flash:.0f K}}{asked.worst_pair}"
        yield answer(
            HEAT,
            "tooth_temperature",
            f"The teeth are at {hottest:.0f} °C ({how}), {flash}.",
            hottest,
            limit=of_teeth,
            at=at,
            figures=figures,
        )


def _how(asked: Asked, point: int, body: int) -> tuple[str, dict[str, float]]:
    """Where a temperature comes from, with what a wetter gear would make of it."""
    if not asked.case.computed:
        return "given", {}
    kelvin = np.nan if asked.wetter is None else float(asked.wetter[body][point])
    if not np.isfinite(kelvin):
        return "computed", {}
    share = asked.case.gearbox.surroundings.wetted_share[0]
    words = "computed with {wetted:g} of the gears wetted, a guess; {wetter:.0f °C} with"
    figures = {"wetted": share, "more_wetted": MOST_WETTED, "wetter": kelvin - ZERO_CELSIUS}
    return f"{words} {{more_wetted:g}}", figures


def _excess(asked: Asked, point: int) -> tuple[str, dict[str, float]]:
    """Why the oil gets so hot, and what to give; empty where its temperature is given."""
    if not asked.case.computed or "oil" in asked.case.gearbox.measured:
        return "", {}
    made, carried = (float(watts[point]) / 1e3 for watts in asked.bath)
    if not made > carried:
        return "", {}
    cooled = asked.case.gearbox.surroundings.oil_flow > 0.0
    flow = "more gearbox.oil_flow, a cooler" if cooled else "gearbox.oil_flow"
    flow += " gearbox.supply_temperature" * cooled
    takes = "{carried:.3g kW}" if carried > 0.0 else "nothing off"
    words = (
        f"{{made:.3g kW}} are made and the bath carries {takes} with oil at "
        f"{{carried_at:.0f °C}}: give oil.temperature, {flow} or gearbox.housing_area"
    )
    figures = {"made": made, "carried_at": WARMEST_USUAL - ZERO_CELSIUS}
    return words, figures | ({"carried": carried} if carried > 0.0 else {})


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
    bored = {**PARTS, "speed": f"{PARTS['speed']} ({BORES[asked.model.bore]})"}
    for point in asked.points:
        at = asked.at(point)
        if why := asked.unsettled(point):
            for name in ("backlash", "jam_margin"):
                yield undecided(GAP, name, why, at=at)
            continue
        left = 2e6 * float(asked.hot["least_half_backlash"][point])
        nominal = 2e6 * float(asked.hot["cold_half_backlash"][point])
        parts = {n: 2e6 * float(asked.hot[f"half_backlash_by_{n}"][point]) for n in PARTS}
        named = [f"{bored[n]} {{{n}:+.1f µm}}" for n, v in parts.items() if abs(v) >= 0.05]
        yield answer(
            GAP,
            "backlash",
            f"Of {{nominal:.1f µm}} nominal, {left:.1f} µm are left hot along the line of action"
            f"{': ' * bool(named)}{', '.join(named)}.",
            left,
            at=at,
            verdict=FINE if left > 0.0 else LOOK,
            figures={"nominal": nominal, **parts},
            units=dict.fromkeys(parts, "µm"),
        )
        jam = float(asked.hot["jam_temperature"][point]) - ZERO_CELSIUS
        hot = float(asked.pinion[point]) - ZERO_CELSIUS
        most, cause = borne_by(asked.case.pair)
        borne = most - ZERO_CELSIUS
        if not np.isfinite(jam):
            free, burnt = left > 0.0, hot >= borne
            hotter = f"; its teeth are hotter than the {{borne:.0f °C}} they bear ({cause})"
            yield answer(
                GAP,
                "jam_margin",
                f"No heat of the gears alone {'jams' if free else 'frees'} the pair"
                f"{hotter * burnt}.",
                np.nan,
                at=at,
                verdict=FINE if free and not burnt else LOOK,
                figures={"borne": borne} if burnt else {},
            )
            continue
        beyond = hot < borne < jam
        jams = "does not jam below {borne:.0f °C}" if beyond else "jams at {jam:.0f °C}"
        why = f" ({cause})" * beyond
        margin, burnt = min(jam, borne) - hot, hot >= borne
        off = f", {{off:.0f K}} {'above' if margin > 0.0 else 'below'} what they have"
        if burnt:
            hotter = f"; they are hotter than the {{borne:.0f °C}} that they bear ({cause})"
            off = off + hotter if jam < borne else hotter + ", by {off:.0f K}"
        yield answer(
            GAP,
            "jam_margin",
            f"It {jams} of the pinion's teeth{why}, the wheel's changed alike and the "
            f"housing as it is{off}.",
            margin,
            at=at,
            figures={"off": abs(margin)}
            | ({} if beyond else {"jam": jam})
            | ({"borne": borne} if beyond or burnt else {}),
        )
    yield _worst_moment(asked)


def _worst_moment(asked: Asked) -> Answer:
    if (why := asked.unsettled(asked.hardest)) and not asked.lost(asked.hardest):
        return undecided(GAP, "warm_up_backlash", why, limit="backlash")
    try:
        course = asked.warming
    except ThermogearError as error:
        return undecided(GAP, "warm_up_backlash", str(error), limit="backlash")
    worst, at, hot = course.worst, asked.at(asked.hardest), course.operating.no_bath
    if hot[0]:
        return undecided(GAP, "warm_up_backlash", NO_BATH, limit="backlash", at=at)
    least, steady = 2e6 * worst.half_backlash, 2e6 * float(course.half_backlash[-1])
    start = float(course.temperatures["pinion_body"][0]) - ZERO_CELSIUS
    held = " and ".join(name.replace("_", " ") for name in course.held)
    how = f" with {held} held" if held else ""
    how += "" if asked.case.computed else " by the heat balance"
    words = f"Warming up from {{start:.0f °C}}{how} it is"
    burnt, open_at = course.course.too_hot, asked.unsettled(asked.hardest)
    if burnt or open_at or hot.any() or not (course.course.settled or asked.case.computed):
        until, unknown = "within", "it is not steady by then"
        figures = {"start": start, "end": float(course.time[-1]) / 60.0}
        if burnt or open_at:
            unknown = "no steady state is known"
        if hot.any():
            least = 2e6 * float(course.half_backlash[~hot].min())
            figures["end"] = no_bath_from(course) / 60.0
            figures["hottest"] = asked.case.stated.lubricant.hottest_bath - ZERO_CELSIUS
            until, unknown = "until the oil reaches {hottest:.0f °C} after", "no bath exists beyond"
        elif burnt:
            figures["hottest"] = HOTTEST - ZERO_CELSIUS
            until = "until a node reaches {hottest:.0f °C} after"
        return answer(
            GAP, "warm_up_backlash",
            f"{words} at least {{least:.0f µm}} {until} {{end:.3g min}}; {unknown}.",
            np.nan if least > 0.0 else least,
            limit="backlash", at=at, verdict=OPEN if least > 0.0 else LOOK,
            figures={"least": least, **figures},
        )  # fmt: skip
    sentence = f"{words} never less than when steady, {least:.0f} µm."
    between = least_between(course)
    if least < steady - 0.005 * abs(steady) - 0.05:
        sentence = (
            f"{words} least from {{begin:.3g}} to {{finish:.3g min}}, within {{flat:g µm}}: "
            f"{least:.0f} µm, {{steady:.0f µm}} when steady."
        )
    return answer(
        GAP, "warm_up_backlash", sentence, least,
        limit="backlash", at=at, verdict=FINE if least > 0.0 else LOOK,
        figures={"steady": steady, "start": start, "after": worst.time / 60.0,
                 "begin": between[0] / 60.0, "finish": between[1] / 60.0, "flat": 2e6 * FLAT},
        units={"steady": "µm", "after": "min", "begin": "min", "finish": "min", "flat": "µm"},
    )  # fmt: skip


# --- film and scuffing --------------------------------------------------------------------------


def film(asked: Asked) -> Iterator[Answer]:
    case, oil = asked.case, asked.bodies[0]
    stage, assumed = load_stage(case)
    whose = ", assumed" * assumed
    for point in asked.points:
        at = asked.at(point)
        least = float(asked.hot["least_film_parameter"][point])
        unsettled, still = asked.unsettled(point), asked.still(point)
        if still:
            yield undecided(FILM, "film", still, at=at)
        elif not np.isfinite(least):
            yield undecided(FILM, "film", "no film could be computed", at=at)
        else:
            acting = "boundary" if least < 1.0 else "mixed" if least < 3.0 else "full film"
            yield answer(
                FILM, "film",
                f"The least film parameter{asked.worst_pair} is {least:.2f} ({acting}).",
                least, at=at,
            )  # fmt: skip
        torque, speed = (float(asked.hot[f"pinion_{n}"][point]) for n in ("torque", "speed"))
        known = not unsettled or ("oil" in case.gearbox.measured and not asked.no_bath(point))
        why = unrated(case, torque, float(oil[point])) if known else unsettled
        why = why if unsettled else still or why
        if why:
            for name in ("scuffing_margin", "scuffing_safety"):
                yield undecided(FILM, name, why, at=at)
            continue
        state = Scuffing(
            lubricant=case.stated.lubricant, oil_temperature=float(oil[point]), load_stage=stage
        )
        for rating in RATINGS:
            yield _rated(*rating, case, torque, speed, state, whose, at)


def unrated(case: GearCase, torque: float, oil: float) -> str:
    """Why scuffing is not rated at ``torque`` [N m] and ``oil`` [K]; empty where it is."""
    if other := not_steel(case):
        return f"the rating is for steel on steel, not {other}"
    if torque <= 0.0:
        return "there is no load"
    return "" if np.isfinite(oil) else STILL["heat_not_settled"]


RATINGS: tuple[tuple[str, Callable[..., FlashRating | IntegralRating], str, str, str], ...] = (
    (
        "scuffing_margin", flash_rating, "contact", "margin",
        "By flash temperature, with the standard's friction and bulk, the contact reaches "
        "{contact:.0f °C} of {limit:.0f °C} (stage {stage:g}{whose}): margin {margin:.0f K}, "
        "safety {safety:.2f}{sound}.",
    ),
    (
        "scuffing_safety", integral_rating, "integral", "safety",
        "By integral temperature it is {integral:.0f °C} of {limit:.0f °C} (stage {stage:g}"
        "{whose}): safety {safety:.2f}{sound}.",
    ),
)  # fmt: skip
"""Answer, what rates it, the temperature and the figure that decides, and the sentence."""


def _rated(
    name: str, rate: Callable[..., FlashRating | IntegralRating], hottest: str, decides: str,
    words: str, case: GearCase, torque: float, speed: float, state: Scuffing, whose: str, at: str,
) -> Answer:  # fmt: skip
    try:
        found = rate(case.pair, torque, speed, state)._asdict()
    except InputError as error:
        return undecided(FILM, name, str(error), at=at)
    figures: dict[str, Any] = {
        **{one: float(found[one]) - ZERO_CELSIUS for one in (hottest, "limit")},
        "stage": state.load_stage,
        "whose": whose,
        "sound": "; faults are left out of it" * bool(case.faults()),
        **{one: float(found[one]) for one in ("margin", "safety") if one in found},
    }
    return answer(FILM, name, words, figures[decides], at=at, figures=figures)


# --- the teeth's roots ---------------------------------------------------------------------------


THIN_RIM = 1.2
"""Rim [tooth heights] below which its thickness weakens the root: Y_B of ISO 6336-3."""


def _thin(gear: Gear) -> bool:
    """Whether the rim between bore and root circle is thin."""
    height = gear.tip_radius - gear.root_radius
    return gear.root_radius - gear.bore_radius < THIN_RIM * height


def root(asked: Asked) -> Iterator[Answer]:
    """Of both gears, under the shares of the loaded contact over the period of the pair.

    The value is the greatest hot, times the dynamic factor of method B where it covers the point.
    """
    pair, force = asked.case.pair, asked.hot["normal_force"]
    (standard, words), phase = _standard(pair), np.arange(POSITIONS) / POSITIONS
    names = [f"root_{gear.material.name}" for gear in (pair.pinion, pair.wheel)]
    # of one strength, as long as the table knows one alone
    limit = names[0] if LIMITS.keys() >= set(names) else "root_unknown"
    words += "; no fatigue strength is known of a material" * (limit not in LIMITS)
    sound = "; of sound teeth under the loads with the faults" * bool(asked.case.faults())
    for point in asked.points:
        at, load = asked.at(point), float(force[point])
        why = asked.still(point) or "there is no load" * (not load > 0.0)
        if not why and any(_thin(gear) for gear in (pair.pinion, pair.wheel)):
            why = (
                f"a rim is thinner than {THIN_RIM:g} tooth heights, where the bore, held here, "
                "decides"
            )
        if why:
            yield undecided(ROOT, "root_stress", why, limit=limit, at=at)
            continue
        every = turn_phases(asked.mesh_periods, phase)
        hot, cold = (
            root_stress(pair, loaded_pair(elastic).solve(every), asked.model.loaded.plane)
            for elastic in (
                asked.elastic(state, point, asked.case.deviations) for state in (HOT, UNDEFORMED)
            )
        )
        stress, undeformed = ([1e-6 * float(one.stress[0]) for one in both] for both in (hot, cold))
        if not np.isfinite(stress + undeformed).all():
            why = "the loaded contact did not settle"
            yield undecided(ROOT, "root_stress", why, limit=limit, at=at)
            continue
        nominal = 1e-6 * load * np.cos(pair.pinion.pressure_angle)
        nominal /= pair.face_width * pair.pinion.module
        factors = zip(standard.get("form", ()), standard.get("notch", ()), strict=True)
        rated = rated_factor(asked, point)[1].get("factor")
        times = ", without a dynamic factor"
        dynamic = {} if rated is None else {"times": max(stress) * rated, "rated": rated}
        if dynamic:
            times += ", at most {times:.0f MPa} with the {rated:.2f} of ISO 6336-1, method B"
        yield answer(
            ROOT,
            "root_stress",
            "Static, the pinion's fillet carries {hot[0]:.0f MPa} hot and {undeformed[0]:.0f MPa} "
            "undeformed, the wheel's {hot[1]:.0f MPa} and {undeformed[1]:.0f MPa}, about their "
            f"{{slope[0]:.0f}}° and {{slope[1]:.0f}}° tangents{times}; {words}{sound}.",
            dynamic.get("times", max(stress)),
            limit=limit,
            at=at,
            figures={
                "hot": stress,
                "undeformed": undeformed,
                "slope": [float(np.degrees(one.slope[0])) for one in hot],
                **standard,
                "standard": [nominal * form * notch for form, notch in factors],
                **dynamic,
            },
            units={"slope": "°", "standard": "MPa"},
        )


def _standard(pair: GearPair) -> tuple[dict[str, Any], str]:
    """Y_F and Y_S of ISO 6336-3 for both gears and how its stress is told, or why there is none."""
    gears = zip((pair.pinion, pair.wheel), single_contact(pair), strict=True)
    try:
        form, notch = zip(*(root_factors(gear, t) for gear, t in gears), strict=True)
    except ThermogearError as error:
        return {"why": str(error)}, "ISO 6336-3 does not cover it: {why}"
    words = "ISO 6336-3 has {standard[0]:.0f MPa} and {standard[1]:.0f MPa}"
    return {"form": list(form), "notch": list(notch)}, words
