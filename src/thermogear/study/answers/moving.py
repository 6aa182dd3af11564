"""Answers of a moving pair: speeds, dynamic factor, transmission error and relief."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError
from thermogear.base.limits import FINE, LOAD_SHARE, PARTING
from thermogear.base.units import RPM
from thermogear.case.case import GearCase
from thermogear.case.thermal_state import HOT, UNDEFORMED, ThermalState
from thermogear.dynamics.turns import longest
from thermogear.gears.accuracy import EDITIONS, flank_tolerances
from thermogear.gears.deviations import GEARS, Deviation, PressureAngleError, Relief
from thermogear.gears.dynamic_factor import dynamic_factor
from thermogear.gears.iso6336 import iso6336_stiffness
from thermogear.results.answer import Answer
from thermogear.study.answers.asked import POSITIONS, Asked, answer, undecided
from thermogear.study.speeds import LOST, Speeds, told

SPEEDS = "At which speeds does it resonate?"
LOADS, ERROR = "How large is the dynamic factor?", "How large is the transmission error?"

LOOKED = "speed looked at, {looked[0]:~3 rpm} to {looked[1]:~3 rpm}"
LATER = "the later half of the {followed} mesh periods followed"
"""Over what figures are those of a motion over a turn that does not settle."""
OF_SPEEDS = {"ranges": "rpm", "looked": "rpm", "there": "rpm", "strong": "rpm", "off": "%",
             "most": "%"}  # fmt: skip
"""Units of figures that not every sentence states."""
RELIEFS = (0.25, 0.5, 0.75, 1.0, 1.25, 1.5)
"""Tip reliefs that are tried, over the mean deflection of the loaded teeth."""


# --- speeds -------------------------------------------------------------------------------------


def speeds(asked: Asked) -> Iterator[Answer]:
    found = asked.speeds
    if found is None or not np.isfinite(found.column("contact_loss_share")).any():
        why = asked.still(asked.hardest) or (
            "its mesh has no stiffness that moves" if found is None else
            asked.motionless(asked.hardest)
        )  # fmt: skip
        for name in ("resonance", "contact_loss", "back_contact", "coexisting"):
            yield undecided(SPEEDS, name, why)
        return
    factor = asked.motion["dynamic_factor"]
    yield resonance(asked, found.peaks(), factor, "greatest dynamic factors", ".2f")
    speed, share = found.column("pinion_speed"), found.column("contact_loss_share")
    moves = np.isfinite(asked.motion["contact_loss_share"])
    # a motion beside the one from rest counts too: a run may end on it
    some = moves.any(axis=1)
    loss, force = (asked.motion[n][some] for n in ("contact_loss_share", "mesh_force_min"))
    parted, struck = (loss > LOST).any(axis=1), (force < 0.0).any(axis=1)
    ends = (float(speed.min()), float(speed.max()))
    open_at = "; at {unsettled} of {speeds} speeds no motion settles" * (found.unsettled > 0)
    of_open = {"unsettled": found.unsettled, "speeds": found.grid.size} if open_at else {}
    if open_at and asked.mesh_periods > 1:
        open_at += f": {LATER} counts"
        of_open["followed"] = longest(asked.mesh_periods)
    for name, ranges, happens, never, apart in (
        ("contact_loss", found.lost,
         ("Flanks lose contact", ", for up to {most:.0f %} of the time"),
         "Flanks keep contact at every", parted),
        ("back_contact", found.back, ("Teeth hit the back side", ""),
         "No tooth hits the back side at any",
         struck),
    ):  # fmt: skip
        words, figures = told(ranges, ends=ends)
        sentence = f"{happens[0]} {words}{happens[1]}" if ranges else f"{never} {LOOKED}"
        if name == "back_contact" and asked.mesh_periods > 1:
            sentence += ", were the backlash all along the least of the turn, {gap:.1f µm}"
            figures["gap"] = 2e6 * float(asked.hot["least_half_backlash"][asked.hardest])
        if apart.any():
            sentence += (
                f"; {'so' if ranges else 'otherwise'} at {{points}} of {{of}} operating points"
            )
        figures |= {"points": int(apart.sum()), "of": apart.size} | (
            {"most": 100.0 * float(np.nanmax(share))} if name == "contact_loss" else {}
        )
        sentence = (sentence if apart.size else _faster(asked, sentence)) + open_at
        figures |= of_open
        value = 100.0 * float(np.mean(apart)) if apart.size else float("nan")
        yield answer(SPEEDS, name, f"{sentence}.", value, figures=figures, units=OF_SPEEDS)
    yield _coexisting(asked, found, moves & (asked.motion["undecided"] != 1.0), ends)


def _coexisting(
    asked: Asked, found: Speeds, moves: NDArray[np.bool_], ends: tuple[float, float]
) -> Answer:
    """Whether a second motion exists; ``moves`` (point, motion): what settles at its own speeds."""
    words, figures = told(found.several, ends=ends)
    several = moves.sum(axis=1) > 1
    sentence = (
        f"Two motions exist {words}: it may jump there, up and down elsewhere"
        if found.several
        else f"One motion exists at every {LOOKED}: no jump"
        if found.open == 0
        else f"Where motions settle, one exists at every {LOOKED}"
    )
    if several.any():
        sentence += "; two or more at {points} of {of} operating points"
        figures |= {"points": int(several.sum()), "of": several.size}
    # what does not settle may be another motion, which a jump ends on
    waits = bool(not several.any() and (asked.motion["undecided"] == 1.0).any())
    value = 2.0 if several.any() else float("nan") if waits else 1.0
    sentence += "; at its own speeds another motion does not settle" * waits
    if not moves.any():
        sentence, value = _faster(asked, sentence), float("nan")
    sentence += "; at {open} of {speeds} speeds a motion does not settle, which may be another" * (
        found.open > 0
    )
    figures |= {"open": found.open, "speeds": found.grid.size}
    return answer(SPEEDS, "coexisting", f"{sentence}.", value, figures=figures, units=OF_SPEEDS)


def _faster(asked: Asked, sentence: str) -> str:
    """What the look over speeds says where no speed of the case itself is one of a motion."""
    words = f"{sentence[0].lower()}{sentence[1:]}"
    return f"Not decided at its own speeds, {asked.motionless(asked.hardest)}; elsewhere, {words}"


def resonance(
    asked: Asked,
    tops: Sequence[tuple[float, float]],
    factor: Floats,
    words: str,
    form: str,
    *,
    point: int | None = None,
) -> Answer:
    """How far the case's speeds are off the resonances.

    These are where the mesh frequency meets the natural one, the ``tops`` (speed [rad/s], dynamic
    factor) with one above :data:`~thermogear.base.limits.PARTING`, and a speed of the case itself
    where its ``factor`` (point, motion) is: it is off by nothing. ``words`` say what the tops are,
    ``form`` with how many digits. All of the operating ``point``, where one is given.
    """
    own = asked.case.stated.speed
    of, at = (asked.hardest, "") if point is None else (point, asked.at(point))
    own = own if point is None else own[[point]]
    factor = np.where(np.isfinite(factor), factor, 0.0).max(axis=1)  # without load there is none
    natural = np.sqrt(asked.hot["mean_stiffness"][of] / asked.case.equivalent_mass)
    main = float(natural) / asked.case.pair.pinion.teeth
    strong = [main, *(speed for speed, top in tops if top > PARTING)]
    off = 100.0 * np.abs(own[:, None] / np.array(strong) - 1.0)
    place, nearest = np.unravel_index(int(off.argmin()), off.shape)
    shaken = bool(np.any(factor > PARTING))
    value = 0.0 if shaken else float(off.min())
    figures = {
        "natural": main * asked.case.pair.pinion.teeth / (2e3 * np.pi),
        "main": main / RPM,
        "top": [top for _, top in tops[:4]],
        "there": [speed / RPM for speed, _ in tops[:4]],
        "own": float(own[place]) / RPM,
        "off": value,
        "strong": strong[nearest] / RPM,
        "limit": PARTING,
    }
    each = [f"{{top[{i}]:{form}}} at {{there[{i}]:~3 rpm}}" for i in range(len(tops[:4]))]
    greatest = f"{words}: {', '.join(each)}" if each else "no peak stands out"
    where = "{own:~3 rpm} is {off:.1f %} off {strong:~3 rpm}" + (
        ", the nearest factor above {limit:g}" if nearest else ", where both meet"
    )
    if shaken:
        place = np.argmax(factor)
        figures |= {"own": float(own[place]) / RPM, "factor": float(factor[place])}
        where = f"at its own {{own:~3 rpm}} it is {{factor:{form}}}"
    return answer(
        SPEEDS,
        "resonance",
        "The mesh frequency meets the natural one, {natural:.2f kHz}, at {main:~3 rpm}; "
        f"{greatest}; {where}.",
        value,
        at=at,
        figures=figures,
        units=OF_SPEEDS,
    )


# --- dynamic factor and error -------------------------------------------------------------------


def loads(asked: Asked) -> Iterator[Answer]:
    for point in asked.points:
        at = asked.at(point)
        factors = asked.motion["dynamic_factor"][point]
        rested, every = bool(np.isfinite(factors[0])), factors[np.isfinite(factors)]
        words, figures = rated_factor(asked, point)
        rated = figures.get("factor", np.inf)
        limit = "dynamic_factor" if rated < PARTING else "parting"
        about = {"limit": limit, "most": min(rated, PARTING), "at": at}
        if not every.size:
            why = f"{asked.still(point) or asked.motionless(point)}; ISO 6336-1 {words}"
            yield undecided(LOADS, "dynamic_factor", why, figures=figures, **about)
            continue
        figures |= {"own": float(every.max())}
        gives = "{own:.2f}" + " in a motion beside the one from rest, which does not settle" * (
            not rested
        )
        if every.size > 1 and rested:
            figures |= {"motions": every.tolist()}
            others = ", ".join(f"{{motions[{n}]:.2f}}" for n in range(1, every.size))
            gives = f"{{motions[0]:.2f}} from rest, {others} in another motion at the same speed"
        if asked.motion["undecided"][point][np.nanargmax(factors)] == 1.0:
            gives += f", the greatest in a motion that does not settle, over {LATER}"
            figures["followed"] = longest(asked.mesh_periods)
        if point == asked.hardest and asked.assemblies[1].size:
            gives += (
                " as its teeth are numbered, {smallest:.2f} to {largest:.2f} in {assemblies} of "
                "its {possible} assemblies"
            )
            figures |= _spread(asked, asked.assemblies[1], figures["own"])
        sentence = f"The vibration computed gives {gives}; ISO 6336-1 {words}."
        yield answer(LOADS, "dynamic_factor", sentence, figures["own"], figures=figures, **about)


def rated_factor(asked: Asked, point: int) -> tuple[str, dict[str, Any]]:
    """What method B says of a point, in words with their figures; why not where it does not."""
    torque, speed = (float(asked.hot[f"pinion_{n}"][point]) for n in ("torque", "speed"))
    grade, edition, whose = _class(asked.case)
    try:
        rated = dynamic_factor(asked.case.pair, torque, speed, grade=grade, edition=edition)
    except InputError as error:
        return "does not cover it: {why}", {"why": str(error)}
    figures = {"factor": float(rated.factor), "ratio": float(rated.ratio), "grade": grade}
    known = f"class {{grade}}{whose}, resonance ratio {{ratio:.2f}}"
    return f"method B {{factor:.2f}} ({known})", figures


BY_FAULTS = "; the faults move it by up to {faulty:.2f µm} within a mesh period, judged if more"


def of_faults(asked: Asked, point: int) -> dict[str, float]:
    """What faults move the error by within a mesh period, hot [um]; nothing without faults.

    The greatest of the turn, of the case's own part; what a shaft turns once is little of it.
    """
    if not asked.case.faults():
        return {}
    phase = np.arange(POSITIONS) / POSITIONS
    faulty, sound = (
        asked.elastic(HOT, point, case.deviations).over(phase).transmission_error[0]
        for case in (asked.case, asked.case.sound())
    )
    moved = (faulty - np.resize(sound, faulty.size)).reshape(-1, POSITIONS)
    return {"faulty": 1e6 * float(np.ptp(moved, axis=1).max())}


def errors(asked: Asked) -> Iterator[Answer]:
    swing = {
        name: 1e6 * np.ptp(cycle["transmission_error"], axis=-1)
        for name, cycle in (("cold", asked.cold), ("hot", asked.hot))
    }
    # what a shaft turns once is no noise of the mesh: the limit is for what repeats with it
    turn = asked.mesh_periods
    with_mesh = 1e6 * np.ptp(of_the_mesh(asked.hot["transmission_error"], turn), axis=-1)
    for point in asked.points:
        at = asked.at(point)
        words, figures = allowed_error(asked.case, float(asked.hot["pinion_torque"][point]))
        most = figures.get("made", np.inf) + figures.get("load", np.inf)
        if why := asked.still(point):
            yield undecided(ERROR, "transmission_error", why, most=most, at=at)
            continue
        figures |= {name: float(values[point]) for name, values in swing.items()}
        over = ", over the turn of {turn} mesh periods," * (turn > 1)
        of_mesh = ", of which the {mesh:.2f µm} that repeat with the mesh are judged" * (turn > 1)
        figures |= {"turn": turn, "mesh": float(with_mesh[point])} if turn > 1 else {}
        faulty = of_faults(asked, point)
        figures |= faulty
        sentence = (
            f"Static and loaded{over} it is {{cold:.2f µm}} peak to peak undeformed, "
            f"{{hot:.2f µm}} hot{of_mesh}{BY_FAULTS * len(faulty)}; {words}"
        )
        if point == asked.hardest and asked.assemblies[0].size:
            sentence += (
                "; {assemblies} of its {possible} assemblies have {smallest:.2f µm} to "
                "{largest:.2f µm}: state gears.marks"
            )
            figures |= _spread(asked, 1e6 * asked.assemblies[0], figures["hot"])
        judged = max(float(with_mesh[point]), *faulty.values(), 0.0)
        value = judged if np.isfinite(most) else float("nan")
        yield answer(
            ERROR, "transmission_error", f"{sentence}.", value, most=most, at=at, figures=figures
        )
    yield relief(asked)


def _spread(asked: Asked, others: Floats, value: float) -> dict[str, float]:
    """Least and greatest of the assemblies: the ``value`` of the case's own, and the ``others``."""
    values = np.append(others, value)
    return {
        "smallest": float(np.nanmin(values)),
        "largest": float(np.nanmax(values)),
        "assemblies": int(np.isfinite(values).sum()),
        "possible": asked.case.assembly_count,
    }


