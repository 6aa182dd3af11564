"""Both gears in mesh as a drawing: placed outlines, contact points and gaps in millimetres.

Made from a stored group ``drawing`` alone. :meth:`GearDrawing.to_json` is all that a page needs to
draw and turn the gears (``page/gears.js``); pictures and DXF files take the same numbers.
"""

from __future__ import annotations

import cmath
import json
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from thermogear.base.arrays import Dataset, Floats
from thermogear.base.display import MILLIMETRE, SPEED, exactly

Points = NDArray[np.complex128]

NEEDS = ("outline_radius", "outline_angle", "tight_radius", "lag", "load_share", "back_gap")
PINION, WHEEL = 0, 1
MM = 1e3
_GAP, _CLOSER, _MOVED = 0.35, 0.15, 0.5
"""Most of a module that an enlarged gap, a change of tip clearance and a growth may be."""


@dataclass(frozen=True, eq=False, kw_only=True)
class DrawnState:
    """Both gears in one state of heat, mm; arrays over (phase) and (phase, pair).

    ``outlines``: one pitch of pinion and wheel; ``lag`` of the wheel along the line of action.
    """

    name: str
    outlines: tuple[Points, Points]
    centre_distance: float
    set_back: float
    lag: Floats
    share: Floats
    drive_gap: Floats
    back_gap: Floats


