"""One stage of a REXS model as the fields of a case, each read, derived or left to a default."""

from __future__ import annotations

import math
from dataclasses import replace

from thermogear.base import bounds
from thermogear.base.errors import InputError
from thermogear.base.units import ROUNDED, RPM
from thermogear.case.rexs import gearbox
from thermogear.case.rexs.attributes import Read, Reader, plain
from thermogear.case.rexs.draft import Draft, Operating, tightest
from thermogear.case.rexs.drive import Drive, Load
from thermogear.case.rexs.flank_relief import relief_lines
from thermogear.case.rexs.gearbox import Stage
from thermogear.case.rexs.lines import DERIVED, GIVEN, READ
from thermogear.case.rexs.model import Component
from thermogear.case.rexs.shaft_train import bore_lines, train_lines
from thermogear.case.rexs.substances import material_lines, oil_lines
from thermogear.case.rexs.tolerances import accuracy_lines, backlash_lines
from thermogear.gears.geometry import Rack

_SPUR = 1e-9
_ALIKE = 1e-6
"""Relative difference up to which two values of one thing are the same."""
_ROUNDED = 2e-3
"""Modules by which a centre distance may be too small for its shifts: both are rounded."""


def require_spur(reader: Reader, stage: Stage) -> tuple[int, int]:
    """Numbers of teeth of gear_1 and gear_2; InputError where the stage is no external spur one."""
    if stage.why is not None:
        raise stage.why
    teeth = []
    for gear in stage.gears:
        where = f"{stage.field}.{gear.called}"
        found = reader.whole(gear, "number_of_teeth")
        if found is None:
            raise InputError(f"{where}.number_of_teeth", "nothing", allowed="a whole number")
        if found < 0:
            raise gearbox.internal(f"{where}.number_of_teeth", f"{found}, an internal gear")
        if found == 0:
            raise InputError(f"{where}.number_of_teeth", 0, allowed=">= 1")
        teeth.append(found)
    for gear in stage.gears:
        angle = reader.number(gear, "helix_angle_reference_diameter")
        if angle is not None and abs(angle.si) > _SPUR:
            raise InputError(
                f"{stage.field}.{gear.called}.helix_angle_reference_diameter",
                f"{math.degrees(angle.si):.6g} deg",
                allowed="0 deg",
                why="helical gears are not computed yet",
                fix="take a spur stage",
            )
    return teeth[0], teeth[1]


def draft(
    reader: Reader, stage: Stage, speed: str | None = None, torque: str | None = None
) -> Draft:
    """The lines of a case out of a stage; ``speed`` and ``torque`` of the pinion as a case file
    holds them are used for what the model lacks, or replace it."""
    teeth = require_spur(reader, stage)
    drive = Drive(reader)
    loads = drive.loads_of(stage)
    driver, why = _driver(reader, stage, loads, teeth)
    first = stage.gears[driver]
    second = stage.gears[1 - driver]
    made = Draft(stage, first, second)
    _title(reader, made)
    module, angle = _rack_basics(reader, made)
    for name, gear in made.both:
        found = reader.whole(gear, "number_of_teeth") or 0
        drives = f"; {why}" if name == "pinion" else ""
        made.put(f"gears.{name}.teeth", found, READ, f"number_of_teeth of {gear.called}{drives}")
        _gear(reader, made, name, gear, module, angle)
    _widths(reader, made)
    _centre_distance(reader, made, module, angle)
    material_lines(reader, made)
    oil_lines(reader, made, drive)
    sense = _sense(loads, driver)
    for name, gear in made.both:
        relief_lines(reader, made, name, gear, sense[name], (module, angle))
    accuracy_lines(reader, made)
    backlash_lines(reader, made)
    train_lines(reader, made)
    bore_lines(reader, made, module)
    _operating(made, loads, driver, teeth, speed, torque)
    return made


def _greatest(loads: list[Load]) -> Load | None:
    """The load of greatest power; None where none has a power."""
    known = [one for one in loads if one.speed and one.torque]
    return max(known, key=lambda one: abs((one.speed or 0.0) * (one.torque or 0.0)), default=None)


