"""Drive trains that the thesis's rig could have been: what is assumed of them, with ranges.

The document states the gears, an induction motor, a magnetic powder brake and accelerometers. All
else is ours: every range is as wide as rigs of this kind are, and says where it comes from.
"""

from __future__ import annotations

from dataclasses import dataclass

SPEEDS = (1000.0, 2000.0, 3000.0)
"""Speeds of the pinion [rpm] in the document."""
DIGITS = 5
"""Significant digits of a sampled value, as stored: a stored row can be computed again."""


@dataclass(frozen=True, kw_only=True)
class Assumed:
    """One assumed quantity: its range in ``unit``, why, and where the range comes from.

    ``logarithmic``: all decades alike. ``choices``: names instead of numbers, low to high.
    """

    name: str
    words: str
    unit: str
    low: float
    high: float
    why: str
    logarithmic: bool = False
    choices: tuple[str, ...] = ()

    @property
    def span(self) -> str:
        """The range as a reader sees it."""
        if self.choices:
            return ", ".join(self.choices)
        return f"{self.low:g} to {self.high:g} {self.unit}".strip()


def _of(
    name: str,
    words: str,
    span: tuple[float, float],
    unit: str,
    why: str,
    logarithmic: bool = False,
) -> Assumed:
    return Assumed(
        name=name,
        words=words,
        unit=unit,
        low=span[0],
        high=span[1],
        why=why,
        logarithmic=logarithmic,
    )


AS_BEFORE = "as in the sensitivity study of the pair"
ASSUMED: tuple[Assumed, ...] = (
    _of("face_width", "face width", (15.0, 40.0), "mm", AS_BEFORE),
    _of("torque", "torque of the pinion", (50.0, 200.0), "N m",
        f"{AS_BEFORE}; 16 to 63 kW at 3000 rpm"),
    _of("backlash", "backlash, normal, total", (0.20, 0.40), "mm", AS_BEFORE),
    _of("damping", "damping ratio of the mesh", (0.03, 0.17), "", AS_BEFORE),
    _of("error", "transmission error, amplitude of the first order", (1.0, 20.0), "um",
        "twice the range of the pair's study: up to accuracy class 8"),
    _of("gears", "temperature of the gears", (100.0, 160.0), "degC", "the document's"),
    _of("shafts_below", "shafts and inner rings colder than the gears by", (0.0, 40.0), "K",
        AS_BEFORE),
    _of("housing_below", "housing and outer rings colder than the shafts by", (0.0, 20.0), "K",
        "5 to 10 K between the rings are usual, 15 to 20 K in fast bearings (makers)"),
    Assumed(name="pinion_bearing", words="bearings of the pinion's shaft", unit="", low=0.0,
            high=3.0, why="deep groove balls on 30 and 40 mm, for this power",
            choices=("6206", "6306", "6208", "6308")),
    Assumed(name="wheel_bearing", words="bearings of the wheel's shaft", unit="", low=0.0,
            high=1.0, why="three times the torque: 40 mm", choices=("6208", "6308")),
    _of("thickness", "shaft between the bearings over the bearing's bore", (1.1, 1.5), "",
        "a shoulder for the bearing, and no thicker than the gear's bore"),
    _of("span", "distance of a shaft's bearings", (100.0, 250.0), "mm",
        "face width, walls, and room for the wheel of 385 mm"),
    _of("place", "gear's place between its bearings, as a share", (0.35, 0.65), "",
        "near the middle; 0.5 is the middle"),
    _of("play", "play of the bearings as delivered", (6.0, 33.0), "um",
        "classes CN and C3 of 30 to 40 mm bore (ISO 5753-1)"),
    _of("bearing_damping", "damping of a bearing", (150.0, 1000.0), "N s/m",
        "150 to 350 measured of small ball bearings; 2 to 5 µs times their stiffness of larger",
        True),
    _of("seat_stiffness", "stiffness of a bearing's seat in the wall", (100.0, 500.0), "N/um",
        "recalled for housings; 100 a thin wall", True),
    _of("seat_mass", "mass that moves with the seat: ring, cap, wall", (0.5, 5.0), "kg",
        "ring and cap alone to a piece of the wall", True),
    _of("seat_loss", "damping of the seat over its stiffness", (1.0, 10.0), "µs",
        "0.3 to 3 % at 1 kHz: bolted steel and cast iron", True),
    _of("housing_mass", "mass of the housing", (30.0, 150.0), "kg",
        "40 kg in the ready-made case rig; a base plate may add to it", True),
    _of("mount_stiffness", "stiffness of the housing's feet", (5.0, 500.0), "N/um",
        "rubber to bolts on a bed", True),
    _of("mount_damping", "damping ratio of the housing on its feet", (0.01, 0.10), "",
        "bolted steel to rubber", True),
    _of("centre_line", "line of centres from the level", (0.0, 90.0), "deg",
        "wheel beside or above the pinion"),
    _of("motor_inertia", "inertia of the motor", (0.02, 0.15), "kg m^2",
        "four poles, 7.5 to 22 kW", True),
    _of("brake_inertia", "inertia of the powder brake", (0.05, 0.50), "kg m^2",
        "rotors of 200 to 1000 N m brakes, a guess", True),
    _of("coupling", "stiffness of the couplings", (500.0, 20000.0), "N m/rad",
        "5 (rubber tyre) to 150 (jaw) times the torque", True),
)  # fmt: skip

FIXED = (
    "Fixed: tooth numbers, module and pressure angle of the document; no profile shift; mineral "
    "oil 40 K colder than the gears; gears as solid discs; steel; an induction motor whose torque "
    "falls by 33 N m per rad/s behind 20 ms; couplings that lose 0.5 ms times their stiffness; a "
    "brake of constant torque; shafts balanced and gears centred: their errors give lines at shaft "
    "order beside the mesh line."
)