@dataclass(frozen=True, eq=False, kw_only=True)
class GearDrawing:
    """Pinion and wheel in mesh over a mesh period, cold and in another state of heat, mm and rad.

    The pinion's centre is the origin, the wheel's at (``centre_distance``, 0). ``tight``: outlines
    without backlash, ``start``: where their teeth stand at phase 0, ``circles``: radii by name of
    each gear, ``contact``: places of contact as complex numbers over (phase, pair), ``path``: the
    points A..E. ``factor``: how many times gaps, growth and deviations are enlarged.
    """

    words: str
    module: float
    teeth: tuple[int, int]
    start: tuple[float, float]
    circles: tuple[Mapping[str, float], Mapping[str, float]]
    tight: tuple[Points, Points]
    states: tuple[DrawnState, ...]
    phase: Floats
    contact: Points
    centre_distance: float
    pressure_angle: float
    path: Mapping[str, complex]
    factor: float

    @property
    def pitch_point(self) -> float:
        """Where the operating pitch circles touch, on the line of centres [mm]."""
        return self.centre_distance / (1.0 + self.teeth[WHEEL] / self.teeth[PINION])

    @cached_property
    def line_of_action(self) -> tuple[complex, complex]:
        """Its tangent points on both base circles."""
        turn = cmath.exp(-1j * self.pressure_angle)
        base = [circle["base"] for circle in self.circles]
        return base[PINION] * turn, self.centre_distance - base[WHEEL] * turn

    def state(self, name: str) -> DrawnState:
        """The state called so, else the last."""
        return next((one for one in self.states if one.name == name), self.states[-1])

    def nearest(self, phase: float) -> int:
        """Place of the drawn phase that is nearest, the period closing on itself."""
        return int(np.argmin(np.abs((self.phase - phase + 0.5) % 1.0 - 0.5)))

    # --- placing ----------------------------------------------------------------------------
    def centre(self, state: DrawnState, gear: int, *, factor: float | None = None) -> float:
        """Where a gear's centre is on the line of centres."""
        much = self.factor if factor is None else factor
        if gear == PINION:
            return 0.0
        return self.centre_distance + much * (state.centre_distance - self.centre_distance)

    def axis(
        self, state: DrawnState, gear: int, *, phase: int, factor: float | None = None
    ) -> float:
        """Angle of the axis of tooth 0 at a drawn phase [rad]."""
        much = self.factor if factor is None else factor
        behind = 0.0 if gear == PINION else float(state.lag[phase])
        moved = much * (state.set_back + behind) / self.circles[gear]["base"]
        turn = 2.0 * math.pi * float(self.phase[phase]) / self.teeth[gear]
        return self.start[gear] + moved + (turn if gear == PINION else -turn)

    def shape(self, state: DrawnState, gear: int, *, factor: float | None = None) -> Points:
        """The outline of one pitch in the frame of its tooth."""
        much = self.factor if factor is None else factor
        tight = self.tight[gear]
        return np.asarray(tight + much * (state.outlines[gear] - tight))

    def tooth(
        self,
        state: DrawnState,
        gear: int,
        *,
        phase: int,
        number: int,
        factor: float | None = None,
    ) -> Points:
        """The outline of tooth ``number`` in its place; teeth count the way the gear turns back."""
        step = 2.0 * math.pi * number / self.teeth[gear]
        angle = self.axis(state, gear, phase=phase, factor=factor) + (
            -step if gear == PINION else step
        )
        placed = self.shape(state, gear, factor=factor) * cmath.exp(1j * angle)
        return np.asarray(placed + self.centre(state, gear, factor=factor))

    def whole(self, state: DrawnState, gear: int, *, phase: int, factor: float = 1.0) -> Points:
        """All teeth of a gear in their places as one closed line."""
        step = 2.0 * math.pi / self.teeth[gear] * np.arange(self.teeth[gear])
        turns = np.exp(1j * (self.axis(state, gear, phase=phase, factor=factor) + step))
        line = (turns[:, None] * self.shape(state, gear, factor=factor)[None, :-1]).ravel()
        return np.asarray(np.append(line, line[0]) + self.centre(state, gear, factor=factor))

    def near(
        self,
        state: DrawnState,
        gear: int,
        *,
        phase: int,
        reach: complex,
        factor: float | None = None,
    ) -> Iterator[Points]:
        """The teeth with a point within ``reach`` (half width, half height) of the pitch point."""
        for number in range(self.teeth[gear]):
            points = self.tooth(state, gear, phase=phase, number=number, factor=factor)
            away = points - self.pitch_point
            if np.any((np.abs(away.real) < reach.real) & (np.abs(away.imag) < reach.imag)):
                yield points

    # --- a page ------------------------------------------------------------------------------
    def to_json(self) -> dict[str, Any]:
        """Everything as plain values, ready for JSON: lengths in mm, gaps in µm, angles in rad.

        An outline is its x and y by turns; what is not finite is None.
        """
        return {
            "words": self.words,
            "module": _plain(self.module),
            "factor": self.factor,
            "phase": _rounded(self.phase, 6),
            "centre_distance": _plain(self.centre_distance),
            "pressure_angle": round(self.pressure_angle, 9),
            "pitch_point": _plain(self.pitch_point),
            "line_of_action": [_pair(one) for one in self.line_of_action],
            "path": {name: _pair(place) for name, place in self.path.items()},
            "gears": [
                {
                    "name": name,
                    "teeth": self.teeth[gear],
                    "start": round(self.start[gear], 9),
                    "circles": {k: _plain(v) for k, v in self.circles[gear].items()},
                    "tight": _flat(self.tight[gear]),
                }
                for gear, name in enumerate(("pinion", "wheel"))
            ],
            "states": [
                {
                    "name": one.name,
                    "centre_distance": _plain(one.centre_distance),
                    "set_back": _plain(one.set_back),
                    "lag": _rounded(one.lag, 6),
                    "outlines": [_flat(points) for points in one.outlines],
                    "share": [_rounded(row, 3) for row in one.share],
                    "drive_gap": [_rounded(MILLIMETRE(row), 2) for row in one.drive_gap],
                    "back_gap": [_rounded(MILLIMETRE(row), 2) for row in one.back_gap],
                }
                for one in self.states
            ],
            "contact": [[_pair(one) for one in row] for row in self.contact],
        }


