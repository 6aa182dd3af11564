"""What a case amounts to before anything is computed: geometry, masses, frequencies."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from thermogear.base.display import kind_in_words
from thermogear.base.materials import LUBRICANT_KINDS, Lubricant
from thermogear.base.parameters import NUMBERS
from thermogear.base.units import RPM, ZERO_CELSIUS
from thermogear.case.base import Case
from thermogear.case.case import DimensionlessCase, GearCase
from thermogear.case.charts import Chart
from thermogear.case.units import shown
from thermogear.gears.accuracy import flank_class
from thermogear.gears.deviations import Deviation, PitchError, Relief
from thermogear.gears.geometry import Gear
from thermogear.gears.graded_flanks import WavyProfile
from thermogear.gears.population import measured
from thermogear.gears.turn import Eccentricity, turn_period
from thermogear.heat.lubrication import kinematic_viscosity
from thermogear.shafts.train import SHAFTS


@dataclass(frozen=True)
class Fact:
    """A number of the case with the unit it is shown in; ``value`` may be a text."""

    group: str
    name: str
    value: float | int | str
    unit: str = ""


def facts(case: Case) -> tuple[Fact, ...]:
    """The derived numbers of a case, in groups, in the units a gear engineer reads."""
    if isinstance(case, GearCase):
        return (
            *_pair(case),
            *_gear("pinion", case.pair.pinion, case.pair.start_radii[0]),
            *_gear("wheel", case.pair.wheel, case.pair.start_radii[1]),
            *_dynamics(case),
            *_train(case),
            *_oil(case.stated.lubricant),
            *_operating(case),
            *_held(case),
        )
    return _rows(case) if isinstance(case, DimensionlessCase) else ()


def _pair(case: GearCase) -> list[Fact]:
    pair, path = case.pair, case.pair.path
    group = "pair"
    listed = [
        Fact(group, "ratio", pair.ratio),
        Fact(group, "centre distance", 1e3 * pair.centre_distance, "mm"),
        Fact(group, "operating pressure angle", math.degrees(pair.operating_pressure_angle), "deg"),
        Fact(group, "base pitch", 1e3 * pair.base_pitch, "mm"),
        Fact(group, "contact ratio", pair.contact_ratio),
        Fact(group, "common face width", 1e3 * pair.face_width, "mm"),
    ]
    given = case.file.gears.centre_distance
    if given is not None and given < pair.centre_distance:
        words = f"{shown(given, 'length')}, rounded: the mesh without backlash is taken"
        listed.append(Fact(group, "centre distance given", words))
    listed += [
        Fact("path of contact from the pinion's tangent point", name, 1e3 * value, "mm")
        for name, value in zip("ABCDE", path, strict=True)
    ]
    group, cold = "backlash on the line of action", case.cold_backlash
    sizes = {"cold half backlash": cold.half}
    if cold.least != cold.most:
        sizes |= {"least cold half backlash": cold.least, "most cold half backlash": cold.most}
    listed += [Fact(group, name, 1e6 * size, "um") for name, size in sizes.items()]
    return [*listed, Fact(group, "from", cold.origin)]


def _gear(name: str, gear: Gear, start: float) -> list[Fact]:
    below = 1e6 * (start - gear.form_radius)
    cut = f"ends {below:.4g} um below the flank in use" if below > 0.05 else "shortens the contact"
    return [
        Fact(name, "teeth", gear.teeth),
        Fact(name, "pitch radius", 1e3 * gear.pitch_radius, "mm"),
        Fact(name, "base radius", 1e3 * gear.base_radius, "mm"),
        Fact(name, "root radius", 1e3 * gear.root_radius, "mm"),
        Fact(name, "form radius", 1e3 * gear.form_radius, "mm"),
        Fact(name, "tip radius", 1e3 * gear.tip_radius, "mm"),
        *(
            [Fact(name, "tip form radius", 1e3 * gear.tip_form_radius, "mm")]
            if gear.tip_form_radius < gear.tip_radius
            else []
        ),
        Fact(name, "tip thickness", 1e3 * gear.tip_land, "mm"),
        Fact(name, "least profile shift without undercut", gear.minimum_profile_shift),
        *([Fact(name, "undercut", cut)] if gear.undercut else []),
    ]


def _dynamics(case: GearCase) -> list[Fact]:
    group = "inertia"
    first, second = case.inertias
    return [
        Fact(group, "pinion", first, "kg m^2"),
        Fact(group, "wheel", second, "kg m^2"),
        Fact(group, "equivalent mass on the line of action", case.equivalent_mass, "kg"),
        Fact(group, "model", case.inertia_kind),
    ]


def _train(case: GearCase) -> list[Fact]:
    """Shafts, bearings with their clearance as mounted and cold, and what of them is unusual."""
    plan = case.train
    if plan is None:
        return []
    group = "shafts and bearings"
    listed = [
        Fact(
            group,
            f"{name}'s shaft",
            f"{1e3 * shaft.length:.6g} mm, gear at {1e3 * shaft.gear_position:.6g} mm",
        )
        for name, shaft in zip(SHAFTS, plan.shafts, strict=True)
    ]
    even = np.full((len(plan.bearings), 4), plan.reference)
    plays = 2.0 * plan.half_plays(even, reference=plan.reference)
    for bearing, play in zip(plan.bearings, plays, strict=True):
        kind = (
            "of its own law"
            if bearing.rolling is None
            else bearing.rolling.designation or "own inside"
        )
        text = f"{kind} at {1e3 * bearing.position:.6g} mm"
        if np.isfinite(play):
            text += f", radial internal clearance {1e6 * play:.3g} um mounted and cold"
        listed.append(Fact(group, bearing.name, text))
    return listed + [Fact(group, "unusual", notice.text) for notice in plan.misfits()]


def _oil(oil: Lubricant) -> list[Fact]:
    nu = 1e6 * kinematic_viscosity(oil, ZERO_CELSIUS + np.array([40.0, 100.0]))
    return [
        Fact("oil", "name", f"{oil.name}, {LUBRICANT_KINDS[oil.kind]}"),
        Fact("oil", "viscosity at 40 degC", float(nu[0]), "mm^2/s"),
        Fact("oil", "viscosity at 100 degC", float(nu[1]), "mm^2/s"),
    ]


def _operating(case: GearCase) -> list[Fact]:
    z, radius = case.pair.pinion.teeth, case.pair.pinion.base_radius
    listed = [
        Fact("mesh frequency", f"at {speed / RPM:.6g} rpm", z * speed / (2.0 * math.pi), "Hz")
        for speed in case.speeds
    ]
    return listed + [
        Fact("normal force", f"at {torque:.6g} N m", torque / radius, "N")
        for torque in case.torques
    ]


def _held(case: GearCase) -> list[Fact]:
    """What is known beforehand of temperatures that are computed, and of the flanks."""
    listed = [_deviation(deviation) for deviation in case.deviations]
    listed += [Fact("faults", words, "stated") for words in case.all_faults]
    if left := len(case.all_deviations) - len(case.deviations):
        listed.append(Fact(FLANKS, "left out of the nominal flanks", left))
    single = case.file.flanks is not None and case.file.flanks.teeth == "measured"
    listed += [*_turn(case), *(fact for chart in case.charts for fact in _measured(chart, single))]
    if not case.computed:
        return listed
    group = "temperatures computed from the heat balance"
    held = {name: float(np.ravel(t)[0]) for name, t in case.gearbox.measured.items()}
    listed += [
        Fact(group, f"{name} is held at", kelvin - ZERO_CELSIUS, "degC")
        for name, kelvin in held.items()
    ]
    for reading in case.readings:
        listed += [
            Fact(group, f"{reading.node}, {reading.kind} reading", reading.indicated, "K"),
            Fact(
                group, f"{reading.node}, correction", reading.temperature - reading.indicated, "K"
            ),
            Fact(group, f"{reading.node}, standard uncertainty", reading.uncertainty, "K"),
        ]
    return listed or [Fact(group, "held nodes", "none")]


FLANKS = "deviations of the flanks"


def _deviation(deviation: Deviation) -> Fact:
    """What is known of a deviation without a mesh: its kind, and its size where it has one."""
    gear, kind = getattr(deviation, "gear", "pair"), kind_in_words(deviation)
    if isinstance(deviation, WavyProfile):
        sizes = f"f_Halpha {1e6 * deviation.slope:+.2f}, f_falpha {1e6 * deviation.form:.2f} um"
        return Fact(FLANKS, f"{gear}, {deviation.flank} flank", f"{sizes}, drawn")
    if isinstance(deviation, Relief):
        kind = f"{deviation.end} relief"
    if isinstance(deviation, Eccentricity | Relief):
        return Fact(FLANKS, f"{gear}, {kind}", 1e6 * deviation.amount, "um")
    if isinstance(deviation, PitchError):
        most = 1e6 * float(np.ptp(deviation.errors))
        return Fact(FLANKS, f"{gear}, {kind}s from least to greatest", most, "um")
    return Fact(FLANKS, f"{gear}, {kind}", "as stated")


def _turn(case: GearCase) -> list[Fact]:
    """Period, orders and classes of gears whose teeth differ; nothing of those alike."""
    period, pair = case.period, case.pair
    if period.mesh_periods == 1:
        whole = turn_period(pair, case.all_deviations).mesh_periods
        left = Fact("period of all deviations", "mesh periods of a turn that is not taken", whole)
        return [left] if whole > 1 else []
    turns = pair.wheel.teeth // math.gcd(pair.pinion.teeth, pair.wheel.teeth)
    counts = {"mesh periods": period.mesh_periods}
    counts |= {f"order of the {k.replace('_', ' ')}": v for k, v in period.orders.items()}
    counts |= {"turns of the pinion until the same teeth meet": turns}
    counts |= {"assemblies that differ": case.assembly_count}
    facts = [Fact("period of all deviations", name, count) for name, count in counts.items()]
    for name, gear in (("pinion", pair.pinion), ("wheel", pair.wheel)):
        for flank in ("drive", "back"):
            figures = measured(pair, name, case.deviations, flank)
            grade = flank_class(gear.teeth, gear.module, figures=figures, rounded=False)
            sizes = zip(("f_p", "F_p", "f_Halpha", "f_falpha", "F_alpha"), figures, strict=True)
            text = ", ".join(f"{word} {1e6 * size:.2f}" for word, size in sizes)
            text += f" um: {'no class' if grade is None else f'class {grade}'}"
            facts.append(Fact(f"{name} about its bore", f"{flank} flanks", text))
    return facts


def _measured(chart: Chart, single: bool) -> list[Fact]:
    """Each trace's figures and class, then what of them acts, ``single`` teeth or their mean."""
    group = f"measured flanks of the {chart.gear}, class of ISO 1328-1:2013"
    listed = []
    for flank in chart.flanks:
        places = [k for k, side in enumerate(chart.traces.flank) if side == flank.flank]
        for place, figures, grade in zip(places, flank.figures, flank.grades, strict=True):
            slope, form, total = (1e6 * value for value in figures)
            text = f"f_Halpha {slope:+.2f}, f_falpha {form:.2f}, F_alpha {total:.2f} um: "
            text += "no class" if grade is None else f"class {grade}"
            listed.append(Fact(group, chart.hand(place), text))
    if single:
        return listed
    group = f"measured flanks of the {chart.gear}, what acts"
    for flank in chart.flanks:
        count = chart.traces.flank.count(flank.flank)
        mean = f"mean of {count} teeth" if count > 1 else "one tooth"
        text = f"{mean}, low-pass {1e3 * flank.cutoff:.3g} mm of roll path"
        listed.append(Fact(group, flank.flank, text))
        listed.append(Fact(group, f"{flank.flank}, peak to peak", 1e6 * np.ptp(flank.acting), "um"))
        listed.append(Fact(group, f"{flank.flank}, noise of one trace", 1e6 * flank.noise, "um"))
        if count > 1:
            listed.append(
                Fact(group, f"{flank.flank}, scatter between teeth", 1e6 * flank.scatter, "um")
            )
    return listed


def _rows(case: DimensionlessCase) -> tuple[Fact, ...]:
    listed = []
    for point in case.points:
        value = point.value - ZERO_CELSIUS if point.unit == "K" else point.value
        unit = "degC" if point.unit == "K" else ""
        numbers = ", ".join(f"{name} {getattr(point, name):.7g}" for name in NUMBERS)
        listed.append(
            Fact(f"row {point.row}", f"{point.parameter} {value:.7g} {unit}".strip(), numbers)
        )
    return tuple(listed)