def _drives(load: Load) -> int:
    """The place of the gear that drives: the mesh acts against its speed."""
    return 0 if (load.speed or 0.0) * (load.torque or 0.0) < 0.0 else 1


def _driver(
    reader: Reader, stage: Stage, loads: list[Load], teeth: tuple[int, int]
) -> tuple[int, str]:
    """Place of the driving gear, and how it is known."""
    most = _greatest(loads)
    if most is not None:
        return _drives(most), "it drives by the torques of the shafts"
    for place, gear in enumerate(stage.gears):
        data = gearbox.gear_data_of(reader.model, stage.component, gear)
        if reader.truth(data, "is_driving_gear"):
            return place, "it drives by is_driving_gear"
    return (0 if teeth[0] <= teeth[1] else 1), "default: the smaller gear drives"


def _sense(loads: list[Load], driver: int) -> dict[str, float]:
    """Sense of rotation of pinion and wheel about their u axes; 0 where it is not known."""
    load = _greatest(loads)
    if load is not None and load.speed and load.other_speed and load.signed:
        both = (load.speed, load.other_speed)
        return {"pinion": both[driver], "wheel": both[1 - driver]}
    return {"pinion": 0.0, "wheel": 0.0}


def _title(reader: Reader, made: Draft) -> None:
    whole = [part.name for part in reader.model.of_type("gear_unit")[:1]]
    names = [one for one in (*whole, made.stage.component.name) if one]
    text = ", ".join("".join(c if c.isprintable() else " " for c in one) for one in names)
    if text:
        made.put("title", text[:200], READ, "names in the file")


# --- teeth ----------------------------------------------------------------------------------


def _agreed(
    made: Draft, found: list[tuple[Component, Read]], attribute: str
) -> tuple[Component, Read] | None:
    """The value all components have that have one; refused where two differ."""
    for component, value in found[1:]:
        if not math.isclose(value.si, found[0][1].si, rel_tol=_ALIKE, abs_tol=1e-12):
            raise InputError(
                f"{made.stage.field}.{component.called}.{attribute}",
                f"{plain(value.number)} {value.unit}".rstrip(),
                allowed=f"{plain(found[0][1].number)} {found[0][1].unit}".rstrip()
                + f", that of {found[0][0].called}",
                why="gears of one stage and flanks of one tooth are cut alike here",
            )
    return found[0] if found else None


def _all(
    reader: Reader, components: list[Component], attribute: str
) -> list[tuple[Component, Read]]:
    every = [(one, reader.number(one, attribute)) for one in components]
    return [(one, value) for one, value in every if value is not None]


def _rack_basics(reader: Reader, made: Draft) -> tuple[float, float]:
    """Module [m] and pressure angle [rad] of the stage."""
    gears = [gear for _, gear in made.both]
    tools = []
    flanks: list[Component] = []
    for gear in gears:
        own = gearbox.flanks_of(reader.model, gear)
        flanks += own.values()
        tool = gearbox.tool_of(reader.model, gear, own)
        tools += [tool] if tool else []
    for attribute, holders in (
        ("normal_module", gears),
        ("transverse_module", gears),
        ("normal_module", tools),
    ):
        module = _agreed(made, _all(reader, holders, attribute), attribute)
        if module:
            said, note = module[1], f"{attribute} of {module[0].called}"
            if said.unit.startswith("in"):  # which a case file takes for a diametral pitch
                note += f", {said.text}"
                said = replace(said, number=_tidy(1e3 * said.si), unit="mm")
            made.read("gears.module", said, note)
            break
    else:
        raise InputError(
            f"{made.stage.field}.normal_module", "nothing", allowed="a length", why="needed"
        )
    bounds.MODULE.require(f"{made.stage.field}.normal_module", module[1].si)
    for holders in (flanks, tools, gears):
        angle = _agreed(
            made, _all(reader, holders, "normal_pressure_angle"), "normal_pressure_angle"
        )
        if angle:
            made.read("gears.pressure_angle", angle[1], f"that of {angle[0].called}")
            bounds.PRESSURE_ANGLE.require(f"{made.stage.field}.normal_pressure_angle", angle[1].si)
            return module[1].si, angle[1].si
    return module[1].si, math.radians(20.0)


