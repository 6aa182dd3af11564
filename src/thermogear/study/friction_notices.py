"""What the friction laws of a run say of themselves: pitch point, ranges, the oil's range."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from thermogear.base.display import CELSIUS
from thermogear.case.case import GearCase
from thermogear.heat.friction import LUBRICATED, beyond
from thermogear.results.result import Notice

Floats = NDArray[np.float64]


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
        share = float((here["friction_outside_range"].isel(state=-1).values == 1).mean())
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


def _left_out(case: GearCase, here: xr.Dataset, viscosity: Floats) -> list[str]:
    """Laws of oiled contacts outside their range, with the part of the path [%]."""
    pair = case.pair
    values: dict[str, ArrayLike | None] = {
        "roughness": 0.5 * (pair.pinion.roughness + pair.wheel.roughness),
        "viscosity": viscosity[:, None],
        "film_parameter": here["film_parameter"].values,
    }
    parts = ((law.name, 100.0 * float(np.mean(beyond(law, values)))) for law in LUBRICATED)
    return [f"{name} on {part:.0f} % of the path" for name, part in parts if part > 0.0]