def of_the_mesh(error: Floats, turn: int) -> Floats:
    """The mean of an error (point, phase) over the mesh periods of a turn, (point, phase)."""
    return np.asarray(error.reshape(len(error), turn, -1).mean(axis=1))


def _class(case: GearCase) -> tuple[int, str, str]:
    """The class of ISO 1328-1 that the flanks are of, the worse gear's and 6 where none is known;
    the edition that counts so, and how it is known."""
    if case.period.mesh_periods > 1 and (grade := case.turn_class) is not None:
        return grade, EDITIONS[0], ", as its teeth are"
    drawn = case.file.flanks if case.accuracy is not None else None
    known = [grade for grade in (case.accuracy, case.measured_class) if grade is not None]
    whose = "" if drawn else ", profiles as measured" if known else ", assumed"
    return max(known, default=6), drawn.edition if drawn else EDITIONS[0], whose


def allowed_error(case: GearCase, torque: float) -> tuple[str, dict[str, Any]]:
    """What manufacture and the load leave of transmission error, in words with figures [um].

    f_Halpha + f_falpha of both gears: flanks within the tolerances of their class lead by no more
    without load. And :data:`~thermogear.base.limits.LOAD_SHARE` of w/c', w at the pitch circle.
    """
    pair, (grade, edition, whose) = case.pair, _class(case)
    load = torque / (pair.pinion.pitch_radius * pair.face_width)
    single = float(iso6336_stiffness(pair, load).single)
    try:
        tolerances = [
            flank_tolerances(one.teeth, one.module, grade=grade, edition=edition)
            for one in (pair.pinion, pair.wheel)
        ]
    except InputError as error:
        return "ISO 1328-1 has no tolerance for it: {why}", {"why": str(error)}
    figures = {
        "grade": grade,
        "made": 1e6 * sum(one.profile_slope + one.profile_form for one in tolerances),
        "load": 1e6 * LOAD_SHARE * load / single if single > 0.0 else 0.0,
    }
    of_class = f"class {{grade}}{whose}{',' * bool(whose)}"
    return f"{of_class} allows {{made:.1f µm}}, the load {{load:.1f µm}}", figures


