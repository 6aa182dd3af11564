"""A short case file of one's own: what a gear pair needs, the rest left to stated defaults."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

from thermogear.base.errors import InputError
from thermogear.base.toml import line, pairs, table, value_of
from thermogear.case.case import GearCase, gear_case, load_case
from thermogear.shafts.bearings.catalogue import CATALOGUE


def _each(text: str) -> list[str] | None:
    """What commas part; None of nothing."""
    return [part.strip() for part in text.split(",")] if text.strip() else None


SHEAR = 20e6
"""Torsional stress [Pa] that a new shaft is sized for; usual of gearboxes (ours)."""
BESIDE = 15e-3
"""Room [m] between a gear's face and a bearing; ours."""


@dataclass(frozen=True, kw_only=True)
class NewCase:
    """What a new case file states; texts as a file holds them, "3 mm", pairs pinion first.

    What is None is left out of the file, so that its default acts.
    """

    teeth: tuple[int, int]
    module: str
    face_width: str
    speed: str
    torque: str
    title: str | None = None
    pressure_angle: str | None = None
    profile_shift: tuple[float, float] | None = None
    centre_distance: str | None = None
    tip_rounding: str | None = None
    tip_chamfer: str | None = None
    material: tuple[str, str] | None = None
    oil: str | None = None
    oil_temperature: str | None = None
    backlash: str | None = None
    accuracy: int | None = None
    drawn_teeth: bool = False
    run_out: tuple[str, str] | None = None
    pitch_errors: tuple[str, str] | None = None
    pinion_flanks: str | None = None
    wheel_flanks: str | None = None
    allow_undercut: bool = False
    faults: tuple[str, ...] = ()
    shafts: bool = False

    def text(self, folder: Path | None = None) -> str:
        """The file; InputError where the case it describes is impossible.

        Names of charts count from ``folder``, where the file will be (default: here).
        """
        text = "\n".join(self._lines()) + "\n"
        try:
            case = load_case(text, folder=folder)
            if self.shafts:
                text += "\n".join(self._shafts(gear_case(case))) + "\n"
                load_case(text, folder=folder)
        except InputError as error:
            for each in getattr(error, "errors", (error,)):
                each.line = None
            raise
        return text

    def _lines(self) -> list[str]:
        gears = (
            line("module", self.module),
            line("pressure_angle", self.pressure_angle),
            line("face_width", self.face_width),
            line("centre_distance", self.centre_distance, "left out: the mesh without backlash"),
        )
        lines = [
            '# A spur gear pair. A number with a unit is a text: "3 mm"; a pure number is bare.',
            "# What is left out has a default: `thermogear check FILE` lists each with its reason.",
        ]
        lines += table("", line("title", self.title))
        lines += table("gears", *gears)
        for place, name in enumerate(("pinion", "wheel")):
            shift, material = self.profile_shift, self.material
            lines += table(
                f"gears.{name}",
                line("teeth", self.teeth[place]),
                line("profile_shift", shift and shift[place], "in modules"),
                line("tip_rounding", self.tip_rounding, "radius of the tip's edges"),
                line("tip_chamfer", self.tip_chamfer, "height that it takes off the tip"),
                line("material", material and material[place]),
                line("eccentricity", self.run_out and {"run_out": self.run_out[place]}),
                line("pitch_errors", self.pitch_errors and _each(self.pitch_errors[place])),
                line("allow_undercut", self.allow_undercut or None, "may shorten the contact"),
            )
        oil = line("name", self.oil or "ISO VG 100")
        known = self.oil_temperature
        temperature = line("temperature", known)
        lines += table("oil", oil, temperature if known else "# temperature: from the losses")
        if self.backlash is not None:
            value = line("value", self.backlash, "of the whole gap, along the line of action")
            lines += table("backlash", value, 'direction = "normal"', 'extent = "total"')
        lines += table(
            "flanks",
            line("accuracy", self.accuracy, "class of ISO 1328-1"),
            line("teeth", "drawn" if self.drawn_teeth else None, "each tooth its own"),
            line("pinion", self.pinion_flanks, "inspection chart, beside this file"),
            line("wheel", self.wheel_flanks),
        )
        lines += table(
            "operating",
            line("speed", self.speed, "of the pinion, which drives"),
            line("torque", self.torque, "at the pinion"),
        )
        for fault in self.faults:
            fields = pairs(
                [f"kind={part}" if "=" not in part else part for part in fault.split(",")]
            )
            lines += table("[faults]", *(line(name, value_of(text)) for name, text in fields))
        return lines

    def _shafts(self, case: GearCase) -> list[str]:
        """Two plain shafts sized by their torque, each between two bearings of the catalogue."""
        pair, torque = case.pair, max(case.torques)
        lines = []
        for gear, body in (("pinion", pair.pinion), ("wheel", pair.wheel)):
            moment = torque * body.teeth / pair.pinion.teeth
            least = (16.0 * moment / (math.pi * SHEAR)) ** (1.0 / 3.0)
            series = [bearing for name, bearing in CATALOGUE.items() if name.startswith("62")]
            bores = sorted(bearing.bore for bearing in series)
            bore = next((size for size in bores if size >= least), least)
            for most, what in (
                (2.0 * body.root_radius, f"root circle of the {gear}"),
                (bores[-1], "largest ready bearing"),
            ):
                if bore > most:
                    raise InputError(
                        "--shafts",
                        f"a shaft of {1e3 * bore:.0f} mm for {moment:.4g} N m",
                        allowed=f"up to {1e3 * most:.4g} mm, the {what}",
                        fix="leave --shafts out and describe [[shafts]] and [[bearings]] yourself",
                    )
            one = next(bearing for bearing in series if bearing.bore == bore)
            length = 5.0 * math.ceil(1e3 * (body.face_width + 2.0 * (one.width + BESIDE)) / 5.0)
            lines += [
                "",
                "[[shafts]]",
                f'gear = "{gear}"',
                f'length = "{length:.0f} mm"',
                f'diameter = "{1e3 * one.bore:.0f} mm"',
                f'bearings = "{one.designation}" # one at each end',
            ]
        return lines
