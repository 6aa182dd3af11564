"""Tables of the case file that say what heats and cools the pair, and what a thermometer read."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field, model_validator

from thermogear.base import bounds
from thermogear.base.errors import InputError
from thermogear.case.fields import Choice, Measure, Number, Several, measure
from thermogear.case.table import Body, Table
from thermogear.heat.gearbox import Surroundings
from thermogear.mesh.balance import Gearbox

_AROUND, _BOX = Surroundings(), Gearbox()
_Sigma = Annotated[float, Measure("temperature difference", "0 K", "100 K", example="1 K")]


class MeasuredTable(Table):
    """Measured temperatures that hold single nodes of the heat balance."""

    oil: Body | None = None
    housing: Body | None = None
    pinion_tooth: Body | None = None
    pinion_body: Body | None = None
    pinion_shaft: Body | None = None
    wheel_tooth: Body | None = None
    wheel_body: Body | None = None
    wheel_shaft: Body | None = None


NODES = tuple(MeasuredTable.model_fields)
"""The nodes that a thermometer may hold."""


class ReadingTable(Table):
    """What one thermometer showed, and what is known of how it looked; uncertainties are sigmas."""

    kind: Annotated[str, Choice("infrared", "thermocouple")]
    indicated: Body
    indicated_uncertainty: _Sigma = Field(default=0.0, description="the reading taken as exact")
    emissivity: Annotated[float | None, Number(low=0.01, high=1.0, example="0.95")] = None
    emissivity_uncertainty: Annotated[float | None, Number(low=0.0, high=0.5, example="0.02")] = (
        None
    )
    surroundings: Body | None = None
    transmission: Annotated[float | None, Number(low=0.01, high=1.0, example="0.93")] = None
    window_temperature: Body | None = None
    wavelengths: Annotated[
        tuple[float, ...] | None,
        Several(Measure("length", "0.5 um", "50 um", example="8 um"), least=2, most=2),
    ] = None
    depth: Annotated[float | None, measure("length", bounds.DEPTH, example="1 mm")] = None
    depth_uncertainty: Annotated[
        float | None, Measure("length", "0 mm", "10 mm", example="0.2 mm")
    ] = None
    flux: Annotated[float | None, Measure("heat flux", "-1000 kW/m^2", "1000 kW/m^2")] = None
    flux_uncertainty: Annotated[float | None, Measure("heat flux", "0 kW/m^2", "500 kW/m^2")] = None

    @model_validator(mode="after")
    def _belongs(self) -> ReadingTable:
        infrared: tuple[str, ...] = (
            "emissivity",
            "emissivity_uncertainty",
            "surroundings",
            "transmission",
            "window_temperature",
            "wavelengths",
        )
        inside: tuple[str, ...] = ("depth", "depth_uncertainty", "flux", "flux_uncertainty")
        own, foreign, needed = (
            (infrared, inside, ("emissivity", "surroundings"))
            if self.kind == "infrared"
            else (inside, infrared, ("depth", "flux"))
        )
        for name in foreign:
            if getattr(self, name) is not None:
                raise InputError(
                    name,
                    f"a value of no use to a reading of kind {self.kind}",
                    allowed=" | ".join(own),
                    fix="leave it out",
                )
        for name in needed:
            if getattr(self, name) is None:
                raise InputError(
                    name, "nothing", why=f"the correction of a reading of kind {self.kind} needs it"
                )
        return self


class ReadingsTable(Table):
    """Thermometer readings that hold single nodes once they are corrected."""

    oil: ReadingTable | None = None
    housing: ReadingTable | None = None
    pinion_tooth: ReadingTable | None = None
    pinion_body: ReadingTable | None = None
    pinion_shaft: ReadingTable | None = None
    wheel_tooth: ReadingTable | None = None
    wheel_body: ReadingTable | None = None
    wheel_shaft: ReadingTable | None = None


class GearboxTable(Table):
    """What surrounds the pair, for temperatures computed from the heat balance."""

    ambient: Body = Field(
        default=_AROUND.ambient,
        description="a room at 20 degC. Decides what every temperature starts from",
    )
    housing_area: Annotated[float, Measure("area", "0.0001 m^2", "1000 m^2")] | None = Field(
        default=None,
        description="that of a box around the gears, 20 mm from their tips and as "
        "wide as face and shafts. Decides, with its coefficient, how warm all becomes",
    )
    housing_coefficient: (
        Annotated[float, Measure("heat transfer coefficient", "0.1 W/(m^2 K)", "10000 W/(m^2 K)")]
        | None
    ) = Field(
        default=None,
        description="middle of the customary 10 to 25 to still air, with the housing at 60 degC; "
        "it grows with the housing's temperature by free convection and radiation, a number given "
        "does not. Decides, with its area, how warm all becomes",
    )
    oil_housing_coefficient: Annotated[
        float,
        Measure(
            "heat transfer coefficient",
            "0.1 W/(m^2 K)",
            "100000 W/(m^2 K)",
            example="200 W/(m^2 K)",
        ),
    ] = Field(
        default=_AROUND.oil_housing_coefficient,
        description="200 W/(m^2 K), splashed walls. Decides how much warmer the oil is than "
        "the housing",
    )
    wetted_share: Annotated[
        tuple[float, ...], Several(Number(low=0.001, high=1.0, example="0.3"), least=1, most=2)
    ] = Field(
        default=_AROUND.wetted_share,
        description="oil covers 0.3 of both gears' surface. Decides how much warmer gears "
        "are than the oil",
    )
    shaft_length: Annotated[float, Measure("length", "0.1 mm", "10000 mm", example="60 mm")] = (
        Field(
            default=_AROUND.shaft_length,
            description="60 mm from the gear to each bearing. Decides the heat through the "
            "shafts, and "
            "how wide the housing is",
        )
    )
    bearing_conductance: Annotated[
        float, Measure("thermal conductance", "0.01 W/K", "10000 W/K")
    ] = Field(
        default=_AROUND.bearing_conductance,
        description="10 W/K of one bearing. Decides the heat through the shafts",
    )
    oil_mass: Annotated[float, Measure("mass", "0.001 kg", "100000 kg")] | None = Field(
        default=None,
        description="that box filled up to the immersion of the wheel; decides the "
        "warm-up time alone",
    )
    housing_mass: Annotated[float, Measure("mass", "0.01 kg", "1e6 kg", example="40 kg")] | None = (
        Field(
            default=None,
            description="walls of that box, 8 mm of the housing's material; decides the warm-up "
            "time alone",
        )
    )
    housing_specific_heat: (
        Annotated[float, measure("specific heat", bounds.SPECIFIC_HEAT)] | None
    ) = Field(
        default=None,
        description="that of the housing's material; decides the warm-up time alone",
    )
    oil_flow: Annotated[float, Measure("volume flow", "0 l/min", "10000 l/min")] = Field(
        default=_AROUND.oil_flow,
        description="a closed bath, no oil cooler. Decides where the losses go",
    )
    supply_temperature: Body = Field(
        default=_AROUND.supply_temperature, description="60 degC. Decides nothing in a closed bath"
    )
    immersion: Annotated[float, Number(low=0.0, high=1.0, example="0.3")] = Field(
        default=_BOX.immersion,
        description="the wheel dips 0.3 of its tip radius; 0 is spray. Decides the churning loss",
    )
    bearing_coefficient: Annotated[float, Number(low=0.0, high=0.099, example="0.0015")] = Field(
        default=_BOX.bearing_coefficient,
        description="0.0015, deep-groove ball bearings. Decides their loss",
    )
    measured: MeasuredTable | None = Field(default=None, title="no node is held")
    readings: ReadingsTable | None = Field(default=None, title="no thermometer")

    @model_validator(mode="after")
    def _once(self) -> GearboxTable:
        if self.measured is None or self.readings is None:
            return self
        for name in NODES:
            both = [getattr(table, name) for table in (self.measured, self.readings)]
            if None not in both:
                raise InputError(
                    f"readings.{name}",
                    "a reading beside a measured temperature of the same node",
                    allowed="one of the two",
                    fix="leave one out",
                )
        return self