def relief(asked: Asked) -> Answer:
    """The best of a few tip reliefs at the hardest point, hot, and the same one undeformed.

    Of the mean tooth, of a series the flanks as designed: relief is cut alike on all.
    """
    case, point = asked.case, asked.hardest
    if why := asked.still(point):
        return undecided(ERROR, "relief", why)
    if any(isinstance(one, Relief) and one.end == "tip" for one in case.deviations):
        return answer(
            ERROR, "relief", "The flanks have one; `thermogear relief` looks for a better.",
            float("nan"), verdict=FINE,
        )  # fmt: skip
    force = float(asked.hot["normal_force"][point])
    deflection = force / float(asked.hot["mean_stiffness"][point])
    length = case.pair.path.e - case.pair.path.d
    flanks, of_whom = asked.mean_tooth, "it" if asked.mesh_periods == 1 else "the mean tooth's"
    if asked.series:
        flanks = tuple(each for each in flanks if isinstance(each, Relief | PressureAngleError))
        of_whom = "the error of true flanks"
    states = {}
    cuts: list[tuple[Deviation, ...]] = [()]
    for share in RELIEFS:
        amount = share * deflection
        cuts.append(tuple(Relief(gear, amount=amount, length=length) for gear in GEARS))
    for number_of, (name, state) in enumerate((("cold", UNDEFORMED), ("hot", HOT))):
        asked.progress("relief", number_of, 2)
        states[name] = [_swing(asked, state, (*flanks, *cut), case.mesh_positions) for cut in cuts]
    asked.progress("relief", 2, 2)
    cold, hot = (np.array(states[name]) for name in ("cold", "hot"))
    best, other = int(np.argmin(hot)), int(np.argmin(cold))
    amounts = np.array([0.0, *RELIEFS]) * 1e6 * deflection
    gain = 100.0 * (1.0 - hot[best] / hot[0])
    figures = {
        "relief": float(amounts[best]),
        "before": float(hot[0]),
        "after": float(hot[best]),
        "undeformed": float(amounts[other]),
        "left": float(hot[other]),
    }
    sentence = (
        f"A linear tip relief of {{relief:.1f µm}} on both gears makes {of_whom} "
        "{before:.2f µm} → "
        "{after:.2f µm} hot; the best one undeformed, {undeformed:.1f µm}, leaves "
        "{left:.2f µm} hot."
        if gain >= 1.0
        else "Of the linear tip reliefs tried, alike on both gears, no one makes it smaller, hot; "
        "`thermogear relief` looks among all amounts and lengths."
    )
    units = dict.fromkeys(figures, "µm")
    about: dict[str, Any] = {"at": asked.at(point), "figures": figures, "units": units}
    if asked.in_series:
        # what helps true flanks may make most pairs of a class worse
        why = "for pairs of the class `thermogear relief` judges"
        sentence = f"{sentence[0].lower()}{sentence[1:]}".removesuffix(".")
        return undecided(ERROR, "relief", f"{why}; {sentence}", **about)
    return answer(ERROR, "relief", sentence, gain, **about)


def _swing(
    asked: Asked, state: ThermalState, deviations: Sequence[Deviation], positions: int
) -> float:
    """Static error peak to peak [um] at the hardest point, with these ``deviations``."""
    elastic = asked.elastic(state, asked.hardest, deviations)
    curves = elastic.over(np.arange(positions) / positions)
    return float(1e6 * np.ptp(curves.transmission_error[0]))
