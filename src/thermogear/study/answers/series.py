"""Answers of a series: pairs of one class, each over its turn, at the case's bounds of damping."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from thermogear.analysis.order_statistics import proportion
from thermogear.base.arrays import Dataset, Floats
from thermogear.base.limits import LIMITS, OPEN, PARTING
from thermogear.base.units import RPM
from thermogear.base.vocabulary import label
from thermogear.dynamics.turns import UNBOUNDED
from thermogear.results.answer import Answer
from thermogear.results.result import Notice
from thermogear.study.answers import steady
from thermogear.study.answers.asked import Asked, answer, undecided
from thermogear.study.answers.moving import (
    BY_FAULTS,
    ERROR,
    LOADS,
    OF_SPEEDS,
    SPEEDS,
    allowed_error,
    of_faults,
    rated_factor,
    relief,
    resonance,
)
from thermogear.study.series import BAND, SeriesPoint, Spread, middle_and_worst
from thermogear.study.speeds import LOST, peaks

# --- backlash -----------------------------------------------------------------------------------


def gap(asked: Asked) -> Iterator[Answer]:
    """What is left of the backlash of one part, and of those of the series."""
    yield from steady.gap(asked)
    for point, parts in asked.series.items():
        jammed, count = parts.jammed, len(parts.jammed)
        hits = int(np.count_nonzero(jammed))
        possible = 100.0 * proportion(hits, of=count).high
        least = 2e6 * parts.mesh.half_backlash.min(axis=1)
        figures: dict[str, Any] = Spread.of(least[~jammed]).figures("left")
        figures |= {"jammed": hits, "parts": count, "possible": possible}
        sentence = "{jammed} of {parts} pairs of the class jam hot"
        if hits < count:
            sentence += (
                "; of the others {left_low:.0f} to {left_high:.0f µm} are left in {held:.0f %}"
            )
        share, most = 100.0 * hits / count, LIMITS["parting_pairs"].most
        verdict = _unsure(share, possible, most)
        if verdict:
            sentence += "; not decided, as so few pairs do not exclude {possible:.0f %} that jam"
        units = {name: "µm" for name in figures if name.startswith("left_")}
        yield answer(
            steady.GAP, "series_backlash", f"{sentence}.", share, limit="parting_pairs",
            verdict=verdict, at=asked.at(point), figures=figures, units=units,
        )  # fmt: skip


# --- speeds -------------------------------------------------------------------------------------


def speeds(asked: Asked) -> Iterator[Answer]:
    for point in asked.points_of_series:
        at, parts = asked.at(point), asked.series.get(point)
        if parts is None or asked.slow(point):
            why = asked.still(point) or asked.motionless(point)
            for name in ("resonance", "contact_loss", "back_contact", "coexisting"):
                yield undecided(SPEEDS, name, why, at=at)
            continue
        motion = parts.motion
        worst = np.array([Spread.of(row).bad.value for row in motion.dynamic_factor[0].T])
        yield resonance(
            asked, peaks(motion.speed, top=worst), worst[None, [parts.place]],
            "greatest dynamic factors that one pair in ten exceeds", ".1f", point=point,
        )  # fmt: skip
        lost, struck = motion.contact_loss_share > LOST, motion.mesh_force_min < 0.0
        yield _parting(parts, "contact_loss", lost, "Flanks part", at)
        yield _parting(parts, "back_contact", struck, "Teeth hit the back side", at)
        unlike = np.isfinite(motion.dynamic_factor) & ~motion.alike
        yield _parting(parts, "coexisting", unlike, "Two starts of a pair stay apart", at)


def _parting(
    parts: SeriesPoint, name: str, happens: NDArray[np.bool_], words: str, at: str
) -> Answer:
    """In how many pairs it ``happens`` (damping, part, speed) up to the own speed of the point."""
    speed, dampings = parts.motion.speed, parts.motion.damping_ratio
    top = float(speed[parts.place])
    within = happens[:, :, speed <= top * (1.0 + 1e-9)].any(axis=2)
    counts = parts.counts
    hits = within.sum(axis=1)
    shares = 100.0 * hits / counts
    onset = np.where(happens[0].any(axis=1), speed[happens[0].argmax(axis=1)], np.inf)[: counts[0]]
    # onsets jump: the value of a rank, no mean of several
    middle, first = float(np.sort(onset)[(onset.size - 1) // 2]), float(onset.min())
    bounds = [
        proportion(int(hit), of=max(int(of), 1)) for hit, of in zip(hits, counts, strict=True)
    ]
    possible = np.array([100.0 * bound.high for bound in bounds])
    figures: dict[str, Any] = {
        "pairs": int(hits[0]), "parts": int(counts[0]), "top": top / RPM,
        "share_interval": [100.0 * bounds[0].low, float(possible[0])],
        "dampings": dampings.tolist(), "shares": shares.tolist(), "beyond": float(speed[-1]) / RPM,
    }  # fmt: skip
    sentence = f"{words} in {{pairs}} of {{parts}} pairs of the class up to {{top:~3 rpm}}"
    if math.isfinite(first):
        figures["first"] = first / RPM
        sentence += ", first at {first:~2 rpm}"
    else:
        sentence += ", at no speed up to {beyond:~2 rpm}"
    if math.isfinite(middle):
        figures["half"] = middle / RPM
        sentence += ", in half of them by {half:~2 rpm}"
    most = LIMITS["parting_pairs"].most
    more, beside = _by_damping(dampings, shares, most)
    if dampings.size > 1:
        figures |= {"least": float(dampings[1]), "pairs_there": int(hits[1]), "of": int(counts[1])}
        sentence += "; with a damping of {least:~2} in {pairs_there} of {of}"
    verdict = _unsure(shares.max(), possible.max(), most)
    if verdict:
        figures["possible"] = float(possible.max())
        more += "; not decided, as so few pairs do not exclude {possible:.0f %}"
    return answer(
        SPEEDS, name, f"{sentence}{more}.", float(shares.max()), limit="parting_pairs", at=at,
        figures=figures | beside, verdict=verdict,
        units=OF_SPEEDS | {"shares": "%", "share_interval": "%", "beyond": "rpm"},
    )  # fmt: skip


def _unsure(value: float, high: float, most: float) -> str:
    """The verdict "not decided" where a ``value`` within its bound has an interval that is not.

    ``high``: upper end of its 95 % interval. Empty where the bound decides.
    """
    return OPEN if value <= most < high else ""


def _by_damping(dampings: Floats, values: Floats, most: float) -> tuple[str, dict[str, Any]]:
    """Between which computed dampings a value comes within its bound, in words with figures.

    Empty where all or none of the ``values`` (damping,) are within it.
    """
    order = np.argsort(dampings)
    within = values[order] <= most
    if within.all() or not within[-1]:
        return "", {}
    last = int(np.flatnonzero(~within)[-1])
    low, high = dampings[order][last : last + 2]
    return "; beyond the limit below a damping between {from_damping:~2} and {to_damping:~2}", {
        "from_damping": float(low), "to_damping": float(high)
    }  # fmt: skip


# --- dynamic factor and error -------------------------------------------------------------------


def loads(asked: Asked) -> Iterator[Answer]:
    for point in asked.points_of_series:
        words, figures = rated_factor(asked, point)
        rated = figures.get("factor", np.inf)
        limit = "dynamic_factor" if rated < PARTING else "parting"
        about: dict[str, Any] = {"limit": limit, "most": min(rated, PARTING), "at": asked.at(point)}
        parts = asked.series.get(point)
        if parts is None or asked.slow(point):
            why = f"{asked.still(point) or asked.motionless(point)}; ISO 6336-1 {words}"
            yield undecided(LOADS, "dynamic_factor", why, figures=figures, **about)
            continue
        dampings = parts.motion.damping_ratio
        each = [Spread.of(row) for row in parts.motion.dynamic_factor[:, :, parts.place]]
        form, values = f".{each[0].digits - 1}f", np.array([spread.bad.value for spread in each])
        figures |= each[0].figures("part") | {
            "parts": int(parts.counts[0]), "dampings": dampings.tolist(), "bad": values.tolist(),
        }  # fmt: skip
        gives = (
            f"{{part_middle:{form}}} in the median of {{parts}} pairs, {{part_low:{form}}} to "
            f"{{part_high:{form}}} in {{held:.0f %}} of them; one in ten exceeds {{bad[0]:{form}}}"
        )
        if dampings.size > 1:
            gives += f", or {{bad[1]:{form}}} with a damping of {{dampings[1]:~2}}"
        words_of, sizes = _what_moves(asked, point, form)
        figures |= sizes
        more, beside = _by_damping(dampings, values, about["most"])
        worst, high = float(values.max()), max(spread.bad.high for spread in each)
        verdict = _unsure(worst, high, about["most"])
        if verdict:
            more += "; not decided, as so few pairs do not exclude more"
        sentence = f"The vibration computed gives {gives}{words_of}{more}; ISO 6336-1 {words}."
        yield answer(
            LOADS, "dynamic_factor", sentence, worst, figures=figures | beside, verdict=verdict,
            **about,
        )  # fmt: skip


MOVES_IT = {
    "by_part": "the part, in 90 % of pairs", "by_damping": "the damping",
    "by_temperature": "the heat of half-wetted gears",
}  # fmt: skip
"""What moves the dynamic factor, in words."""


def _what_moves(asked: Asked, point: int, form: str) -> tuple[str, dict[str, float]]:
    """What part, damping and temperature move the dynamic factor by, in words with figures.

    The part: width of the band of 90 % of pairs; the others: how far the median of the same parts
    moves from the first damping to another, and to the temperatures with half of the gears wetted.
    """
    parts = asked.series[point]
    first, *others = parts.motion.dynamic_factor[:, :, parts.place]
    band, warmer = Spread.of(first), asked.wetter_factors(point)
    sizes = {
        "by_part": band.high.value - band.low.value,
        "by_damping": max([_median_moves(first, other) for other in others], default=np.nan),
        "by_temperature": np.nan if warmer is None else _median_moves(first, warmer),
    }
    sizes = {name: size for name, size in sizes.items() if np.isfinite(size)}
    if len(sizes) < 2:
        return "", sizes
    decides = max(sizes, key=lambda name: sizes[name]).removeprefix("by_")
    narrows = ", which a measured one narrows" if decides == "damping" else ""
    each = ", ".join(f"{{{name}:{form}}} with {MOVES_IT[name]}" for name in sizes)
    return f"; it moves by {each}: the {decides} decides{narrows}", sizes


def _median_moves(before: Floats, after: Floats) -> float:
    """How far the median moves of the parts that both know; (part,), ``after`` of the first few."""
    known = np.flatnonzero(np.isfinite(after) & np.isfinite(before[: after.size]))
    return abs(Spread.of(after[known]).middle.value - Spread.of(before[known]).middle.value)


def errors(asked: Asked) -> Iterator[Answer]:
    for point in asked.points_of_series:
        words, figures = allowed_error(asked.case, float(asked.hot["pinion_torque"][point]))
        most = figures.get("made", np.inf) + figures.get("load", np.inf)
        about: dict[str, Any] = {"most": most, "at": asked.at(point)}
        parts = asked.series.get(point)
        if parts is None:
            why = asked.still(point) or asked.motionless(point)
            yield undecided(ERROR, "transmission_error", why, **about)
            continue
        turn, mesh = (Spread.of(values) for values in parts.errors)
        figures |= turn.figures("turn", 1e6) | mesh.figures("mesh", 1e6)
        gears = asked.case.pair
        figures |= {
            "parts": int(np.isfinite(parts.errors[0]).sum()), "periods": parts.mesh.mesh_periods,
            "of_turn": math.lcm(gears.pinion.teeth, gears.wheel.teeth),
        }  # fmt: skip
        followed = ", by {periods} of them," * (not parts.mesh.whole)
        faulty = of_faults(asked, point)
        figures |= faulty
        form, of_mesh = f"~{turn.digits}", f"~{mesh.digits}"
        sentence = (
            f"Static, loaded and hot, over the turn of {{of_turn}} mesh periods{followed} it is "
            f"{{turn_low:{form}}} to {{turn_high:{form} µm}} peak to peak in {{held:.0f %}} of "
            f"{{parts}} pairs; what repeats with the mesh is judged, {{mesh_middle:{of_mesh} µm}} "
            f"in the median, one in ten exceeds {{mesh_bad:{of_mesh} µm}}"
            f"{BY_FAULTS * len(faulty)}; {words}."
        )
        judged = max(1e6 * mesh.bad.value, *faulty.values(), 0.0)
        value = judged if np.isfinite(most) else float("nan")
        about["units"] = {name: "µm" for name in figures if name.startswith(("turn_", "mesh_"))}
        yield answer(ERROR, "transmission_error", sentence, value, figures=figures, **about)
    yield relief(asked)


# --- behind the answers -------------------------------------------------------------------------


def gravest(asked: Asked) -> int:
    """The operating point with the greatest dynamic factor at the bad end, of those that move."""
    return max(
        asked.series,
        key=lambda point: max(
            np.nan_to_num(Spread.of(row).bad.value)
            for row in asked.series[point].motion.dynamic_factor[:, :, asked.series[point].place]
        ),
    )


def data(asked: Asked) -> Dataset:
    """Each operating point over speed and damping as quantiles of parts, every part at its own.

    SI; at dampings after the first nan above the own speed. ``contact_loss_onset`` is nan of a part
    that keeps contact at every speed followed. Attribute ``gravest``: place along ``operating`` of
    the point of :func:`gravest`.
    """
    points = list(asked.series)
    every = [_of_point(asked.series[point]) for point in points]
    stated = asked.case.stated
    along, each = ("operating", "damping", "speed"), ("operating", "damping", "part")
    words = {
        "dynamic_factor": (
            ("operating", "quantile", "damping", "speed"), "1",
            "dynamic factor that a share of parts does not exceed",
        ),
        "parting_share": (along, "1", "share of parts that lose contact"),
        "own_dynamic_factor": (each, "1", "dynamic factor of each part at the own speed"),
        "contact_loss_onset": (
            each, "rad/s", "least speed at which contact is lost; nan: at none",
        ),
        "turn_error": (("operating", "part"), "m", "static error of each part, peak to peak"),
        "mesh_error": (("operating", "part"), "m", "what of it repeats with the mesh"),
    }  # fmt: skip
    motion = asked.series[points[0]].motion
    return label(
        {
            name: (dims, np.array([values[name] for values in every]), unit, long_name)
            for name, (dims, unit, long_name) in words.items()
        },
        {
            "own_speed": ("operating", stated.speed[points], "rad/s", "own pinion speed"),
            "pinion_torque": ("operating", stated.torque[points], "N m", "pinion torque"),
            "pinion_speed": ("speed", motion.speed, "rad/s", "pinion speed"),
            "damping_ratio": ("damping", motion.damping_ratio, "1", "damping ratio"),
            "quantile": ("quantile", np.array(BAND), "1", "share of parts"),
            "drawing": ("part", np.arange(asked.case.series), "1", "flanks.drawing of the part"),
        },
        {"gravest": points.index(gravest(asked)), "seed": asked.case.seed},
    )


def _of_point(parts: SeriesPoint) -> dict[str, Floats]:
    """The variables of :func:`data` at one operating point."""
    motion, factor = parts.motion, parts.motion.dynamic_factor
    over = [[Spread.of(part) for part in row.T] for row in factor]
    lost = motion.contact_loss_share > LOST
    turn, mesh = parts.errors
    return {
        "dynamic_factor": np.array([
            [[getattr(spread, which).value for spread in row] for row in over]
            for which in ("low", "middle", "high")
        ]),
        "parting_share": np.where(
            np.isfinite(factor).any(axis=1), lost.sum(axis=1) / parts.counts[:, None], np.nan
        ),
        "own_dynamic_factor": factor[:, :, parts.place],
        "contact_loss_onset": np.where(
            lost.any(axis=2), motion.speed[lost.argmax(axis=2)], np.nan
        ),
        "turn_error": turn,
        "mesh_error": mesh,
    }  # fmt: skip


def notice(asked: Asked) -> Notice:
    """What the series is, what of it is assumed, and which parts are its median and worst."""
    point = gravest(asked)
    parts = asked.series[point]
    median, worst = middle_and_worst(parts.motion.dynamic_factor[0, :, parts.place]) or (None, None)
    several = asked.count > 1
    answered = len(asked.points_of_series)
    return Notice.of(
        "answers_of_a_series",
        parts=int(parts.counts[0]),
        still=asked.case.series - int(parts.counts[0]) or None,
        accuracy=asked.case.accuracy,
        seed=asked.case.seed,
        median=median,
        worst=worst,
        speed=float(asked.case.stated.speed[point]) if several else None,
        torque=float(asked.case.stated.torque[point]) if several else None,
        answered=None if answered == asked.count else answered,
        points=asked.count,
        unbounded=UNBOUNDED if np.nanmax(parts.motion.dynamic_factor) >= UNBOUNDED else None,
        periods=None if parts.mesh.whole else parts.mesh.mesh_periods,
    )
