"""What a gear case decides where its file leaves a value out, in words, by the field."""

from __future__ import annotations

from collections.abc import Sequence

from thermogear.case.backlash import Backlash
from thermogear.case.units import shown
from thermogear.gears.deviations import Deviation
from thermogear.gears.graded_flanks import WavyProfile
from thermogear.gears.pair import GearPair
from thermogear.heat.gearbox import Surroundings


def decided(
    pair: GearPair,
    backlash: Backlash,
    around: Surroundings,
    deviations: Sequence[Deviation],
    accuracy: int | None,
) -> dict[str, str]:
    """Field -> the value that replaces it, with its unit."""
    found = {
        "gears.centre_distance": shown(pair.centre_distance, "length"),
        "backlash.value": f"{shown(2.0 * backlash.half, 'length')}, total, normal",
    }
    grades = {one.gear for one in deviations if isinstance(one, WavyProfile)}
    known = "" if accuracy is None else f"{accuracy}, {' and '.join(sorted(grades))}"
    found["flanks.accuracy"] = known or "none: the tables of ISO 1328-1 end before these gears"
    found |= {
        "gearbox.housing_area": shown(around.housing_area, "area", 3),
        "gearbox.housing_coefficient": shown(
            around.housing_coefficient, "heat transfer coefficient"
        ),
        "gearbox.housing_mass": shown(around.housing_mass, "mass", 3),
        "gearbox.oil_mass": shown(around.oil_mass, "mass", 3),
    }
    if around.train is not None:
        drawn = "none: the shafts are drawn"
        found |= {"gearbox.shaft_length": drawn, "gearbox.bearing_conductance": drawn}
        if all(one.size is not None for one in around.train.bearings):
            found["gearbox.bearing_coefficient"] = "none: the bearings have laws of their own"
    for name, gear in (("pinion", pair.pinion), ("wheel", pair.wheel)):
        found |= {
            f"gears.{name}.{field}": shown(value, "length")
            for field, value in (
                ("face_width", gear.face_width),
                ("bore_radius", gear.bore_radius),
                ("tip_diameter", 2.0 * gear.tip_radius),
            )
        }
    return found