def _gear(
    reader: Reader, made: Draft, name: str, gear: Component, module: float, angle: float
) -> None:
    """Shift, diameters, tool profile and roughness of one gear."""
    place = f"gears.{name}"
    flanks = gearbox.flanks_of(reader.model, gear)
    shift = _shift(reader, made, place, [*flanks.values(), gear], module)
    tip = reader.number(gear, "tip_diameter")
    if tip is not None:
        made.read(f"{place}.tip_diameter", tip, "tip_diameter")
    _edge(reader, made, place, gear, [*flanks.values()])
    _tool(reader, made, name, gear, (module, angle, shift))
    mean = reader.number(gear, "arithmetic_average_roughness_flank")
    depth = reader.number(gear, "averaged_peak_to_valley_height_flank")
    if mean is not None:
        made.read(f"{place}.roughness", mean, "Ra of the flanks")
    elif depth is not None:
        value = f"{plain(depth.number / 6.0)} {depth.unit}"
        made.put(f"{place}.roughness", value, DERIVED, "Ra = Rz/6, a usual ratio")


def _edge(
    reader: Reader, made: Draft, place: str, gear: Component, flanks: list[Component]
) -> None:
    """The chamfer of the tip, h = (d_a - d_Fa)/2; REXS has no word for a rounding."""
    chamfer = _agreed(made, _all(reader, flanks, "tooth_tip_chamfer"), "tooth_tip_chamfer")
    tip, form = (reader.number(gear, name) for name in ("tip_diameter", "tip_form_diameter"))
    if chamfer and chamfer[1].si > 0.0:
        made.read(f"{place}.tip_chamfer", chamfer[1], f"tooth_tip_chamfer of {chamfer[0].called}")
    elif tip is not None and form is not None and form.si < tip.si:
        made.put(
            f"{place}.tip_chamfer",
            f"{plain(_tidy(0.5e3 * (tip.si - form.si)))} mm",
            DERIVED,
            "(tip_diameter - tip_form_diameter)/2",
        )


def _shift(
    reader: Reader, made: Draft, place: str, holders: list[Component], module: float
) -> float:
    found = _agreed(
        made,
        _all(reader, holders, "addendum_modification_coefficient"),
        "addendum_modification_coefficient",
    )
    if found:
        made.read(f"{place}.profile_shift", found[1], f"x of {found[0].called}")
        return found[1].si
    length = _agreed(made, _all(reader, holders, "addendum_modification"), "addendum_modification")
    if length:
        value = length[1].si / module
        made.put(f"{place}.profile_shift", value, DERIVED, "addendum_modification / module")
        return value
    return 0.0


def _tool(
    reader: Reader,
    made: Draft,
    name: str,
    gear: Component,
    basics: tuple[float, float, float],
) -> None:
    """The rack that leaves the gear's root: by its root diameter, else by its tool."""
    module, angle, shift = basics
    flanks = gearbox.flanks_of(reader.model, gear)
    tool = gearbox.tool_of(reader.model, gear, flanks)
    scale = 1.0
    own = reader.number(tool, "normal_module")
    if own is not None:
        scale = own.si / module
    root = reader.number(gear, "root_diameter")
    reach = _of_tool(reader, tool, "addendum_coefficient_reference_profile", module * scale)
    place = f"gears.{name}.rack"
    teeth = reader.whole(gear, "number_of_teeth") or 0
    if root is not None:
        dedendum = 0.5 * teeth - 0.5 * root.si / module + shift
        by = f"{root.text}, the root diameter: z/2 - d_f/(2 m) + x"
        made.put(f"{place}.dedendum", dedendum, DERIVED, by)
    elif reach is not None:
        cut = [
            one.si
            for settings in gearbox.settings_of(reader.model, gear, flanks)
            if (one := reader.number(settings, "generated_addendum_modification_coefficient"))
        ]
        dedendum = reach.si * scale
        if cut and cut[0] != shift:
            dedendum += shift - cut[0]
            said = f"tool addendum {reach.number:g} modules at the generated shift {cut[0]:g}"
            made.put(f"{place}.dedendum", dedendum, DERIVED, said)
        elif scale != 1.0:
            made.put(f"{place}.dedendum", dedendum, DERIVED, "tool addendum in modules of the gear")
        else:
            made.read(f"{place}.dedendum", reach, f"addendum of {tool.called if tool else 'tool'}")
    else:
        return
    radius = _of_tool(reader, tool, "tip_radius_factor", module * scale)
    room = Rack(dedendum=dedendum, fillet_radius=0.0).largest_fillet_radius(angle)
    if root is not None and radius is not None and radius.si * scale > room + ROUNDED:
        raise InputError(
            f"{gear.called}.number_of_teeth",
            f"{teeth} beside a root_diameter of {root.text}",
            why=f"a tool that reaches {dedendum:.4g} modules has no room for its round of "
            f"{radius.si * scale:.4g} modules",
            fix="teeth and diameters that go together",
        )
    if radius is not None and scale != 1.0:
        said = "tip radius of the tool in modules of the gear"
        made.put(f"{place}.fillet_radius", radius.si * scale, DERIVED, said)
        return
    if radius is not None:
        made.read(f"{place}.fillet_radius", radius, "tip radius of the tool")
        return
    usual = Rack().fillet_radius
    if room < usual:
        made.put(f"{place}.fillet_radius", max(room, 0.0), DERIVED, "as round as the tool may be")


