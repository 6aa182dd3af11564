"""What a reader should know beside the numbers: of motions over a range, of friction and heat."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.analysis.settle import LABELS, PERIODIC
from thermogear.base.arrays import Dataset
from thermogear.base.vocabulary import STILL, moves
from thermogear.case.case import GearCase
from thermogear.heat.friction import LUBRICATED, beyond
from thermogear.results.beside import from_data, with_notices
from thermogear.results.result import Notice, Result, stored_dataset
from thermogear.study.declared import fault_notices


def finished(data: Dataset, title: str = "") -> Result:
    """What a store of long work holds, with what should be known beside it."""
    return stored_dataset(with_notices(data), title)


def turn_notices(case: GearCase, alike: str | None = None) -> Iterator[Notice]:
    """That the teeth of ``case`` differ, and what is taken of them, where they do.

    ``alike``: what is that of the mean tooth all the same.
    """
    if case.period.mesh_periods > 1:
        yield Notice.of("turn_taken", mesh_periods=case.period.mesh_periods, alike=alike)


def contact_notices(data: Dataset) -> Iterator[Notice]:
    """What does not move; over which speeds contact is lost, and where the back flanks are hit."""
    status = data["status"].values
    for word in STILL:
        # of a motion that was not computed, the label says why
        count = int(np.sum(data["label"].values == LABELS.index(word)))
        if count:
            yield Notice.of(f"points_{word}", count=count, points=status.size)
    moving = moves(status)
    if not ("contact_loss_share" in data and "pinion_speed" in data["label"].dims and moving.any()):
        return
    share = data["contact_loss_share"].values
    lost = moving & (share > 0.0)
    # of a motion that is not periodic the impacts are not counted; its least force tells
    hit = moving & ((data["back_impacts"].values > 0) | (data["mesh_force_min"].values < 0.0))
    valid = int(((status == 0) & np.isfinite(share)).sum())
    if lost.any():
        yield Notice.of("contact_lost", **_at_speeds(data, lost))
    else:
        yield Notice.of(
            "contact_never_lost" if valid else "contact_loss_not_decided",
            valid=valid,
            points=status.size,
        )
    if hit.any():
        yield Notice.of("back_flanks_hit", **_at_speeds(data, hit))


def _at_speeds(data: Dataset, flags: NDArray[np.bool_]) -> dict[str, Any]:
    """Stretches of speed [rad/s] on which ``flags`` hold anywhere, all speeds, number of states."""
    dims, ways = data["label"].dims, data["label"].sizes.get("direction", 1)
    axis = flags.ndim - len(dims) + dims.index("pinion_speed")
    here = np.moveaxis(flags, axis, -1).reshape(-1, flags.shape[axis]).any(axis=0)
    ends = np.flatnonzero(np.diff(np.concatenate([[0], here.astype(int), [0]]))).reshape(-1, 2)
    speeds = data["pinion_speed"].values
    return {
        "speeds": [[speeds[first], speeds[end - 1]] for first, end in ends],
        "computed": [[speeds[0], speeds[-1]]],
        "states": data["label"].size // (ways * speeds.size),
    }


def differing(data: Dataset) -> NDArray[np.bool_]:
    """Where the runs up and down differ, (state, speed).

    Of orbits the period, or the transmission error by 0.1 % of its peak to peak; of chaos, whose
    extremes are chance, by a quarter of it; an orbit and chaos always.
    """
    both = moves(data["status"].values).all(axis=1)
    size = data["dte_peak_to_peak"].values
    period = np.where(data["label"].values == PERIODIC, data["period"].values, 0)
    apart = np.abs(size[:, 0] - size[:, 1]) / np.maximum(size[:, 0], size[:, 1])
    least = np.where(period[:, 0] > 0, 1e-3, 0.25)
    return np.asarray(both & ((period[:, 0] != period[:, 1]) | (apart > least)))


def difference_notices(data: Dataset) -> Iterator[Notice]:
    """Over which speeds the runs up and down show different motions."""
    apart = differing(data)
    if apart.any():
        yield Notice.of("up_and_down_differ", **_at_speeds(data, apart))


def range_notices(case: GearCase, data: Dataset) -> Iterator[Notice]:
    """Faults, contact, the back side, and where the case's speeds lie."""
    yield from fault_notices(case, varied=[str(name) for name in data.coords])
    yield from contact_notices(data)
    yield from from_data(data)
    ratio = data["frequency_ratio"].values if "frequency_ratio" in data else np.empty(0)
    if not np.isfinite(ratio).any():
        return
    natural = np.nanmedian(data["mesh_frequency"].values / ratio)
    resonance = 2.0 * math.pi * natural / case.pair.pinion.teeth
    speeds = np.array(case.speeds)
    yield Notice.of(
        "range_of_frequencies",
        ratios=[[np.nanmin(ratio), np.nanmax(ratio)]],
        natural_frequency=natural,
        resonance=resonance,
        speeds=speeds,
        at=[[speeds.min() / resonance, speeds.max() / resonance]],
    )


