"""Tables of the case file that say which shafts carry the gears, in which bearings, driven how."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import Field, StrictBool, model_validator

from thermogear.base.errors import InputError
from thermogear.case.fields import Choice, Count, Measure, Number, Several, Words
from thermogear.case.table import Body, Table, not_both

MOST_SECTIONS, MOST_BEARINGS, MOST_DISCS = 200, 20, 50

Size = Annotated[float, Measure("length", "0.1 mm", "20000 mm", example="30 mm")]
Hole = Annotated[float, Measure("length", "0 mm", "20000 mm", example="10 mm")]
Place = Annotated[float, Measure("length", "0 mm", "20000 mm", example="15 mm")]
Spring = Measure("stiffness", "1 N/m", "1e13 N/m", example="200 N/um")
Springs = Annotated[tuple[float, ...], Several(Spring, least=1, most=2)]
Damper = Annotated[float, Measure("damping", "0 N s/m", "1e8 N s/m", example="500 N s/m")]
Mass = Annotated[float, Measure("mass", "1e-6 kg", "1e6 kg", example="2 kg")]
Inertia = Annotated[
    float, Measure("moment of inertia", "1e-12 kg m^2", "1e6 kg m^2", example="0.01 kg m^2")
]
Angle = Annotated[float, Measure("angle", "-360 deg", "360 deg", example="90 deg")]
Interference = Annotated[float, Measure("length", "-0.5 mm", "0.5 mm", example="11 um")]
Which = Annotated[str, Choice("pinion", "wheel")]
STEEL = Field(default="steel", description="steel. Decides stiffness, mass and growth")


class SectionTable(Table):
    """A piece of a shaft of one diameter."""

    length: Size
    diameter: Size
    inner_diameter: Hole = Field(default=0.0, title="solid")
    material: Annotated[str, Words('"steel"')] | None = Field(default=None, title="as the shaft's")


class ShaftTable(Table):
    """The shaft of one gear, from its left end on."""

    gear: Which
    sections: tuple[SectionTable, ...] = Field(default=(), title="or length and diameter of one")
    length: Size | None = Field(default=None, title="of a shaft of one diameter")
    diameter: Size | None = Field(default=None, title="of a shaft of one diameter")
    inner_diameter: Hole | None = Field(default=None, title="of a shaft of one diameter; solid")
    material: Annotated[str, Words('"steel"')] = STEEL
    gear_position: Place | None = Field(
        default=None,
        description="in the middle. From the left end to the middle of the face; decides how the "
        "bearings share the load",
    )
    bearings: Annotated[
        tuple[str, ...] | None, Several(Words('"6205"'), least=1, most=2, distinct=False)
    ] = Field(default=None, title="types of one at each end, half their width inside")
    unbalance: Annotated[float, Measure("unbalance", "0 g mm", "1e6 g mm", example="20 g mm")] = (
        Field(default=0.0, description="balanced. Decides the vibration at shaft order")
    )
    unbalance_angle: Angle = Field(default=0.0, title="on the x axis")
    eccentricity: Annotated[float, Measure("length", "0 um", "5000 um", example="10 um")] = Field(
        default=0.0,
        description="teeth centred on the shaft. Decides the transmission error at shaft order",
    )
    eccentricity_angle: Angle = Field(default=0.0, title="on the x axis")

    @model_validator(mode="before")
    @classmethod
    def _few(cls, data: Any) -> Any:
        """Refuse an endless list before each of its entries is read."""
        if isinstance(data, dict):
            require_few(data.get("sections"), "sections", MOST_SECTIONS)
        return data

    @model_validator(mode="after")
    def _shaped(self) -> ShaftTable:
        uniform = (self.length, self.diameter, self.inner_diameter)
        if self.sections and any(one is not None for one in uniform):
            raise InputError("", "sections beside a length or diameter", fix="leave one out")
        if not self.sections and None in (self.length, self.diameter):
            missing = "length" if self.length is None else "diameter"
            raise InputError(
                missing,
                "nothing",
                why="a shaft needs sections, or length and diameter of one",
                fix='write sections = [{ length = "120 mm", diameter = "30 mm" }]',
            )
        for number, one in enumerate(self.pieces):
            if one.inner_diameter >= one.diameter:
                at = f"sections[{number}].inner_diameter" if self.sections else "inner_diameter"
                raise InputError(
                    at,
                    f"{1e3 * one.inner_diameter:.6g} mm",
                    allowed=f"< {1e3 * one.diameter:.6g} mm, the outer diameter",
                )
        return self

    @property
    def pieces(self) -> tuple[SectionTable, ...]:
        """The sections, also of a shaft of one diameter."""
        if self.sections or self.length is None or self.diameter is None:
            return self.sections
        return (
            SectionTable.model_construct(
                length=self.length,
                diameter=self.diameter,
                inner_diameter=self.inner_diameter or 0.0,
                material=None,
            ),
        )


class RingTable(Table):
    """A round clearance and a power law through one known point: F = F1 (delta/delta1)^n."""

    load: Annotated[float, Measure("force", "0.001 N", "1e9 N", example="1000 N")]
    deflection: Annotated[float, Measure("length", "0.001 um", "10000 um", example="15 um")]
    exponent: Annotated[float, Number(low=1.0, high=2.0, example="1.5")] = Field(
        default=1.0, title="linear; 1.5 of balls, 1.11 of rollers"
    )
    play: Annotated[float, Measure("length", "0 um", "5000 um", example="16 um")] = Field(
        default=0.0, title="no clearance; the whole way from side to side"
    )


class InsideTable(Table):
    """The inside of a rolling bearing that no catalogue name says."""

    kind: Annotated[str, Choice("ball", "roller")] = Field(
        default="ball", title="deep groove balls"
    )
    bore: Size
    outside_diameter: Size
    width: Size
    elements: Annotated[int, Count(low=3, high=200, example="9")]
    element_diameter: Size
    pitch_diameter: Size
    element_length: Size | None = Field(default=None, title="of rollers")
    contact_angle: Annotated[float, Measure("angle", "0 deg", "60 deg", example="0 deg")] = Field(
        default=0.0, title="radial contact"
    )
    dynamic_rating: Annotated[float, Measure("force", "1 N", "1e9 N", example="14.8 kN")] | None = (
        Field(default=None, title="unknown: no life")
    )
    static_rating: Annotated[float, Measure("force", "1 N", "1e9 N", example="7.8 kN")] | None = (
        Field(default=None, title="unknown: no static safety")
    )


class BearingTable(Table):
    """A bearing of one shaft: by type, by its inside, as a ring, or by its stiffness."""

    shaft: Which
    position: Place | None = Field(default=None, title="from the shaft's left end; or end")
    end: Annotated[str, Choice("left", "right")] | None = Field(
        default=None, title="half its width inside that end of the shaft"
    )
    name: Annotated[str, Words('"motor side"')] | None = Field(
        default=None, title="shaft and number from the left"
    )
    type: Annotated[str, Words('"6205"')] | None = Field(default=None, title="of the catalogue")
    inside: InsideTable | None = Field(default=None, title="of a bearing in no catalogue")
    ring: RingTable | None = Field(default=None, title="clearance and power law")
    stiffness: Springs | None = Field(default=None, title="linear; along x and y")
    cross_stiffness: (
        Annotated[float, Measure("stiffness", "-1e13 N/m", "1e13 N/m", example="10 N/um")] | None
    ) = Field(default=None, title="between x and y; none")
    play: Annotated[float, Measure("length", "-500 um", "5000 um", example="12 um")] | None = Field(
        default=None,
        description="the middle of its class. As delivered, the whole way from side to side; below "
        "zero a preload. Decides load zone, stiffness and rattle",
    )
    clearance_class: Annotated[str, Choice("C2", "CN", "C3", "C4")] | None = Field(
        default=None, description="CN, the normal one of ISO 5753-1. Decides the play"
    )
    shaft_interference: Interference = Field(
        default=11e-6,
        description="11 um, the middle of k5 on 18 to 50 mm. On the diameter. Decides how much "
        "clearance mounting takes",
    )
    housing_interference: Interference = Field(
        default=0.0,
        description="none, the ring can slide. On the diameter. Decides how much clearance "
        "mounting takes",
    )
    damping: Damper | None = Field(
        default=None,
        description="3e-6 s times its stiffness under half the mesh force (2 to 5e-6 s are "
        "measured). Decides how high resonances of the shafts rise",
    )
    seat_stiffness: Springs | None = Field(default=None, title="rigid in the housing; x and y")
    seat_mass: Mass | None = Field(default=None, title="the outer ring's")
    seat_damping: Damper | None = Field(default=None, title="3e-6 s times the seat's stiffness")
    seat_conductance: Annotated[
        float, Measure("thermal conductance", "0.01 W/K", "10000 W/K", example="10 W/K")
    ] = Field(
        default=10.0, description="10 W/K from the ring into the housing. Decides how warm it runs"
    )
    lubrication: Annotated[str, Choice("bath", "grease", "jet")] = Field(
        default="bath", description="oil bath. Decides the friction"
    )
    friction: Annotated[str, Choice("skf", "palmgren")] | None = Field(
        default=None,
        description="skf of deep groove balls by name, palmgren of others. Decides the heat",
    )
    inner_temperature: Body | None = Field(default=None, title="computed, or the shaft's")
    outer_temperature: Body | None = Field(default=None, title="computed, or the housing's")

    @model_validator(mode="after")
    def _one_kind(self) -> BearingTable:
        if (self.position is None) == (self.end is None):
            raise InputError(
                "position",
                "nothing" if self.end is None else "one beside end",
                allowed="either position or end",
                fix='write position = "15 mm", from the shaft\'s left end',
            )
        kinds = ("type", "inside", "ring", "stiffness")
        given = [name for name in kinds if getattr(self, name) is not None]
        if len(given) != 1:
            raise InputError(
                "",
                " and ".join(given) if given else "neither type nor stiffness",
                allowed="exactly one of " + " | ".join(kinds),
                fix='write type = "6205", or leave the others out',
            )
        not_both(self, "play", "clearance_class")
        if given[0] in ("ring", "stiffness"):
            for name in ("play", "clearance_class"):
                if getattr(self, name) is not None:
                    raise InputError(
                        name,
                        f"a clearance beside {given[0]}",
                        allowed="with type or inside",
                        fix="write it in ring" if given[0] == "ring" else "leave it out",
                    )
        if self.cross_stiffness is not None and self.stiffness is None:
            raise InputError("cross_stiffness", "one without stiffness", fix="leave it out")
        return self


class DiscTable(Table):
    """A rigid disc on a shaft: by mass and inertias, or by its size."""

    shaft: Which
    position: Place
    name: Annotated[str, Words('"flange"')] = Field(default="disc", title="in pictures")
    mass: Mass | None = None
    polar_inertia: Inertia | None = None
    diametral_inertia: Inertia | None = None
    outer_diameter: Size | None = None
    inner_diameter: Hole = Field(default=0.0, title="to the axis")
    width: Size | None = None
    material: Annotated[str, Words('"steel"')] = STEEL

    @model_validator(mode="after")
    def _whole(self) -> DiscTable:
        heavy = (self.mass, self.polar_inertia, self.diametral_inertia)
        sized = (self.outer_diameter, self.width)
        if (None in heavy) == (None in sized) or (
            any(h is not None for h in heavy) and any(s is not None for s in sized)
        ):
            raise InputError(
                "",
                "a disc of no one kind",
                allowed="mass, polar_inertia and diametral_inertia, or outer_diameter and width",
                fix='write outer_diameter = "80 mm" and width = "10 mm"',
            )
        if self.outer_diameter is not None and self.inner_diameter >= self.outer_diameter:
            raise InputError(
                "inner_diameter",
                f"{1e3 * self.inner_diameter:.6g} mm",
                allowed=f"< {1e3 * self.outer_diameter:.6g} mm, the outer diameter",
            )
        return self


class EndTable(Table):
    """What drives or is driven, on a coupling."""

    inertia: Inertia
    coupling_stiffness: Annotated[
        float, Measure("torsional stiffness", "0.001 N m/rad", "1e12 N m/rad")
    ]
    coupling_damping: Annotated[
        float, Measure("torsional damping", "0 N m s/rad", "1e9 N m s/rad")
    ] = Field(default=0.0, description="none. Decides how long slow torsion rings")
    position: Place | None = Field(
        default=None,
        description="the left end of the pinion's shaft, the right of the wheel's. Decides where "
        "the shaft twists",
    )


class PlateTable(Table):
    """The plate of an induction motor: near its rated speed it is a damper behind a lag."""

    rated_torque: Annotated[float, Measure("torque", "0.001 N m", "1e7 N m", example="49 N m")]
    rated_speed: Annotated[
        float, Measure("rotational speed", "1 rpm", "100000 rpm", example="1454 rpm")
    ]
    pole_pairs: Annotated[int, Count(low=1, high=50, example="2")]
    overload: Annotated[float, Number(low=1.01, high=10.0, example="2.3")] = Field(
        default=2.5,
        description="at most 2.5 times the rated torque; 2.3 to 3.2 are usual. Decides the lag",
    )
    line_frequency: Annotated[float, Number(low=1.0, high=1000.0, example="50.0")] = Field(
        default=50.0, description="50 Hz mains. Decides the synchronous speed"
    )


class MotorTable(EndTable):
    """The motor on the pinion's shaft; without a characteristic its torque is constant."""

    slip_damping: Annotated[float, Measure("torsional damping", "0 N m s/rad", "1e9 N m s/rad")] = (
        Field(default=0.0, description="constant torque. Decides how the torque falls with speed")
    )
    lag: Annotated[float, Measure("time", "0 s", "100 s", example="0.021 s")] = Field(
        default=0.0,
        description="none: the torque follows at once. Decides how slow torsion is damped",
    )
    plate: PlateTable | None = Field(default=None, title="slip_damping and lag as they are given")

    @model_validator(mode="after")
    def _once(self) -> MotorTable:
        if self.plate is not None and (self.slip_damping or self.lag):
            raise InputError(
                "plate",
                "one beside slip_damping or lag",
                allowed="one of the two",
                fix="leave slip_damping and lag out: they follow from the plate",
            )
        return self


