"""A short case file of one's own: what a gear pair needs, the rest left to stated defaults."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from thermogear.base.errors import InputError
from thermogear.base.toml import line, table
from thermogear.case.case import gear_case, load_case
from thermogear.case.new_shafts import shaft_lines


@dataclass(frozen=True, kw_only=True)
class NewCase:
    """What a new case file states; texts as a file holds them, "3 mm", pairs pinion first.

    What is None is left out of the file, so that its default acts. ``shafts``: two with four
    bearings of the catalogue, sized by the torque.
    """

    teeth: tuple[int, int]
    module: str
    face_width: str
    speed: str
    torque: str
    title: str | None = None
    profile_shift: tuple[float, float] | None = None
    centre_distance: str | None = None
    material: tuple[str, str] | None = None
    oil: str | None = None
    oil_temperature: str | None = None
    backlash: str | None = None
    accuracy: int | None = None
    pinion_flanks: str | None = None
    wheel_flanks: str | None = None
    shafts: bool = False

    def text(self, folder: Path | None = None) -> str:
        """The file; InputError where the case it describes is impossible.

        Names of charts count from ``folder``, where the file will be (default: here).
        """
        text = "\n".join(self._lines()) + "\n"
        try:
            case = load_case(text, folder=folder)
            if self.shafts:
                text += "\n".join(shaft_lines(gear_case(case))) + "\n"
                load_case(text, folder=folder)
        except InputError as error:
            for one in getattr(error, "errors", (error,)):
                one.line = None
            raise
        return text

    def _lines(self) -> list[str]:
        gears = (
            line("module", self.module),
            line("face_width", self.face_width),
            line("centre_distance", self.centre_distance, "left out: the mesh without backlash"),
        )
        found = [
            '# A spur gear pair. A number with a unit is a text: "3 mm"; a pure number is bare.',
            "# What is left out has a default: `thermogear check FILE` lists each with its reason.",
        ]
        found += table("", line("title", self.title))
        found += table("gears", *gears)
        for place, name in enumerate(("pinion", "wheel")):
            shift, material = self.profile_shift, self.material
            found += table(
                f"gears.{name}",
                line("teeth", self.teeth[place]),
                line("profile_shift", shift and shift[place], "in modules"),
                line("material", material and material[place]),
            )
        oil = line("name", self.oil or "ISO VG 100")
        known = self.oil_temperature
        temperature = line("temperature", known)
        found += table("oil", oil, temperature if known else "# temperature: from the losses")
        if self.backlash is not None:
            value = line("value", self.backlash, "of the whole gap, along the line of action")
            found += table("backlash", value, 'direction = "normal"', 'extent = "total"')
        found += table(
            "flanks",
            line("accuracy", self.accuracy, "class of ISO 1328-1"),
            line("pinion", self.pinion_flanks, "inspection chart, beside this file"),
            line("wheel", self.wheel_flanks),
        )
        return found + table(
            "operating",
            line("speed", self.speed, "of the pinion, which drives"),
            line("torque", self.torque, "at the pinion"),
        )
