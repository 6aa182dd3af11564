"""What a reader should know beside the numbers: of motions over a range, of friction and heat."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.analysis.settle import LABELS, PERIODIC
from thermogear.base.display import CELSIUS, reach, stretches
from thermogear.base.units import RPM
from thermogear.base.vocabulary import STILL, moves
from thermogear.case.case import GearCase
from thermogear.heat.friction import LUBRICATED, beyond
from thermogear.results.beside import from_data, with_notices
from thermogear.results.result import Notice, Result, stored_dataset

if TYPE_CHECKING:
    import xarray as xr


NOT_DECIDED = "whether contact is lost is not decided: 0 of {} points are valid"
"""Where no point has status ok: what rests on no oil bath proves nothing."""


def finished(data: xr.Dataset, title: str = "") -> Result:
    """What a store of long work holds, with what should be known beside it."""
    return stored_dataset(with_notices(data), title)


def contact_notices(data: xr.Dataset) -> list[str]:
    """What does not move; over which speeds contact is lost, and where the back flanks are hit."""
    found = still_notices(data)
    moving = moves(data["status"].values)
    over_speed = "contact_loss_share" in data and "pinion_speed" in data["label"].dims
    if not (over_speed and moving.any()):
        return found
    speeds = data["pinion_speed"].values / RPM
    axis = data["label"].dims.index("pinion_speed")
    others = tuple(i for i in range(data["label"].ndim) if i != axis)
    share = data["contact_loss_share"].values
    lost = moving & (share > 0.0)
    valid = int(((data["status"].values == 0) & np.isfinite(share)).sum())
    never = f"contact is never lost at the {valid} of {moving.size} points that are valid"
    # of a motion that is not periodic the impacts are not counted; its least force tells
    hit = moving & ((data["back_impacts"].values > 0) | (data["mesh_force_min"].values < 0.0))
    for flags, yes, no in (
        (lost, "contact is lost", never if valid else NOT_DECIDED.format(moving.size)),
        (hit, "the back flanks are hit", ""),
    ):
        here = np.asarray(flags.any(axis=others))
        if here.any():
            found.append(f"{yes} at {stretches(speeds, here)} rpm (in any state, up or down)")
        elif no:
            found.append(no)
    return found


def differing(data: xr.Dataset) -> NDArray[np.bool_]:
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


def difference_notices(data: xr.Dataset) -> list[str]:
    """Over which speeds the runs up and down show different motions."""
    here = np.asarray(differing(data).any(axis=0))
    if not here.any():
        return []
    speeds = data["pinion_speed"].values / RPM
    return [f"up and down differ at {stretches(speeds, here)} rpm (in any state)"]


def range_notices(case: GearCase, data: xr.Dataset) -> list[str]:
    """Contact, the back side, and where the case's speeds lie."""
    found = contact_notices(data) + from_data(data)
    ratio = data["frequency_ratio"].values if "frequency_ratio" in data else np.empty(0)
    ratio = ratio[np.isfinite(ratio)]
    frequency = data["mesh_frequency"].values if "mesh_frequency" in data else np.empty(0)
    frequency = frequency[np.isfinite(frequency)]
    if ratio.size:
        natural = float(np.median(frequency / ratio))
        turns = 60.0 / case.pair.pinion.teeth
        speeds = np.array(case.speeds)
        tests = case.pair.pinion.teeth * speeds / (2.0 * math.pi) / natural
        shown = ", ".join(f"{s / RPM:.4g}" for s in speeds)
        found.append(
            f"the range covers omega_h {reach(ratio, '.3f')}; the mesh meets the "
            f"natural frequency of the mean stiffness, {natural:.0f} Hz, at "
            f"{natural * turns:.0f} rpm; the case's own speeds ({shown} rpm) lie at omega_h "
            f"{reach(tests, '.3f')}"
        )
    return found


def still_notices(data: xr.Dataset) -> list[str]:
    """How many points of a sweep or run-up have no motion, and why."""
    label = data["label"].values
    counts = {word: int(np.sum(label == LABELS.index(word))) for word in STILL}
    return [
        f"{count} of {label.size} points have no motion ({word.replace('_', ' ')}): {STILL[word]}"
        for word, count in counts.items()
        if count
    ]


def reasons(why: Iterable[str]) -> str:
    """Why points have no value at all, each reason once."""
    each = "; ".join(dict.fromkeys(why))
    return f" No value: {each}." if each else ""