class TrainTable(Table):
    """Place, sense and damping of the drive train."""

    centre_line: Angle = Field(
        default=0.0,
        description="wheel beside pinion, along x. From the x axis, level, to the line of centres",
    )
    sense: Annotated[str, Choice("counter-clockwise", "clockwise")] = Field(
        default="counter-clockwise", description="of the pinion, seen against z. Mirrors the loads"
    )
    gravity: StrictBool = Field(default=True, description="weight acts along -y")
    damping: Annotated[str, Choice("bearings", "proportional", "modal")] = Field(
        default="bearings",
        description="bearings, seats, couplings and teeth, and a little in the shafts. Decides the "
        "height of resonances",
    )
    shaft_damping: Annotated[float, Measure("time", "0 s", "1 s", example="2e-6 s")] = Field(
        default=2e-6, description="2e-6 s times the stiffness: 0.6 % at 1 kHz"
    )
    mass_damping: Annotated[float, Number(low=0.0, high=1e6, example="5.0")] = Field(
        default=0.0, description="none. Times the mass, in 1/s; of damping = proportional"
    )
    modal_ratio: Annotated[float, Number(low=0.0, high=1.0, example="0.01")] = Field(
        default=0.01, description="1 % of every mode; of damping = modal"
    )
    cages: Annotated[str, Choice("standing", "turning")] = Field(
        default="standing",
        description="where they were drawn, so that motions come again after whole mesh periods; "
        "`run` compares three places. Turning: at (1 - D_w cos a/d_m)/2 of their shaft's speed",
    )
    cage_slip: Annotated[float, Number(low=0.0, high=0.5, example="0.01")] = Field(
        default=0.0, description="elements roll. By how much of it turning cages are slower"
    )
    elements: Annotated[int, Count(low=2, high=100, example="12")] = Field(
        default=12, description="beam elements of a shaft at least; frequencies err by h^2"
    )


def require_few(raw: object, field: str, most: int) -> None:
    """Refuse a list that is too long, before anything in it is read."""
    if isinstance(raw, list) and len(raw) > most:
        raise InputError(
            field,
            f"{len(raw)} entries",
            allowed=f"1..{most}",
            fix="leave some out" if field == "faults" else "join pieces of nearly one size",
        )