def gear_drawing(data: Dataset, operating: int = 0, *, factor: float | None = None) -> GearDrawing:
    """The drawing in a stored group at one operating point; ``factor`` None: a round one that fits.

    The factor is a 1, 2 or 5 with zeros, the greatest at which neither gap nor growth hides what a
    tooth looks like.
    """
    here = data.isel(operating=operating)
    states = tuple(_state(here.isel(state=place)) for place in range(here.sizes["state"]))
    tight = _outlines(here, "tight")
    module = MM * float(data.attrs["module"])
    distance = MM * float(data.attrs["drawn_distance"])
    names = ("base", "pitch", "tip", "root", "bore")
    angle = float(data.attrs["operating_pressure_angle"])
    base = MM * float(here["base_radius"].values[PINION])
    turn = cmath.exp(-1j * angle)
    on_path = json.loads(str(data.attrs["path_points"]))
    speed, torque = SPEED(float(here["pinion_speed"])), float(here["pinion_torque"])
    return GearDrawing(
        words=f"{exactly(speed)} rpm, {exactly(torque)} N m",
        module=module,
        teeth=(int(here["teeth"].values[PINION]), int(here["teeth"].values[WHEEL])),
        start=(float(here["start"].values[PINION]), float(here["start"].values[WHEEL])),
        circles=tuple(  # type: ignore[arg-type]
            {name: MM * float(here[f"{name}_radius"].values[gear]) for name in names}
            for gear in (PINION, WHEEL)
        ),
        tight=tight,
        states=states,
        phase=np.asarray(data["mesh_phase"].values, dtype=float),
        contact=MM * (here["contact_x"].values + 1j * here["contact_y"].values),
        centre_distance=distance,
        pressure_angle=angle,
        path={k: (base + 1j * MM * float(s)) * turn for k, s in on_path.items()},
        factor=_fitting(tight, states, module, distance) if factor is None else float(factor),
    )


def _state(here: Dataset) -> DrawnState:
    return DrawnState(
        name=str(here["state"].item()),
        outlines=_outlines(here, "outline"),
        centre_distance=MM * float(here["centre_distance"]),
        set_back=MM * float(here["set_back"]),
        lag=MM * here["lag"].values,
        share=here["load_share"].values,
        drive_gap=MM * here["drive_gap"].values,
        back_gap=MM * here["back_gap"].values,
    )


def _outlines(here: Dataset, name: str) -> tuple[Points, Points]:
    radius, angle = MM * here[f"{name}_radius"].values, here[f"{name}_angle"].values
    first, second = (np.asarray(radius[k] * np.exp(1j * angle[k])) for k in (PINION, WHEEL))
    return first, second


def _fitting(
    tight: tuple[Points, Points], states: Sequence[DrawnState], module: float, distance: float
) -> float:
    cold = states[0]
    gap = max(float(np.nanmin(one.back_gap)) for one in states)
    moved = closer = 1e-12
    for one in states:
        pairs = zip(one.outlines, cold.outlines, strict=True)
        moved = max([moved, *(float(np.max(np.abs(a - b))) for a, b in pairs)])
        apart = one.centre_distance - distance
        for gear, other in ((PINION, WHEEL), (WHEEL, PINION)):
            tip = np.abs(one.outlines[gear]).max() - np.abs(tight[gear]).max()
            root = np.abs(one.outlines[other]).min() - np.abs(tight[other]).min()
            closer = max(closer, abs(float(tip + root - apart)))
    parts = ((_GAP, max(gap, 1e-12)), (_CLOSER, closer), (_MOVED, moved))
    limits = [part * module / size for part, size in parts]
    wanted = min(max(min(limits), 1.0), 1000.0)
    power = 10.0 ** math.floor(math.log10(wanted))
    return next(step * power for step in (5.0, 2.0, 1.0) if step * power <= wanted)


def _plain(value: float, digits: int = 5) -> float | None:
    return round(float(value), digits) if math.isfinite(value) else None


def _rounded(values: Floats, digits: int) -> list[float | None]:
    return [_plain(float(one), digits) for one in values]


def _pair(point: complex) -> list[float | None] | None:
    return [_plain(point.real), _plain(point.imag)] if cmath.isfinite(point) else None


def _flat(points: Points) -> list[float | None]:
    return _rounded(np.column_stack([points.real, points.imag]).ravel(), 5)