_LENGTHS = {
    "addendum_coefficient_reference_profile": "addendum_reference_profile",
    "tip_radius_factor": "tip_radius",
}
"""Sizes of a tool in modules, and the same as lengths."""


def _of_tool(reader: Reader, tool: Component | None, name: str, module: float) -> Read | None:
    """A size of a tool in its modules, read, else from the length."""
    found = reader.number(tool, name)
    if found is not None:
        return found
    length = reader.number(tool, _LENGTHS[name])
    if length is None:
        return None
    size = _tidy(length.si / module)
    return Read(si=size, number=size, unit="")


def one_rack(made: Draft) -> None:
    """One rack for both gears where they are cut alike."""
    racks = [
        {one.path.rpartition(".")[2]: one for one in made.lines if f".{name}.rack." in one.path}
        for name, _ in made.both
    ]
    values = [{key: one.value for key, one in rack.items()} for rack in racks]
    if not values[0] or values[0] != values[1]:
        return
    made.lines = [one for one in made.lines if ".rack." not in one.path]
    made.lines += [replace(one, path=f"gears.rack.{key}") for key, one in racks[0].items()]


# --- the pair -------------------------------------------------------------------------------


def _widths(reader: Reader, made: Draft) -> None:
    found = False
    for name, gear in made.both:
        width = reader.number(gear, "face_width")
        if width is not None:
            made.read(f"gears.{name}.face_width", width, "face_width")
            found = True
    common = reader.number(made.stage.component, "common_face_width")
    if not found and common is not None:
        made.read("gears.face_width", common, "common_face_width of the stage")
    elif not found:
        raise InputError(
            f"{made.stage.field}.face_width", "nothing", allowed="a length", why="needed"
        )


def _centre_distance(reader: Reader, made: Draft, module: float, angle: float) -> None:
    """Read, else the distance of the axes; left out where it only misses the shifts by rounding."""
    given = reader.number(made.stage.component, "center_distance")
    if given is not None:
        value, text, origin, note = given.si, given.text, READ, "center_distance"
    else:
        apart = _axes(reader, made)
        if apart is None:
            return
        value, text = apart, f"{plain(round(1e3 * apart, 9))} mm"
        origin, note = DERIVED, "distance of the axes by their support vectors"
    tight = tightest(made, module=module, angle=angle)
    if 1e-12 * value < tight - value <= _ROUNDED * module:
        made.put(
            "gears.centre_distance",
            f"{plain(1e3 * tight)} mm",
            DERIVED,
            f"of the profile shifts without backlash; {text} in the file is rounded",
        )
        return
    made.put("gears.centre_distance", text, origin, note)


