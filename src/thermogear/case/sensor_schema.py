"""The table of the case file that says which thermometers watch the gears, and how."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field, model_validator

from thermogear.base import bounds
from thermogear.base.errors import InputError
from thermogear.case.fields import Choice, Measure, Number, Several, measure
from thermogear.case.table import Body, Table

_Gear = Annotated[str, Choice("pinion", "wheel")]
BAND = (8e-6, 14e-6)
"""Wavelengths [m] of an uncooled camera."""
_Share = Number(low=0.01, high=1.0, example="0.9")


class ThermocoupleTable(Table):
    """A thermocouple buried in a tooth, telemetry or slip rings behind it."""

    gear: _Gear = Field(default="pinion", description="the pinion, whose teeth are the hotter")
    depth: Annotated[float, measure("length", bounds.DEPTH, example="2 mm")] = Field(
        default=2e-3, description="2 mm below the flank, towards the root"
    )


class RingTable(Table):
    """A thermometer on a ring around the shaft, between gear and bearing."""

    gear: _Gear = Field(default="pinion", description="on the pinion's shaft")
    distance: Annotated[float, Measure("length", "0 mm", "10000 mm", example="20 mm")] = Field(
        default=0.02, description="20 mm from the gear along the shaft"
    )


class InfraredTable(Table):
    """An infrared camera on the flanks as they leave the mesh."""

    gear: _Gear = Field(default="pinion", description="on the pinion's flanks")
    emissivity: Annotated[float, _Share] = Field(
        default=0.9, description="0.9, a flank under a film of oil"
    )
    instrument_emissivity: Annotated[float, _Share] = Field(
        default=1.0, description="the camera is set to a black body: nothing is corrected"
    )
    wavelengths: Annotated[
        tuple[float, ...] | None,
        Several(Measure("length", "0.5 um", "50 um", example="8 um"), least=2, most=2),
    ] = Field(default=None, description="8 to 14 um, an uncooled camera")
    transmission: Annotated[float, _Share] = Field(
        default=0.93, description="0.93, one coated window"
    )
    surroundings: Body | None = Field(
        default=None, description="the flank mirrors the housing's walls"
    )
    window_temperature: Body | None = Field(
        default=None, description="the window is as warm as the ambient"
    )

    @property
    def band(self) -> tuple[float, float]:
        """The camera's wavelengths [m]."""
        low, high = self.wavelengths or BAND
        return low, high

    @model_validator(mode="after")
    def _rising(self) -> InfraredTable:
        low, high = self.band
        if low > high:
            raise InputError(
                "wavelengths",
                f"{1e6 * low:g} um before {1e6 * high:g} um",
                allowed="the shorter first",
            )
        return self


class SensorsTable(Table):
    """What thermometers would show: a thermocouple in a tooth, a ring on a shaft, a camera."""

    thermocouple: ThermocoupleTable | None = Field(default=None, title="every value ours")
    ring: RingTable | None = Field(default=None, title="every value ours")
    infrared: InfraredTable | None = Field(default=None, title="every value ours")
