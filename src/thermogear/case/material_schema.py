"""Tables of the case file that name or describe materials and oils."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field, model_validator

from thermogear.base import bounds
from thermogear.base.errors import InputError
from thermogear.case.fields import Measure, Number, Several, Words, measure
from thermogear.case.table import Below, Body, Table, not_both


class MaterialTable(Table):
    """A material of the user's own."""

    youngs_modulus: Annotated[float, measure("pressure", bounds.YOUNGS_MODULUS)]
    poisson_ratio: Annotated[float, Number(low=0.0, high=0.499, example="0.3")]
    density: Annotated[float, measure("density", bounds.DENSITY)]
    thermal_conductivity: Annotated[float, measure("thermal conductivity", bounds.CONDUCTIVITY)]
    specific_heat: Annotated[float, measure("specific heat", bounds.SPECIFIC_HEAT)]
    thermal_expansion: Annotated[float, measure("thermal expansion", bounds.EXPANSION)]
    modulus_slope: Annotated[
        float, measure("thermal expansion", bounds.MODULUS_SLOPE, example="3.3e-4 1/K")
    ] = Field(default=0.0, description="Young's modulus taken as independent of temperature")
    tempering_temperature: Annotated[
        float | None, measure("temperature", bounds.TEMPERING, example="180 degC")
    ] = Field(default=None, description="no limit known")


class HousingTable(Table):
    """The housing, which carries the axes."""

    material: Annotated[str, Words('"steel"')] = Field(
        default="steel",
        description="expands like the gears. Decides how far the axes move "
        "apart, and so how much of the backlash heat takes",
    )
    mass: Annotated[float, Measure("mass", "0.01 kg", "1e6 kg", example="40 kg")] | None = Field(
        default=None, title="of the part that vibrates on its feet; left out: it stands still"
    )
    mount_stiffness: Annotated[
        tuple[float, ...] | None,
        Several(Measure("stiffness", "1 N/m", "1e13 N/m", example="50 N/um"), least=1, most=2),
    ] = Field(default=None, title="of the feet, along x and y")
    mount_damping: Annotated[
        float, Measure("damping", "0 N s/m", "1e8 N s/m", example="2000 N s/m")
    ] = Field(default=0.0, title="of the feet")

    @model_validator(mode="after")
    def _on_feet(self) -> HousingTable:
        if (self.mass is None) != (self.mount_stiffness is None):
            missing = "mass" if self.mass is None else "mount_stiffness"
            raise InputError(missing, "nothing", why="mass and mount_stiffness go together")
        return self


class OilTable(Table):
    """The oil: a named set, or two viscosities."""

    name: Annotated[str, Words('"ISO VG 100"')] = Field(
        default="ISO VG 100",
        description="a usual mineral gear oil. Its viscosity decides film, "
        "friction and flash temperature",
    )
    viscosity_40: Annotated[
        float | None, Measure("kinematic viscosity", "1 mm^2/s", "100000 mm^2/s")
    ] = Field(default=None, title="from the named set")
    viscosity_100: Annotated[
        float | None,
        Measure("kinematic viscosity", "0.8 mm^2/s", "10000 mm^2/s", example="11 mm^2/s"),
    ] = Field(default=None, title="from the named set")
    density_15: Annotated[
        float | None, measure("density", bounds.OIL_DENSITY, example="885 kg/m^3")
    ] = Field(default=None, title="from the named set")
    temperature: Body | None = None
    temperature_below_addendum: Below | None = None
    flash_point: Body | None = Field(
        default=None, title="unknown: no oil bath is taken to exist above 150 degC"
    )
    scuffing_load_stage: Annotated[
        float | None,
        Number(low=1.0, high=14.0, example="12", why="load stages of the FZG test A/8.3/90"),
    ] = Field(default=None, title="unknown: no scuffing margin")

    @model_validator(mode="after")
    def _complete(self) -> OilTable:
        not_both(self, "temperature", "temperature_below_addendum")
        own = (self.viscosity_40, self.viscosity_100, self.density_15)
        if any(v is not None for v in own) and any(v is None for v in own):
            raise InputError(
                "",
                "a part of an oil",
                allowed="viscosity_40, viscosity_100 and density_15 together, or the name alone",
            )
        if own[0] is not None and own[1] is not None and own[1] >= own[0]:
            raise InputError(
                "viscosity_100",
                "a viscosity not below viscosity_40",
                why="an oil grows thinner as it warms up",
            )
        return self