def several_words(data: xr.Dataset, settled: NDArray[np.bool_]) -> str:
    """That points of a heat balance have two steady states, and which one is told; "" if none."""
    several = settled & (data["several"].values == 1)
    number, count = int(several.sum()), settled.size
    if not number:
        return ""
    hotter = data["hot_node_temperature"] - data["node_temperature"]
    most = float(hotter.sel(node="oil").values[several].max())
    some = "1 point has" if number == 1 else f"{number} points have"
    some = "The point has" if count == 1 else f"Of {count} points, {some}"
    far = f", up to {most:.1f} K hotter" if np.isfinite(most) else ""
    come = "it comes" if number == 1 else "they come"
    return (
        f"{some} another steady state when {come} from hot{far}: thinner oil lets the layer on "
        "the gears turn turbulent, which drags more. All figures are those of the state reached "
        "from cold."
    )


def friction_notices(case: GearCase, groups: Mapping[str, xr.Dataset]) -> Iterator[Notice]:
    """What the friction laws say of themselves: pitch point, ranges, the oil's range."""
    if np.isfinite(groups["path"]["friction_coefficient_mixed"].values).any():
        yield Notice(
            "info",
            "Benedict and Kelley's friction diverges where nothing slides; near the pitch "
            "point the sliding speed is held above 1 % of the entrainment speed, and the "
            "coefficient is 0 where the logarithm's argument falls below 1.",
        )
    path = groups["path"]
    for place, model in enumerate(case.models):
        here = path.isel(bundle=place)
        hot = here.isel(state=-1)
        known = np.isfinite(hot["friction_coefficient"].values)
        share = float((known & (hot["friction_outside_range"].values == 1)).mean())
        if share > 0.0:
            yield Notice(
                "important",
                f"{model.name}: the friction law {model.law.name} is outside its range on "
                f"{100.0 * share:.0f} % of the path (hot, all operating points).",
            )
        eta = groups["mesh"].isel(bundle=place, state=-1)["dynamic_viscosity"].values
        left = _left_out(case, here.isel(state=-1), eta)
        if left:
            yield Notice(
                "info",
                f"{model.name}: the band of friction laws leaves out, where they are outside "
                f"their range: {'; '.join(left)}.",
            )
    yield from _film_beyond_oil(case, groups)


def _film_beyond_oil(case: GearCase, groups: Mapping[str, xr.Dataset]) -> Iterator[Notice]:
    """Where the film forms at flanks that leave the range of the oil's viscosity line."""
    oil = case.stated.lubricant
    low, high = (CELSIUS.text(t, 1) for t in oil.temperature_range)
    for place, model in enumerate(case.models):
        hot = groups["mesh"].isel(bundle=place, state=-1)["film_outside_range"].values == 1
        where = ["the hot state"] if hot.any() else []
        if "temperature" in groups:
            row = groups["temperature"].isel(bundle=place)
            beyond_oil = row["film_outside_range"] == 1
            axes = [d for d in beyond_oil.dims if d != "gear_temperature"]
            at = row["gear_temperature"].values[beyond_oil.any(axes).values]
            where += [CELSIUS.text(float(t), 1) for t in at]
        if where:
            yield Notice(
                "info",
                f"{model.name}: the film forms at flanks that leave the range of {oil.name}'s "
                f"viscosity line ({low} to {high}, from 2 mm²/s on): {', '.join(where)}. The "
                "viscosity there is drawn out.",
            )


def _left_out(case: GearCase, here: xr.Dataset, viscosity: NDArray[np.float64]) -> list[str]:
    """Laws of oiled contacts outside their range, with the part of the path [%]."""
    pair = case.pair
    values: dict[str, ArrayLike | None] = {
        "roughness": 0.5 * (pair.pinion.roughness + pair.wheel.roughness),
        "viscosity": viscosity[:, None],
        "film_parameter": here["film_parameter"].values,
    }
    parts = ((law.name, 100.0 * float(np.mean(beyond(law, values)))) for law in LUBRICATED)
    return [f"{name} on {part:.0f} % of the path" for name, part in parts if part > 0.0]


def up_and_down(count: int, *, held: int) -> str:
    """That a run-up and a run-down differ on ``count`` stretches, on ``held`` of them to stay."""
    rate = "the difference comes from the rate of the run"
    words = f"up and down differ on {count} stretch{'es' * (count > 1)} of speed; "
    if not held:
        return f"{words}at a steady speed no second motion was found there, {rate}"
    jumps = "two motions exist at a steady speed too, so that a run jumps at its ends"
    return f"{words}on {held} of them {jumps}{f'; on the others {rate}' * (held < count)}"
