"""The section with the temperature dial."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from thermogear.base.display import CELSIUS, SPEED, number
from thermogear.results.result import Result
from thermogear.views.moving import Dial
from thermogear.views.page import Pictures, Section
from thermogear.views.plots import dial as plot

if TYPE_CHECKING:
    import xarray as xr

NAME = "dial"
NEEDS = ("mesh_stiffness", "half_backlash", "status")


def section(results: Result, pictures: Pictures) -> Section | None:
    """Stiffness, backlash and orbit over a dial of the gears' temperature; None without one."""
    data = results.group("dial")
    if data is None:
        return None
    values = [f"{number(float(CELSIUS(t)))} °C" for t in data["gear_temperature"].values]
    start = int(data.attrs["start"])
    turned = Dial(
        "temperature of both gears",
        values,
        [f"{t}: {plot.told(data, i)}" for i, t in enumerate(values)],
        start,
        partial(plot.at, data),
    )
    pictures.add(
        NAME, "Turn the temperature", caption(data, values[start]), data, NEEDS,
        partial(plot.at, data, start), wide=True, dial=turned,
    )  # fmt: skip
    return Section("dial", "Over temperature", pictures.take())


def caption(data: xr.Dataset, start: str) -> str:
    """Which operating point, and what is shown without the dial."""
    torque, speed = float(data.attrs["pinion_torque"]), SPEED(data.attrs["pinion_speed"])
    jammed = int(data.attrs["jammed"])
    some = f" {jammed} of {data.sizes['gear_temperature']} temperatures jam." if jammed else ""
    return (
        f"At {speed:.6g} rpm and {torque:.6g} N m, both gears at one temperature, the other bodies "
        f"as temperatures.follow says. A still picture shows {start}. Each orbit is settled by "
        f"itself: where several motions exist, another start may find another one.{some}"
    )
