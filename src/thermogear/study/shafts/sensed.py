"""What an accelerometer on a drive train shows, by its place and direction.

On a bearing's cap it moves with the outer ring's seat: with the seat's own mass where the bearing
has a seat that gives, else with the housing. It shows that point's acceleration in the fixed frame
along its axis, a(t) = a_x cos w + a_y sin w with w from the x axis: not the journal's, which also
moves in the clearance and on the rolling elements, and not the teeth's against each other.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError, nearest
from thermogear.dynamics.ladder import Engine, Steps
from thermogear.shafts.assembly import Assembly
from thermogear.shafts.train import SHAFTS
from thermogear.study.shafts.moving import MovingTrain
from thermogear.study.shafts.record import PERIODS, SAMPLES

KINDS = ("bearing", "housing", "journal", "gear")
FORM = (
    "CHANNEL=PLACE:DIRECTION, as a1=bearing:pinion left:x, a2=housing:y, a3=bearing:pinion left:30"
)
DIRECTIONS = {"x": 0.0, "y": 0.5 * math.pi}


@dataclass(frozen=True, kw_only=True)
class Accelerometer:
    """An accelerometer of one ``channel`` of a record.

    ``kind``: "bearing", on the cap of the bearing ``name``; "housing"; "journal", the shaft in that
    bearing; "gear", the centre of the gear ``name`` ("pinion" or "wheel"). ``direction`` [rad] of
    its axis from the x axis.
    """

    channel: str
    kind: str
    name: str = ""
    direction: float = 0.0

    @property
    def words(self) -> str:
        """Place and direction as a reader sees them: "bearing pinion left, x"."""
        for letter, angle in DIRECTIONS.items():
            if self.direction == angle:
                return f"{self.place}, {letter}"
        return f"{self.place}, {math.degrees(self.direction):g} deg from x"

    @property
    def place(self) -> str:
        """Its place in words: "bearing pinion left"."""
        return f"{self.kind} {self.name}".strip()

    def vector(self, assembly: Assembly) -> Floats:
        """Its displacement over the coordinates of the train, (n,): q times it [m].

        Raises InputError where nothing lets its place move: it would show zero.
        """
        both = self._place(assembly)
        if not np.any(both):
            raise InputError(
                f"--at {self.channel}",
                self.words,
                why="nothing moves there: outer rings and housing are fixed, it would show zero",
                fix="give housing.mass and housing.mount_stiffness, or the bearing's "
                "seat_stiffness and seat_mass",
            )
        return np.asarray(both @ [math.cos(self.direction), math.sin(self.direction)])

    def _place(self, assembly: Assembly) -> Floats:
        """Displacement of the place along x and y over the coordinates, (n, 2)."""
        if self.kind == "gear":
            return np.asarray(assembly.at_gear(self.name)[:, :2])
        if self.kind == "housing":
            found = np.zeros((assembly.size, 2))
            for axis, name in enumerate(("casing.x", "casing.y")):
                if name in assembly.index:
                    found[assembly.index[name], axis] = 1.0
            return found
        (place,) = (one for one in assembly.bearings if one.bearing.name == self.name)
        return place.ring if self.kind == "bearing" else place.journal


def accelerometer(text: str, *, bearings: Sequence[str], channels: Sequence[str]) -> Accelerometer:
    """The accelerometer that ``text`` describes, CHANNEL=PLACE:DIRECTION.

    PLACE: ``bearing:NAME``, ``housing``, ``journal:NAME`` or ``gear:pinion``; DIRECTION: x, y or an
    angle in degrees from x. ``bearings`` of the case, ``channels`` of the record. Raises InputError
    with the nearest name.

    >>> one = accelerometer("a1=bearing:motor side:y", bearings=["motor side"], channels=["a1"])
    >>> one.words
    'bearing motor side, y'
    """
    channel, sign, rest = text.partition("=")
    channel, parts = channel.strip(), [part.strip() for part in rest.split(":")]
    kind = parts[0].lower()
    if not sign or len(parts) < 2:
        raise InputError("--at", repr(text), allowed=FORM)
    if channel not in channels:
        raise InputError(
            "--at", f"channel {channel!r}", allowed=" | ".join(channels),
            fix=nearest(channel, list(channels)),
        )  # fmt: skip
    if kind not in KINDS:
        raise InputError(
            "--at", f"place {parts[0]!r}", allowed=" | ".join(KINDS), fix=nearest(kind, KINDS)
        )
    if len(parts) < (2 if kind == "housing" else 3):
        raise InputError("--at", repr(text), allowed=FORM, why=f"{kind} lacks name or direction")
    name = ":".join(parts[1:-1])
    known = {"housing": [""], "gear": list(SHAFTS)}.get(kind, list(bearings))
    if name not in known:
        raise InputError(
            "--at", f"{kind} {name!r}", allowed=" | ".join(known) or "no name",
            fix=nearest(name, known),
        )  # fmt: skip
    return Accelerometer(channel=channel, kind=kind, name=name, direction=_direction(parts[-1]))


def _direction(text: str) -> float:
    if text in DIRECTIONS:
        return DIRECTIONS[text]
    try:
        degrees = float(text.lower().removesuffix("deg").removesuffix("°").strip())
    except ValueError:
        degrees = math.nan
    if not abs(degrees) <= 360.0:
        raise InputError(
            "--at", f"direction {text!r}", allowed="x | y | -360..360, degrees from x",
            fix="write x, y or an angle as 45",
        )  # fmt: skip
    return math.radians(degrees)


def sensed(
    train: MovingTrain,
    state: Floats,
    *,
    vectors: Floats,
    periods: int = PERIODS,
    how: Steps | None = None,
    turn: float = 0.0,
) -> Floats:
    """Acceleration (sample, count) [m/s^2] along ``vectors`` (n, count) from ``state`` (d,) on.

    ``periods`` mesh periods at uniform phases, 64 samples each, ``turn`` of them
    after the start; ``how`` finely the engine goes.
    """
    run = Engine(train.model, how).run(state, periods, samples=SAMPLES, turn=turn)
    found = train.model.forces(turn + run.sample_phase, states=run.samples)
    return np.asarray(found["acceleration"] @ train.reduction.vector(vectors))