def _axes(reader: Reader, made: Draft) -> float | None:
    """Distance [m] of the two axes: of the shafts, else of the gears; None where not said."""
    of_gear = gearbox.shafts_of_gears(reader.model)
    shafts = [reader.model.at(of_gear.get(gear.id)) for _, gear in made.both]
    for pair in (shafts, [gear for _, gear in made.both]):
        points = [reader.vector(one, "support_vector") for one in pair]
        axes = [reader.vector(one, "u_axis_vector") for one in pair]
        origins = {reader.words(one, "reference_component_for_position") for one in pair}
        if points[0] is None or points[1] is None or len(origins) != 1:
            continue
        axis = axes[0] or axes[1] or (1.0, 0.0, 0.0)
        size = math.hypot(*axis)
        apart = [b - a for a, b in zip(points[0], points[1], strict=True)]
        along = sum(a * b for a, b in zip(apart, axis, strict=True)) / size if size else 0.0
        square = sum(a * a for a in apart) - along * along
        if size and square > 0.0:
            return math.sqrt(square)
    return None


# --- operating points -----------------------------------------------------------------------


def _operating(
    made: Draft,
    loads: list[Load],
    driver: int,
    teeth: tuple[int, int],
    speed: str | None,
    torque: str | None,
) -> None:
    """Speeds and torques of the pinion: a full product as lists, else the greatest power."""
    scale = 1.0 if driver == 0 else teeth[0] / teeth[1]
    other = 1.0 if driver == 0 else teeth[1] / teeth[0]
    for load in loads:
        if load.speed and load.torque and _drives(load) != driver:
            made.unused.append(f"{load.name}: the other gear drives there")
        elif load.speed and load.torque:
            turns = abs(load.speed * scale) / RPM
            moment = abs(load.torque * other)
            made.loads.append(
                Operating(
                    name=load.name,
                    speed=_tidy(turns),
                    torque=_tidy(moment),
                    duration=load.duration,
                    share=load.share,
                )
            )
        elif len(loads) > 1:
            made.unused.append(f"{load.name}: no speed or no torque at this stage")
    if speed is None and torque is None and made.loads:
        _lists(made, loads)
        return
    for name, given, fallback in (("speed", speed, "rpm"), ("torque", torque, "N m")):
        if given is not None:
            made.put(f"operating.{name}", given, GIVEN, f"--{name}")
            continue
        known = [abs(found) for load in loads if (found := getattr(load, name))]
        if not known:
            raise InputError(
                f"{made.stage.field}.operating.{name}",
                "nothing",
                allowed=f"a {name} of a shaft, in the model or a load case",
                why="the file says none that reaches this stage",
                fix=f'add --{name} "{"1000 rpm" if name == "speed" else "100 N m"}"',
            )
        value = max(known) * (scale / RPM if name == "speed" else other)
        made.put(
            f"operating.{name}", f"{plain(_tidy(value))} {fallback}", DERIVED, "from the shafts"
        )
    made.loads = []


def _tidy(value: float) -> float:
    """``value`` without the last digits that ratios and factors leave."""
    return float(f"{value:.14g}")


def _lists(made: Draft, loads: list[Load]) -> None:
    points = dict.fromkeys((one.speed, one.torque) for one in made.loads)
    speeds = list(dict.fromkeys(one.speed for one in made.loads))
    torques = list(dict.fromkeys(one.torque for one in made.loads))
    direct = len(loads) == 1 and loads[0].speed_read
    origin = READ if direct else DERIVED
    note = "the shaft's rotational_speed" if direct else "from the shafts, through the ratios"
    which = f" of {len(made.loads)} load cases" if len(made.loads) > 1 else ""
    if len(points) != len(speeds) * len(torques):
        most = max(made.loads, key=lambda one: one.speed * one.torque)
        speeds, torques = [most.speed], [most.torque]
        which = f" of {most.name}, the greatest power of {len(made.loads)}"
    made.put("operating.speed", _one_or_list(speeds, "rpm"), origin, note + which)
    made.put(
        "operating.torque",
        _one_or_list(torques, "N m"),
        DERIVED,
        f"from the loads of the shafts, without losses{which}",
    )


def _one_or_list(values: list[float], unit: str) -> object:
    texts = [f"{plain(value)} {unit}" for value in values]
    return texts[0] if len(texts) == 1 else texts
