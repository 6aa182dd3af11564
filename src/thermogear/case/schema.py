"""The case file as pydantic models: what may be written, before anything is computed from it.

A field without a default must be in the file. A described default is a value that is ours:
whoever leaves it out finds it among the assumptions of the case, the description as the reason.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import is_dataclass
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import Field, StrictBool, create_model, model_validator
from pydantic.json_schema import models_json_schema

from thermogear.base import bounds
from thermogear.base.errors import InputError
from thermogear.base.toml import at_the_ends
from thermogear.base.units import ZERO_CELSIUS
from thermogear.case.dimensionless_schema import DimensionlessFile, SimulationTable
from thermogear.case.fault_schema import MOST_FAULTS, FaultTable
from thermogear.case.fields import (
    BODY,
    FOLLOW,
    Choice,
    Count,
    Measure,
    Module,
    NameOrTable,
    Number,
    Several,
    Words,
    measure,
)
from thermogear.case.flank_schema import (
    EccentricityTable,
    EnclosedTable,
    FlanksTable,
    ProfileTable,
    ReliefTable,
    ToothProfilesTable,
    ToothTable,
)
from thermogear.case.gearbox_schema import GearboxTable
from thermogear.case.sensor_schema import SensorsTable
from thermogear.case.shaft_schema import (
    MOST_BEARINGS,
    MOST_DISCS,
    BearingTable,
    DiscTable,
    EndTable,
    MotorTable,
    ShaftTable,
    TrainTable,
    require_few,
)
from thermogear.case.table import Below, Body, Length, Table, not_both, one_of
from thermogear.heat.friction import LAWS, LUBRICATED
from thermogear.heat.law_parameters import parameters, ranges, require_known
from thermogear.mesh.model import CHOICES, DECIDES


def _reader(name: str, laws: Sequence[object]) -> Any:
    """What reads the parameter ``name`` of some ``laws``; each law knows its own range."""
    having = [law for law in laws if name in parameters(law)]
    values = [parameters(law)[name] for law in having]
    inner = [value for value in values if is_dataclass(value)]
    if inner:
        return _table(
            f"{name.capitalize()}Table", "The law inside a law, with its parameters.", inner
        )
    if isinstance(values[0], bool):
        return StrictBool
    known = [one[name] for one in (ranges(type(law)) for law in having) if name in one]
    usual = next((f"{value:g}" for value in values if value is not None), "1")
    if not known:
        return Annotated[float, Number(example=usual)]
    low, high = min(one.least for one in known), max(one.most for one in known)
    return Annotated[float, Number(low=low, high=high, example=usual)]


def _usual(name: str, laws: Sequence[Any]) -> str:
    """The default of a parameter, with the laws that have it."""
    having: dict[str, list[str]] = {}
    for law in laws:
        if name in (known := parameters(law)):
            value = known[name]
            words = "by the oil" if value is None else str(getattr(value, "name", value))
            having.setdefault(words, []).append(law.name)
    return "; ".join(f"{words} ({', '.join(names)})" for words, names in having.items())


def _table(name: str, words: str, laws: Sequence[object], **before: Any) -> type[Table]:
    fields = dict(before)
    for law in laws:
        for parameter in parameters(law):
            usual = Field(default=None, title=_usual(parameter, laws))
            fields.setdefault(parameter, (_reader(parameter, laws) | None, usual))
    return create_model(name, __base__=Table, __doc__=words, **fields)


if TYPE_CHECKING:
    FrictionTable = Table
else:
    FrictionTable = _table(
        "FrictionTable",
        "The law of friction and its parameters; every law has only some of them.",
        LUBRICATED,
        law=(
            Annotated[str, Choice(*CHOICES["friction"])] | None,
            Field(default=None, title="as the bundle has it"),
        ),
    )


def _check(law: str, values: Mapping[str, object]) -> None:
    require_known(LAWS[law], values)


FRICTION = NameOrTable("law", *CHOICES["friction"], check=_check)
"""A law by its name, or a table with its parameters."""


Allowance = Annotated[
    tuple[float, ...],
    Several(Measure("length", "-10 mm", "10 mm", example="-0.08 mm"), least=1, most=2),
]


class TolerancesTable(Table):
    """Backlash out of the drawing: tooth-thickness allowances and centre-distance tolerance."""

    pinion_tooth_thickness: Allowance
    wheel_tooth_thickness: Allowance
    centre_distance: Allowance


class BacklashTable(Table):
    """The backlash, with its kind named: a value, or the tolerances it follows from."""

    value: Annotated[
        float | None,
        Measure(
            "length",
            "1e-5 mm",
            "50 mm",
            "a pair without backlash jams as soon as it warms up",
            example="0.25 mm",
        ),
    ] = Field(
        default=None,
        description="the least normal backlash that ISO/TR 10064-2 recommends, 2/3 (0.06 mm + "
        "0.0005 a + 0.03 m). The unit of length of the vibration; decides when the pair jams",
    )
    direction: Annotated[str | None, Choice("normal", "circumferential")] = None
    extent: Annotated[str | None, Choice("total", "half")] = None
    temperature: Body | None = Field(
        default=None,
        description="holds at temperatures.reference. Decides how much growth it has seen",
    )
    tolerances: TolerancesTable | None = None

    @model_validator(mode="after")
    def _complete(self) -> BacklashTable:
        not_both(self, "value", "tolerances")
        kinds = {"direction": '"normal" or "circumferential"', "extent": '"total" or "half"'}
        for name, allowed in kinds.items():
            given = getattr(self, name) is not None
            if self.value is not None and not given:
                raise InputError(
                    name,
                    "nothing",
                    allowed=allowed,
                    why="a backlash means nothing without its kind",
                    fix=f"write {name} = {allowed.split(' or ')[0]}",
                )
            if self.value is None and given:
                raise InputError(name, "a kind", why="tolerances need none", fix="leave it out")
        return self


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


PICTURES = ("path", "profile", "stiffness", "motion", "temperature", "base-sets")
BASE_SETS = ("table-4.2", "section-4.1")

Shape = Annotated[float, Number(low=bounds.RACK.low, high=bounds.RACK.high, example="1.25")]
Inertia = Annotated[float, Measure("moment of inertia", "1e-9 kg m^2", "1e6 kg m^2")]


class RackTable(Table):
    """The basic rack, lengths in modules."""

    addendum: Shape = Field(default=1.0, description="basic rack of ISO 53: addendum 1 module")
    dedendum: Shape = Field(default=1.25, description="basic rack of ISO 53: dedendum 1.25 modules")
    fillet_radius: Shape = Field(
        default=0.38, description="basic rack of ISO 53: fillet 0.38 module"
    )


class GearTable(Table):
    """One gear."""

    teeth: Annotated[int, Count(low=bounds.LEAST_TEETH, high=bounds.MOST_TEETH)]
    face_width: Length | None = Field(
        default=None,
        description="as [gears] or the other gear says. Stiffness, line load, "
        "inertia and heat flow scale with the narrower of both",
    )
    bore_radius: Length | None = Field(
        default=None,
        description="0.3 of the root circle, a usual share. Decides body stiffness "
        "and how far the annulus grows; the inertia changes by less than 1 %",
    )
    profile_shift: Annotated[
        float,
        Number(low=bounds.PROFILE_SHIFT.low, high=bounds.PROFILE_SHIFT.high, example="0.2"),
    ] = Field(
        default=0.0,
        description="no profile shift. Decides undercut, sliding and tip thickness",
    )
    tip_diameter: Annotated[
        float | None, Measure("length", "0.1 mm", "20000 mm", example="135 mm")
    ] = Field(
        default=None,
        description="pitch diameter + 2 (addendum + profile shift) modules. Decides the "
        "contact ratio",
    )
    tip_rounding: Annotated[float, measure("length", bounds.DEPTH, example="0.2 mm")] = Field(
        default=0.0,
        description="no rounding. Decides how far the path of contact is shortened and what a "
        "tip corner carries beyond it",
    )
    tip_chamfer: Annotated[float, measure("length", bounds.DEPTH, example="0.3 mm")] = Field(
        default=0.0, title="height of a chamfer of the tip in place of the rounding; none"
    )
    material: Annotated[str, Words('"steel"')] = Field(
        default="steel",
        description="case-hardening gear steel. Decides stiffness, expansion and "
        "what heat the teeth stand",
    )
    roughness: Annotated[float, measure("length", bounds.ROUGHNESS, example="0.4 um")] = Field(
        default=0.4e-6,
        description="Ra of ground flanks (0.3 to 0.5 um are usual). Decides the "
        "film, the friction and with it the flash temperature",
    )
    rack: RackTable | None = Field(default=None, title="of this gear alone; else [gears.rack]")
    tip_relief: ReliefTable | None = Field(default=None, title="no tip relief")
    root_relief: ReliefTable | None = Field(default=None, title="no root relief")
    pitch_errors: Annotated[
        tuple[float, ...] | None,
        Several(measure("length", bounds.PITCH_ERROR, example="3 um"), least=1, most=2000),
    ] = Field(default=None, title="one for each tooth, in the order in which they mesh; none")
    eccentricity: EccentricityTable | None = Field(default=None, title="none: centred on the bore")
    tooth_profiles: Annotated[tuple[ToothProfilesTable, ...], Field(max_length=20)] = Field(
        default=(), title="slope and form of every tooth; none"
    )
    teeth_differ: Annotated[tuple[ToothTable, ...], Field(max_length=bounds.MOST_TEETH)] = Field(
        default=(), title="single teeth beside all others; none"
    )
    pressure_angle_error: Annotated[
        float | None, measure("angle", bounds.ANGLE_ERROR, example="0.02 deg")
    ] = Field(default=None, title="none")
    profile: ProfileTable | None = Field(default=None, title="no table of added material")
    allow_undercut: StrictBool = Field(
        default=False, title="undercut that shortens the path of contact is refused unless true"
    )


Marks = Annotated[
    tuple[int, ...],
    Several(Count(low=1, high=bounds.MOST_TEETH, example="1"), least=2, most=2, single=False),
]


class GearsTable(Table):
    """What both gears share, and the two of them."""

    module: Annotated[float, Module("length", *bounds.MODULE.ends)]
    pressure_angle: Annotated[float, measure("angle", bounds.PRESSURE_ANGLE)] = Field(
        default=math.radians(20.0),
        description="20 deg, the basic rack of ISO 53. Decides contact ratio and undercut",
    )
    face_width: Length | None = Field(default=None, title="of both gears; or one for each below")
    centre_distance: Annotated[
        float | None, measure("length", bounds.CENTRE_DISTANCE, example="250 mm")
    ] = Field(default=None, title="left out: the mesh of the profile shifts without backlash")
    rack: RackTable | None = Field(
        default=None,
        description="basic rack of ISO 53, its fillet as round as fits. Decides how tall and how "
        "stiff the teeth are",
    )
    pitch_errors_are: Annotated[str, Choice("index", "single pitch")] = Field(
        default="index",
        title="index: where each tooth is, > 0 towards its drive flank; single pitch: how much "
        "farther than a pitch from the tooth before",
    )
    pitch_errors_along: Annotated[str, Choice("line of action", "arc")] = Field(
        default="line of action", title="line of action; arc of the reference circle"
    )
    marks: Marks | None = Field(
        default=None, title="teeth of pinion and wheel that meet at mesh phase 0; 1 and 1"
    )
    period: Annotated[str, Choice("turn", "mesh")] = Field(
        default="turn",
        title="turn: until all deviations come again; mesh: the mean tooth over one mesh period",
    )
    part: Annotated[str, Choice("case", "nominal")] = Field(
        default="case",
        title="case: flanks as given or drawn; nominal: as designed, with reliefs alone",
    )
    pinion: GearTable
    wheel: GearTable

    @model_validator(mode="after")
    def _marked(self) -> GearsTable:
        teeth = (self.pinion.teeth, self.wheel.teeth)
        for place, (mark, most) in enumerate(zip(self.marks or (), teeth, strict=False)):
            if mark > most:
                raise InputError(f"marks[{place}]", mark, allowed=f"1..{most}")
        return self

    @model_validator(mode="after")
    def _wide(self) -> GearsTable:
        of_each = (self.pinion.face_width, self.wheel.face_width)
        if self.face_width is None and of_each == (None, None):
            raise InputError(
                "face_width", "nothing", why="needed", fix='write face_width = "30 mm"'
            )
        if self.face_width is not None and None not in of_each:
            raise InputError("face_width", "one beside those of both gears", fix="leave one out")
        if self.rack is not None and None not in (self.pinion.rack, self.wheel.rack):
            raise InputError("rack", "one beside those of both gears", fix="leave one out")
        return self


class InertiaTable(Table):
    """Moments of inertia: given, or those of steel discs made of the gears."""

    model: Annotated[str, Choice("solid disc", "given")] = Field(
        default="solid disc",
        description="gears as discs, without shafts and what hangs on them. "
        "Decides the equivalent mass and so where the pair resonates",
    )
    radius: Annotated[str | None, Choice("pitch", "tip")] = Field(
        default=None, description="radius of the disc; pitch. Decides its inertia"
    )
    bored: StrictBool | None = Field(
        default=None,
        description="whether the bore is taken out; it is not. Decides less than 1 % of the "
        "inertia",
    )
    pinion: Inertia | None = Field(default=None, title="from the disc")
    wheel: Inertia | None = Field(default=None, title="from the disc")

    @model_validator(mode="after")
    def _complete(self) -> InertiaTable:
        numbers = (self.pinion, self.wheel)
        if self.model == "given":
            for name, value in zip(("pinion", "wheel"), numbers, strict=True):
                if value is None:
                    raise InputError(
                        name,
                        "nothing",
                        why='needed with model = "given"',
                        fix=f'write {name} = "0.01 kg m^2"',
                    )
            if self.radius is not None or self.bored is not None:
                raise InputError(
                    "",
                    'radius or bored beside model = "given"',
                    fix='leave them out, or write model = "solid disc"',
                )
        elif any(value is not None for value in numbers):
            raise InputError("", 'numbers beside model = "solid disc"', fix='write model = "given"')
        return self


class OperatingTable(Table):
    """The operating points: every speed with every torque."""

    speed: Annotated[
        tuple[float, ...],
        Several(
            Measure("rotational speed", "0.1 rpm", "500000 rpm", "a gear at rest has no motion")
        ),
    ]
    torque: Annotated[tuple[float, ...], Several(measure("torque", bounds.TORQUE))]


class TemperaturesTable(Table):
    """Body temperatures: given outright, so many kelvins below the addendum, or left out.

    With both addenda left out the heat balance computes what is not given; what is given outright
    then holds its node.
    """

    reference: Body = Field(
        default=ZERO_CELSIUS + 20.0,
        description="drawing temperature of ISO 1. Every thermal growth counts from it",
    )
    pinion_addendum: Body | None = Field(default=None, title="computed from the heat balance")
    wheel_addendum: Body | None = Field(default=None, title="computed from the heat balance")
    pinion_bore: Body | None = None
    pinion_bore_below_addendum: Below | None = None
    wheel_bore: Body | None = None
    wheel_bore_below_addendum: Below | None = None
    housing: Body | None = None
    housing_below_addendum: Below | None = None
    row: Annotated[
        tuple[float, ...],
        Several(BODY, least=0, most=1000, distinct=True),
    ] = Field(default=(), description="no row of gear temperatures")
    follow: Annotated[str, Choice(*FOLLOW)] = Field(
        default="proportional",
        description="where the gears' temperature is varied, every excess over the reference is "
        "scaled with the gears', as in a linear heat network. Decides rows of temperatures alone",
    )

    @property
    def computed(self) -> bool:
        """Whether the heat balance decides the temperatures."""
        return self.pinion_addendum is None and self.wheel_addendum is None

    @model_validator(mode="after")
    def _complete(self) -> TemperaturesTable:
        for name, other in (
            ("pinion_addendum", "wheel_addendum"),
            ("wheel_addendum", "pinion_addendum"),
        ):
            if getattr(self, name) is None and not self.computed:
                raise InputError(
                    name,
                    "nothing",
                    why=f"needed beside {other}",
                    fix=f'write {name} = "100 degC", or leave both out to have the heat balance '
                    "compute them",
                )
        for name in ("pinion_bore", "wheel_bore", "housing"):
            below = f"{name}_below_addendum"
            if not self.computed:
                one_of(self, name, below)
            elif getattr(self, below) is not None:
                raise _no_addendum(below)
        return self


def _no_addendum(field: str) -> InputError:
    return InputError(
        field,
        "a distance from an addendum temperature that is not given",
        why="with both addenda left out the heat balance computes the temperatures",
        fix="leave it out, or give both addenda",
    )


class DynamicsTable(Table):
    """What vibration needs besides the mesh."""

    damping_ratio: Annotated[float, Number(low=0.0, high=2.0, example="0.07")] = Field(
        default=0.07,
        description="usual for steel gears, where 0.03 to 0.17 are measured. "
        "Decides the height of resonances and which motions are periodic",
    )
    damping_ratio_least: Annotated[float, Number(low=0.0, high=2.0, example="0.02")] = Field(
        default=0.02,
        description="the other bound of a series: jumps at every load, as tests of a 50:50 pair "
        "report them, need less than 0.035 (recalled). Decides whether flanks part",
    )
    damping_ratio_most: Annotated[float, Number(low=0.0, high=2.0, example="0.07")] = Field(
        default=0.07,
        description="the bound of a series that is usual for steel gears. Decides its gentler end",
    )

    @property
    def dampings(self) -> tuple[float, ...]:
        """Damping ratios of a series: the usual one first, then the bounds, least first.

        Where it is one of the bounds, the geometric mean of both takes the place of that one. A
        given ratio without bounds is the only one.
        """
        ratio, bounds_of = self.damping_ratio, (self.damping_ratio_least, self.damping_ratio_most)
        stated = self.model_fields_set
        if bounds_of[0] == bounds_of[1] or (
            "damping_ratio" in stated and not {"damping_ratio_least", "damping_ratio_most"} & stated
        ):
            return (ratio,)
        between = math.sqrt(bounds_of[0] * bounds_of[1])
        others = [between if bound == ratio else bound for bound in bounds_of]
        return (ratio, *sorted(others))

    @model_validator(mode="after")
    def _within(self) -> DynamicsTable:
        ends = (self.damping_ratio_least, self.damping_ratio_most)
        if ends[0] > ends[1]:
            raise InputError(
                "damping_ratio_least",
                ends[0],
                allowed=f"up to {ends[1]:g}, damping_ratio_most",
                fix="state both",
            )
        if self.dampings != (self.damping_ratio,) and not ends[0] <= self.damping_ratio <= ends[1]:
            raise InputError(
                "damping_ratio",
                self.damping_ratio,
                allowed=f"{ends[0]:g}..{ends[1]:g}, as damping_ratio_least and _most say",
                fix="state all three, or the ratio alone",
            )
        return self


class HarmonicTable(Table):
    """One harmonic of the kinematic error: amplitude cos(2 pi order phi + phase)."""

    order: Annotated[int, Count(low=1, high=1000, example="1")]
    amplitude: Annotated[float, Measure("length", "0 um", "1000 um", example="5 um")]
    phase: Annotated[float, Measure("angle", "-360 deg", "360 deg")] = Field(
        default=0.0, description="in phase with the entry of a new tooth pair"
    )


class TransmissionErrorTable(Table):
    """The kinematic (unloaded) transmission error, a series over the mesh phase."""

    harmonics: Annotated[tuple[HarmonicTable, ...], Field(max_length=200)]

    @model_validator(mode="after")
    def _once(self) -> TransmissionErrorTable:
        orders = [h.order for h in self.harmonics]
        for order in orders:
            if orders.count(order) > 1:
                raise InputError("harmonics", f"order {order} twice", allowed="each order once")
        return self


OF_BUNDLE = "as the bundle has it"
"""Of a choice of the model that is left out."""


def _model_table() -> type[Table]:
    fields: dict[str, Any] = {
        "bundle": (
            Annotated[str, Choice("both", "consistent", "thesis")],
            Field(
                default="consistent",
                description="units, energy and limits close. Decides what the choices below are",
            ),
        ),
    }
    kinds: dict[str, Any] = {
        "friction": Annotated[FrictionTable | None, FRICTION],
        "dry_coefficient": Annotated[float | None, Number(low=0.001, high=1.0, example="0.2")],
    }
    for name, words in DECIDES.items():
        kind = kinds.get(name) or Annotated[str | None, Choice(*CHOICES[name])]
        fields[name] = (kind, Field(default=None, description=f"{OF_BUNDLE}. Decides {words}"))
    words = "The model: one bundle of choices or both, then single choices in place of theirs."
    return create_model("ModelTable", __base__=Table, __doc__=words, **fields)


if TYPE_CHECKING:
    ModelTable = Table
else:
    ModelTable = _model_table()  # its fields are the choices that the mesh model knows


class GridTable(Table):
    """How finely the path of contact and the mesh period are sampled."""

    path_positions: Annotated[int, Count(low=11, high=100_001, example="201")] = Field(
        default=201, description="positions along the path of contact, A to E"
    )
    mesh_positions: Annotated[int, Count(low=16, high=65536, example="240")] = Field(
        default=240, description="phases of the mesh period"
    )
    harmonics: Annotated[int, Count(low=1, high=2000, example="24")] = Field(
        default=24, description="harmonics of the stiffness kept for the motion"
    )

    @model_validator(mode="after")
    def _resolved(self) -> GridTable:
        most = (self.mesh_positions - 1) // 2
        if self.harmonics > most:
            raise InputError(
                "harmonics",
                self.harmonics,
                allowed=f"1..{most}",
                why=f"{self.mesh_positions} mesh positions resolve no more",
                fix=f"use {most}, or more mesh_positions",
            )
        return self


class DrawTable(Table):
    """What the report shows."""

    pictures: Annotated[
        tuple[str, ...], Several(Choice(*PICTURES), least=0, most=20, single=False, distinct=True)
    ] = Field(default=PICTURES, description="every picture")
    base_sets: Annotated[
        tuple[str, ...], Several(Choice(*BASE_SETS), least=0, most=2, single=False, distinct=True)
    ] = Field(default=(), description="none; the thesis's, beside the numbers of its rig")


class GearFile(Table):
    """A gear pair from friction to vibration."""

    title: Annotated[str, Words('"my gear pair"')] = Field(
        default="", title="left out: teeth and module"
    )
    kind: Annotated[str, Choice("gear", "dimensionless")] = "gear"
    gears: GearsTable
    materials: dict[str, MaterialTable] = Field(
        default={}, description="no materials of the user's own"
    )
    housing: HousingTable = HousingTable()
    oil: OilTable = OilTable()
    inertia: InertiaTable = InertiaTable()
    operating: OperatingTable
    temperatures: TemperaturesTable = TemperaturesTable()
    gearbox: GearboxTable | None = Field(default=None, title="every value ours")
    sensors: SensorsTable | None = Field(default=None, title="every thermometer ours")
    shafts: tuple[ShaftTable, ...] = Field(default=(), title="left out: the gear pair alone")
    bearings: tuple[BearingTable, ...] = Field(default=(), title="besides those at shafts' ends")
    discs: tuple[DiscTable, ...] = Field(default=(), title="none")
    motor: MotorTable | None = Field(default=None, title="its torque alone")
    load: EndTable | None = Field(default=None, title="its torque alone")
    train: TrainTable | None = Field(default=None, title="every value ours")
    backlash: BacklashTable = BacklashTable()
    dynamics: DynamicsTable = DynamicsTable()
    flanks: FlanksTable | None = Field(default=None, title="left out: an accuracy class")
    faults: Annotated[tuple[FaultTable, ...], Field(max_length=MOST_FAULTS)] = Field(
        default=(), title="cracked, broken, worn or misplaced teeth; none"
    )
    transmission_error: TransmissionErrorTable | None = Field(
        default=None, title="left out: that of the flanks alone"
    )
    model: ModelTable = ModelTable()
    grid: GridTable = GridTable()
    simulation: SimulationTable = SimulationTable()
    draw: DrawTable = DrawTable()
    files: dict[str, EnclosedTable] = Field(
        default={}, title="put here when the case is read", exclude=True
    )
    ours: dict[str, Any] = Field(default={}, description="no value is declared as ours")

    @model_validator(mode="before")
    @classmethod
    def _surrounded(cls, data: Any) -> Any:
        """What is left out as a whole and acts: the defaults of its table are assumptions then.

        Computed temperatures rest on the gearbox, an error that is not given on the flanks.
        """
        if not isinstance(data, dict):
            return data
        given = data.get("temperatures", {})
        if isinstance(given, dict) and not {"pinion_addendum", "wheel_addendum"} & set(given):
            data = {"gearbox": {}, **data}
        if "transmission_error" not in data:
            data = {"flanks": {}, **data}
        if data.get("shafts"):
            data = at_the_ends({"train": {}, **data})
        for name, most in (
            ("bearings", MOST_BEARINGS), ("discs", MOST_DISCS), ("faults", MOST_FAULTS),
        ):  # fmt: skip
            require_few(data.get(name), name, most)
        return data

    @model_validator(mode="after")
    def _one_eccentricity(self) -> GearFile:
        for place, one in enumerate(self.shafts):
            if one.eccentricity and getattr(self.gears, one.gear).eccentricity is not None:
                raise InputError(
                    f"shafts[{place}].eccentricity",
                    f"one beside [gears.{one.gear}.eccentricity]",
                    why="both say where the teeth stand to the axis",
                    fix="leave one out",
                )
        return self

    @model_validator(mode="after")
    def _oil_follows(self) -> GearFile:
        if not self.temperatures.computed:
            one_of(self.oil, "temperature", "temperature_below_addendum", "oil")
        elif self.oil.temperature_below_addendum is not None:
            raise _no_addendum("oil.temperature_below_addendum")
        return self


def json_schema() -> dict[str, Any]:
    """The JSON schema (2020-12) of a case file, either kind; what a form needs under ``x-`` keys.

    The keys are those of :mod:`thermogear.case.described`.
    """
    _, schema = models_json_schema(
        [(GearFile, "validation"), (DimensionlessFile, "validation")], title="thermogear case file"
    )
    for table in schema["$defs"].values():
        for entry in table["properties"].values():
            # a default is an SI number or nothing; neither could be written in a file as it is
            given = entry.get("default")
            if (
                given is None
                or "$ref" in entry
                or (entry.get("type") == "string" and not isinstance(given, str))
            ):
                entry.pop("default", None)
    kinds = {"GearFile": "gear", "DimensionlessFile": "dimensionless"}
    for name, kind in kinds.items():
        schema["$defs"][name]["properties"]["kind"] |= {"enum": [kind], "x-choices": [kind]}
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **schema,
        "anyOf": [{"$ref": f"#/$defs/{name}"} for name in kinds],
    }