_NUMBER = re.compile(r"\d+(?:\.\d+)?(?:e[-+]?\d+)?")


def _grouped(reasons: Iterable[str]) -> list[str]:
    """Reasons that differ in numbers alone are one: how many, and between what the numbers lie."""
    alike: dict[str, list[list[str]]] = {}
    for reason in reasons:
        alike.setdefault(_NUMBER.sub("\0", reason), []).append(_NUMBER.findall(reason))
    found = []
    for words, rows in alike.items():
        ends = [(min(each, key=float), max(each, key=float)) for each in zip(*rows, strict=True)]
        many = f" ({len(rows)} points)" if any(least != most for least, most in ends) else ""
        spans = [" to ".join(dict.fromkeys(span)) for span in ends]
        parts = zip(words.split("\0"), [*spans, many], strict=True)
        found.append("".join(part + span for part, span in parts))
    return found


def heat_notices(
    data: Dataset, settled: NDArray[np.bool_], why: Iterable[str], about: str = ""
) -> Iterator[Notice]:
    """Points of a heat balance without a steady temperature, and those with a second one."""
    lost = int((~settled).sum())
    if lost:
        yield Notice.of(
            "heat_not_settled",
            about=about,
            lost=lost,
            points=settled.size,
            reasons=_grouped(why) or None,
        )
    several = settled & (data["several"].values == 1)
    if several.any():
        hotter = data["hot_node_temperature"] - data["node_temperature"]
        yield Notice.of(
            "second_steady_state",
            about=about,
            several=several.sum(),
            points=settled.size,
            hotter=hotter.sel(node="oil").values[several].max(),
        )


def jam_notices(data: Dataset, reference: float, about: str = "") -> Iterator[Notice]:
    """Gear temperatures at which the backlash is used up, alone and with all bodies.

    In proportion it is the one nearest to the ``reference`` [K], from where all bodies go.
    """
    alone, together = (
        values[np.isfinite(values)]
        for values in (data["jam_temperature"].values, data["proportional_jam_temperature"].values)
    )
    if alone.size:
        yield Notice.of("jam_of_gears_alone", about=about, temperature=alone.min())
    if together.size:
        nearest = together[np.argmin(np.abs(together - reference))]
        yield Notice.of("jam_in_proportion", about=about, reference=reference, temperature=nearest)
    elif alone.size:
        yield Notice.of("no_jam_in_proportion", about=about)


def friction_notices(case: GearCase, groups: Mapping[str, Dataset]) -> Iterator[Notice]:
    """What the friction laws say of themselves: pitch point, ranges, the oil's range."""
    path, mesh = groups["path"], groups["mesh"]
    if np.isfinite(path["friction_coefficient_mixed"].values).any():
        yield Notice.of("friction_at_pitch_point")
    oil = case.stated.lubricant
    for place, model in enumerate(case.models):
        hot, cycle = (data.isel(bundle=place, state=-1) for data in (path, mesh))
        known = np.isfinite(hot["friction_coefficient"].values)
        share = float((known & (hot["friction_outside_range"].values == 1)).mean())
        if share > 0.0:
            yield Notice.of(
                "friction_law_outside", about=model.name, law=model.law.name, share=share
            )
        left = _left_out(case, hot, cycle["dynamic_viscosity"].values)
        if left:
            yield Notice.of(
                "friction_laws_left_out", about=model.name, laws=[*left], shares=[*left.values()]
            )
        warm = (
            _beyond_oil(groups["temperature"].isel(bundle=place)) if "temperature" in groups else []
        )
        hot_too = bool((cycle["film_outside_range"] == 1).any())
        if hot_too or warm:
            yield Notice.of(
                "film_beyond_oil",
                about=model.name,
                oil=oil.name,
                range=[list(oil.temperature_range)],
                hot=hot_too,
                temperatures=warm or None,
            )


def _beyond_oil(row: Dataset) -> list[float]:
    """Gear temperatures [K] at which the film leaves the range of the oil's viscosity line."""
    beyond_oil = row["film_outside_range"] == 1
    axes = [d for d in beyond_oil.dims if d != "gear_temperature"]
    temperatures: list[float] = row["gear_temperature"].values[beyond_oil.any(axes).values].tolist()
    return temperatures


def _left_out(case: GearCase, here: Dataset, viscosity: NDArray[np.float64]) -> dict[str, float]:
    """Laws of oiled contacts outside their range, with the share of the path."""
    pair = case.pair
    values: dict[str, ArrayLike | None] = {
        "roughness": 0.5 * (pair.pinion.roughness + pair.wheel.roughness),
        "viscosity": viscosity[:, None],
        "film_parameter": here["film_parameter"].values,
    }
    shares = {law.name: float(np.mean(beyond(law, values))) for law in LUBRICATED}
    return {name: share for name, share in shares.items() if share > 0.0}
