"""The one table of stored quantities and the only maker of labelled Datasets.

Inside the floors a number is an SI float; at the end of a floor :func:`label` turns the arrays
into an xarray Dataset whose variables carry units, long name, symbol and source.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.base.arrays import Dataset, Variable
from thermogear.base.errors import InputError, nearest


@dataclass(frozen=True)
class Quantity:
    """What a stored name means: unit (SI text, "1" for a pure number), words, symbol, source."""

    unit: str
    long_name: str
    symbol: str = ""
    source: str = ""


UNDEFORMED, HOT = STATES = ("undeformed", "hot")
"""States of a run: the drawing's sizes with the oil of operation, and as hot as the case says."""

STATUS = (
    "ok", "jammed", "not_converged", "diverged", "assumed", "no_oil_bath", "heat_not_settled",
    "impossible",
)  # fmt: skip
"""Meaning of the values 0, 1, 2, ... of every ``status`` variable.

Jammed: no half backlash is left. Not converged: the loaded contact, or a motion, did not settle.
Assumed: not computed, equal neighbours of a map spoke for it. No oil bath: computed, with an oil
so hot that no bath of it is kept. Heat not settled: the heat balance has no steady state.
Impossible: no case could have these values.
"""
ASSUMED, NO_OIL_BATH = STATUS.index("assumed"), STATUS.index("no_oil_bath")
HEAT_NOT_SETTLED = STATUS.index("heat_not_settled")
STILL = {
    "jammed": "the half backlash is used up: no clearance is left to move in",
    "not_converged": "the loaded contact did not settle",
    "heat_not_settled": "the heat balance did not settle",
    "impossible": "no case could have these values",
}
"""Statuses of points that have no motion, and why: the only words for these causes."""


def moves(status: ArrayLike) -> NDArray[np.bool_]:
    """Where a point has a motion by its ``status``: ok, or computed without an oil bath."""
    return np.asarray((np.asarray(status) == 0) | (np.asarray(status) == NO_OIL_BATH))


EDGE_CONTACT = ("no_edge_contact", "wheel_tip_corner", "pinion_tip_corner", "both_tip_corners")
"""Meaning of the values 0, 1, 2, 3 of every ``edge_contact``: the tip corner that carries load."""

REGIMES = ("boundary", "mixed", "elastohydrodynamic", "unloaded")
"""Meaning of the values 0 to 3 of every lubrication ``regime``."""

DIMENSIONLESS = (
    "damping_ratio",
    "frequency_ratio",
    "stiffness_amplitude",
    "thermal_stiffness_ratio",
    "mean_force",
    "force_amplitude",
    "half_backlash_ratio",
)
"""The stored numbers of the dimensionless equation, in the order of a table."""

_PHYSICS = "geometry of the involute"
_THESIS = "thesis, as printed with the smallest repair"

QUANTITIES: dict[str, Quantity] = {
    # coordinates
    "path_position": Quantity("m", "distance from the pinion's tangent point", "s", _PHYSICS),
    "mesh_phase": Quantity("1", "mesh phase, 0 where a pair enters at A", "φ"),
    "pinion_speed": Quantity("rad/s", "pinion speed", "ω₁"),
    "pinion_torque": Quantity("N m", "pinion torque", "T₁"),
    "gear_temperature": Quantity("K", "addendum temperature of both gears", "T_a"),
    # contact
    "pinion_radius": Quantity("m", "pinion radius of the contact point", "r_k1", _PHYSICS),
    "wheel_radius": Quantity("m", "wheel radius of the contact point", "r_k2", _PHYSICS),
    "reduced_radius": Quantity("m", "reduced radius of curvature", "ρ*", _PHYSICS),
    "pinion_rolling_velocity": Quantity("m/s", "rolling velocity of the pinion flank", "v₁"),
    "wheel_rolling_velocity": Quantity("m/s", "rolling velocity of the wheel flank", "v₂"),
    "sliding_velocity": Quantity("m/s", "sliding velocity v₁ − v₂", "v_s"),
    "entrainment_velocity": Quantity("m/s", "entrainment velocity (v₁ + v₂)/2", "v_e"),
    "load_share": Quantity("1", "share of the normal force on this tooth pair", "X_Γ"),
    "line_load": Quantity("N/m", "normal load per width of this tooth pair", "w"),
    "hertz_half_width": Quantity("m", "Hertzian half width", "B", "Hertz"),
    "hertz_pressure": Quantity("Pa", "Hertzian pressure at the centre", "p_H", "Hertz"),
    "normal_force": Quantity("N", "normal force T₁/r_b1", "F_n"),
    # friction and heat
    "film_thickness": Quantity("m", "least film thickness", "h_min", "Dowson and Higginson"),
    "film_parameter": Quantity("1", "film parameter h_min/Rq", "Λ"),
    "frictional_power": Quantity("W", "frictional power of the mesh, time mean", "P_f"),
    "pinion_share_of_heat": Quantity("1", "share of the mesh loss into the pinion", "β₁"),
    "power_off_the_path": Quantity(
        "1", "share of the mesh loss off the path of contact, on tip corners"
    ),
    "flank_conductance": Quantity(
        "W/K", "thermal conductance between both flanks through the contact", "G_12"
    ),
    "mesh_efficiency": Quantity("1", "efficiency of the mesh, load-dependent loss alone", "η"),
    "dynamic_viscosity": Quantity("Pa s", "oil viscosity where the film forms", "η₀", "ASTM D341"),
    "friction_coefficient": Quantity("1", "friction coefficient of the chosen law", "|μ|"),
    "friction_coefficient_mixed": Quantity(
        "1", "friction coefficient, lubricated", "|μ|", "Benedict and Kelley 1961"
    ),
    "friction_coefficient_dry": Quantity("1", "friction coefficient, dry", "|μ|"),
    "friction_coefficient_least": Quantity(
        "1", "least friction coefficient of the laws within their range", "|μ|"
    ),
    "friction_coefficient_greatest": Quantity(
        "1", "greatest friction coefficient of the laws within their range", "|μ|"
    ),
    "friction_outside_range": Quantity("1", "1 where the contact leaves the law's range"),
    "film_outside_range": Quantity("1", "1 where the film forms beyond the oil's range"),
    "flash_temperature": Quantity("K", "flash temperature rise", "ΔT_f", "Blok 1937"),
    "flash_temperature_mixed": Quantity("K", "flash temperature rise, lubricated", "ΔT_f"),
    "flash_temperature_dry": Quantity("K", "flash temperature rise, dry", "ΔT_f"),
    # over a turn: each tooth pair by its worst place along the path
    **{
        f"{name}_{key}": Quantity(*meaning)
        for name, unit, words, worst, bound, sign in (
            ("flash_temperature", "K", "flash temperature rise", "greatest", "most", "ΔT_f"),
            ("hertz_pressure", "Pa", "Hertzian pressure", "greatest", "most", "p_H"),
            ("film_parameter", "1", "film parameter", "least", "least", "Λ"),
            ("contact_temperature", "K", "contact temperature", "greatest", "most", "T_c"),
        )
        for key, meaning in {
            "median_of_turn": (unit, f"{worst} {words} of a tooth pair, median of the turn", sign),
            "decile_of_turn": (unit, f"{words} that 90 % of the tooth pairs have at {bound}", sign),
            f"{worst}_of_turn": (unit, f"{worst} {words} of the turn", sign),
            "pinion_tooth": ("1", f"pinion tooth of the {worst} {words}, 1 at mesh phase 0"),
            "wheel_tooth": ("1", f"wheel tooth of the {worst} {words}, 1 at mesh phase 0"),
        }.items()
    },
    # of the worst tooth pair of the turn, where they differ
    "greatest_flash_temperature": Quantity("K", "greatest flash temperature rise", "ΔT_f"),
    "greatest_contact_temperature": Quantity("K", "greatest contact temperature", "T_c"),
    "least_film_parameter": Quantity("1", "least film parameter", "Λ"),
    "pinion_heat_share": Quantity("1", "share of the frictional heat into the pinion", "β₁"),
    "contact_temperature": Quantity("K", "greatest contact temperature of both flanks", "T_c"),
    "pinion_body_temperature": Quantity(
        "K", "body temperature at the pinion's contact radius", "T₁"
    ),
    "wheel_body_temperature": Quantity("K", "body temperature at the wheel's contact radius", "T₂"),
    "pinion_shaft_heat": Quantity("W", "heat conducted from the pinion's rim to its bore", "Q₁"),
    "wheel_shaft_heat": Quantity("W", "heat conducted from the wheel's rim to its bore", "Q₂"),
    # deformation and backlash
    "pinion_deformation": Quantity("m", "normal growth of the pinion flank", "δ_n1"),
    "wheel_deformation": Quantity("m", "normal growth of the wheel flank", "δ_n2"),
    "deformation_sum": Quantity("m", "normal growth of both flanks", "δ_n1 + δ_n2"),
    "pinion_base_growth": Quantity("m", "radial growth at the pinion's base circle", "u_b1"),
    "wheel_base_growth": Quantity("m", "radial growth at the wheel's base circle", "u_b2"),
    "half_backlash_curve": Quantity("m", "half backlash along the line of action", "b′(φ)"),
    "half_backlash": Quantity("m", "half backlash, mean over the mesh phase", "b′"),
    "least_half_backlash": Quantity("m", "half backlash, least over the mesh phase", "b′_min"),
    **{
        f"half_backlash_by_{name}": Quantity("m", f"what {words} to the cold half backlash")
        for name, words in (
            ("deviations", "flank deviations add"),
            ("speed", "the centrifugal growth of both gears adds, after the deviations,"),
            ("heat", "heat adds, after deviations and centrifugal growth,"),
        )
    },
    "edge_contact_share": Quantity(
        "1", "share of the mesh period in which a tip corner carries load"
    ),
    "cold_half_backlash": Quantity("m", "cold half backlash, flanks without deviations", "b"),
    "kinematic_error": Quantity(
        "m", "unloaded error of both flanks' touch, by deviations, speed and heat", "e_k"
    ),
    "spring_error": Quantity(
        "m", "error of the one-spring mesh force, mean removed (elasticity not in it)", "e_0"
    ),
    "transmission_error": Quantity("m", "static transmission error under load", "δ"),
    "jam_temperature": Quantity(
        "K",
        "pinion addendum temperature at which the backlash is used up, "
        "both gears rising alike, housing as it is",
        "T_jam",
    ),
    "proportional_jam_temperature": Quantity(
        "K",
        "pinion addendum temperature at which the backlash is used up, "
        "shafts and housing rising in proportion to the gears",
        "T_jam,p",
    ),
    # stiffness
    "mesh_stiffness": Quantity("N/m", "mesh stiffness", "k"),
    "elastic_stiffness": Quantity("N/m", "mesh stiffness without the thermal term", "k⁰"),
    "pair_stiffness": Quantity("N/m", "stiffness of one tooth pair", "k_pair"),
    "thermal_stiffness": Quantity("N/m", "thermal stiffness of the thesis", "k_T", _THESIS),
    "hertz_stiffness": Quantity("N/m", "contact stiffness of one pair", "k_h"),
    "pinion_bending_stiffness": Quantity("N/m", "bending stiffness, pinion tooth", "k_b1"),
    "wheel_bending_stiffness": Quantity("N/m", "bending stiffness, wheel tooth", "k_b2"),
    "pinion_shear_stiffness": Quantity("N/m", "shear stiffness, pinion tooth", "k_s1"),
    "wheel_shear_stiffness": Quantity("N/m", "shear stiffness, wheel tooth", "k_s2"),
    "pinion_axial_stiffness": Quantity("N/m", "axial stiffness, pinion tooth", "k_a1"),
    "wheel_axial_stiffness": Quantity("N/m", "axial stiffness, wheel tooth", "k_a2"),
    "pinion_body_stiffness": Quantity("N/m", "body stiffness, pinion", "k_f1"),
    "wheel_body_stiffness": Quantity("N/m", "body stiffness, wheel", "k_f2"),
    "pinion_gear_stiffness": Quantity("N/m", "stiffness of tooth and body, pinion", "k_g1"),
    "wheel_gear_stiffness": Quantity("N/m", "stiffness of tooth and body, wheel", "k_g2"),
    "mean_stiffness": Quantity("N/m", "mesh stiffness, time mean", "k_m"),
    "rim_stiffness": Quantity(
        "N/m", "mean stiffness of the loaded contact, body without wind-up (rim)", "k_rim"
    ),
    "bore_clamped_stiffness": Quantity(
        "N/m", "mean stiffness of the loaded contact, body clamped at its bore", "k_bore"
    ),
    "peak_to_peak_stiffness": Quantity("N/m", "mesh stiffness, peak to peak", "Δk"),
    "mid_range_stiffness": Quantity("N/m", "mesh stiffness, mid-range (max + min)/2", "k_mid"),
    # dimensionless numbers of the equation of motion
    "natural_frequency": Quantity("Hz", "natural frequency of the mean stiffness", "f_n"),
    "mesh_frequency": Quantity("Hz", "mesh frequency", "f_mesh"),
    "damping_ratio": Quantity("1", "damping ratio", "ζ"),
    "frequency_ratio": Quantity("1", "mesh frequency over natural frequency", "ω_h"),
    "stiffness_amplitude": Quantity("1", "first harmonic of the stiffness over its mean", "ε"),
    "thermal_stiffness_ratio": Quantity("1", "change of mean stiffness by heat", "ε_T"),
    "mean_force": Quantity("1", "mean excitation F̂/(k_m b_c)", "F_m"),
    "force_amplitude": Quantity("1", "alternating excitation of the first harmonic", "F_h"),
    "half_backlash_ratio": Quantity("1", "hot over cold half backlash", "B′"),
    # motion
    "time": Quantity("s", "time", "t"),
    "displacement": Quantity("m", "relative displacement on the line of action", "x"),
    "velocity": Quantity("m/s", "relative velocity", "ẋ"),
    "section_displacement": Quantity("m", "Poincaré section: displacement", "x"),
    "section_velocity": Quantity("m/s", "Poincaré section: velocity", "ẋ"),
    "order": Quantity("1", "order of the mesh frequency", "f/f_mesh"),
    "line_frequency": Quantity("Hz", "frequency of a spectral line", "f"),
    "line_amplitude": Quantity("m", "amplitude of a spectral line (peak)", "|x|"),
    "dte_line": Quantity("m", "amplitude of a line of the transmission error (peak)", "|x + e|"),
    "dte_peak_to_peak": Quantity("m", "dynamic transmission error, peak to peak", "Δ(x + e)"),
    "peak_to_peak_displacement": Quantity("m", "relative displacement, peak to peak", "Δx"),
    "half_order_amplitude": Quantity("m", "amplitude of the line at half the mesh frequency", ""),
    "scaled_displacement": Quantity("1", "relative displacement x/b_c", "X"),
    "scaled_velocity": Quantity("1", "relative velocity, dimensionless", "Ẋ"),
    "contact_loss_share": Quantity("1", "share of time out of drive-side contact", ""),
    "back_impacts": Quantity("1", "back-side impacts per period", ""),
    # measured records ("1" where the record states no unit or no rate)
    "record_sample": Quantity("1", "sample of the record", "n"),
    "record_reading": Quantity("1", "reading in the record's own unit", ""),
    "piece_sample": Quantity("1", "first sample of a piece of the record", "n"),
    "piece_lowest": Quantity("1", "lowest reading of a piece, in the record's own unit", ""),
    "piece_highest": Quantity("1", "highest reading of a piece, in the record's own unit", ""),
    "spectrum_position": Quantity("1", "cycles per sample", "f/f_s"),
    "spectrum_reading": Quantity("1", "amplitude (peak) in the record's own unit", ""),
    "line_order": Quantity("1", "order of the first shaft", "f/f_shaft"),
    "line_position": Quantity("1", "cycles per sample", "f/f_s"),
    "line_reading": Quantity("1", "amplitude (peak) in the record's own unit", ""),
    "line_acceleration": Quantity("m/s^2", "acceleration of a line (peak)", "a"),
    "line_displacement": Quantity("m", "displacement of a line (peak)", "x"),
    "line_uncertainty": Quantity("1", "relative standard uncertainty of a line", "u_D"),
    "line_half_width": Quantity("1", "relative half width of the 95 % interval of a line", "U_D"),
    "line_position_half_width": Quantity("1", "half width of the 95 % interval of f/f_s", ""),
    "line_frequency_half_width": Quantity("Hz", "half width of the 95 % interval of f", "U(f)"),
    "implied_shaft_speed_half_width": Quantity(
        "rad/s", "half width of the 95 % interval of the first shaft's speed", "U(ω₁)"
    ),
    "slice_order": Quantity("1", "order of the first shaft, or of the mesh line", "o"),
    "slice_time": Quantity("s", "time of a slice", "t"),
    "slice_speed": Quantity("rad/s", "speed of what the orders count", "ω"),
    "slice_speed_rate": Quantity("rad/s^2", "change of that speed", "dω/dt"),
    "slice_frequency": Quantity("Hz", "frequency of an order", "f"),
    "slice_reading": Quantity("1", "amplitude (peak) of an order in the record's own unit", ""),
    "slice_reading_half_width": Quantity("1", "half width of its 95 % interval", ""),
    "slice_acceleration": Quantity("m/s^2", "acceleration of an order (peak)", "a"),
    "slice_displacement": Quantity("m", "displacement of an order (peak)", "x"),
    "slice_half_width": Quantity("1", "relative half width of the 95 % interval", "U_D"),
    "slice_phase": Quantity("rad", "phase of an order against the angle", "φ"),
    "slice_turns": Quantity("1", "turns that an order is read over", "T"),
    "map_order": Quantity("1", "order of the first shaft, or of the mesh line", "o"),
    "map_speed": Quantity("rad/s", "speed of what the orders count", "ω"),
    "map_time": Quantity("s", "time of a row", "t"),
    "map_reading": Quantity("1", "amplitude (peak) in the record's own unit", ""),
    "line_bin_offset": Quantity("1", "distance from the nearest bin's centre", ""),
    "line_prominence": Quantity("1", "amplitude over the floor beside", ""),
    "implied_shaft_speed": Quantity("rad/s", "speed of the first shaft", "ω₁"),
    "measured_value": Quantity("1", "measured (Hz, m or m/s^2)", ""),
    "simulated_value": Quantity("1", "simulated (Hz, m or m/s^2)", ""),
    "comparison_error": Quantity("1", "(simulated - measured)/measured", "E"),
    "u_num": Quantity("1", "relative numerical uncertainty", "u_num"),
    "u_input": Quantity("1", "relative input uncertainty", "u_input"),
    "u_data": Quantity("1", "relative uncertainty of the data", "u_D"),
    "u_val": Quantity("1", "relative validation uncertainty", "u_val"),
    "mesh_line_offset": Quantity("Hz", "measured line less the nominal mesh frequency", ""),
    "implied_acceleration": Quantity("m/s^2", "acceleration a line implies", "a"),
    # closed orbits and their proof
    "orbit_period": Quantity("1", "mesh periods after which the orbit closes", "n"),
    "multiplier_real": Quantity("1", "Floquet multiplier over the orbit, real part", "Re μ"),
    "multiplier_imag": Quantity("1", "Floquet multiplier over the orbit, imaginary part", "Im μ"),
    "multiplier_modulus": Quantity(
        "1", "largest Floquet multiplier of an orbit, modulus; chaos has none", "|μ|"
    ),
    "cage": Quantity("1", "cages from the drawn position on, in pitches of the elements"),
    "cage_mesh_force": Quantity("N", "greatest force of the drive flanks there"),
    "cage_bearing_force": Quantity("N", "greatest force on the bearing there"),
    "ball_pass_order": Quantity("1", "elements passing the outer ring, in orders of the mesh", "p"),
    "ball_pass_line": Quantity("N", "line of the bearing force there, larger of x and y (peak)"),
    "conditional_exponent": Quantity("1", "largest conditional exponent, per mesh period", "λ"),
    "conditional_exponent_error": Quantity("1", "its error: scatter, or drift over the record"),
    "multiplier_error": Quantity("1", "what finer steps change its modulus by"),
    "lyapunov_exponent": Quantity("1", "largest Lyapunov exponent, per ω_n t", "λ₁"),
    "lyapunov_error": Quantity("1", "its standard error (batch means)", "s(λ₁)"),
    "followed_periods": Quantity("1", "mesh periods each start was followed in chaos, 0: no chaos"),
    "followed_starts": Quantity("1", "starts apart by rounding that share the label"),
    "lyapunov_batch": Quantity("1", "largest Lyapunov exponent, batch means", "λ₁"),
    "contact_losses": Quantity("1", "losses of drive contact per orbit"),
    "back_impacts_per_orbit": Quantity("1", "back-side impacts per orbit"),
    "drive_share": Quantity("1", "share of time in drive contact"),
    "free_share": Quantity("1", "share of time in free flight"),
    "back_share": Quantity("1", "share of time in back-side contact"),
    "dynamic_load_factor": Quantity("1", "greatest over mean mesh force", "DLF"),
    "least_displacement": Quantity("m", "least displacement on the orbit", "x_min"),
    "greatest_displacement": Quantity("m", "greatest displacement on the orbit", "x_max"),
    # drive trains in motion
    "journal_path": Quantity("m", "path of the journal against its outer ring", "u"),
    "radial_internal_clearance": Quantity(
        "m", "radial internal clearance (ISO 5753-1), the whole play; below zero a preload"
    ),
    "mean_bearing_load": Quantity("N", "mean force of the journal on its outer ring"),
    "bearing_contact_share": Quantity("1", "share of time in which the bearing carries load"),
    "bearing_contact_losses": Quantity("1", "losses of contact of the bearing per mesh period"),
    "second_frequency": Quantity(
        "1", "second base frequency of a motion on a torus, in mesh frequencies", "ν"
    ),
    "second_frequency_error": Quantity("1", "its error"),
    "torus_deflection": Quantity("m", "closed curve of the sections: deflection"),
    "torus_rate": Quantity("m/s", "closed curve of the sections: its rate"),
    "status": Quantity("1", "status of the point"),
}


NO_COUNT: dict[str, int] = {"missing_value": 0}
"""CF attribute of counts from 1 on: a stored 0 means that there is none; files leave it out."""
_COUNTS = ("orbit_period", "followed_periods", "followed_starts")


def attributes(name: str) -> dict[str, Any]:
    """units, long_name, symbol and source of a stored name, without empty entries.

    Of a count :data:`NO_COUNT` too.
    """
    if name not in QUANTITIES:
        raise InputError("quantity", repr(name), fix=nearest(name, QUANTITIES))
    quantity = QUANTITIES[name]
    pairs = {
        "units": quantity.unit,
        "long_name": quantity.long_name,
        "symbol": quantity.symbol,
        "source": quantity.source,
    }
    kept = {key: value for key, value in pairs.items() if value}
    return kept | NO_COUNT if name in _COUNTS else kept


def still(status: int, words: str) -> InputError:
    """What to raise where a motion is asked of a point that has none, in the state ``words``."""
    name = STATUS[status]
    fix = (
        "choose another operating point, or give temperatures"
        if name != "jammed"
        else "lower the temperature or raise the backlash"
    )
    return InputError("operating", f"{name.replace('_', ' ')} ({words})", why=STILL[name], fix=fix)


def is_known(status: ArrayLike) -> NDArray[np.bool_]:
    """Where heat and loaded contact are known, jammed or not, of values of ``status``."""
    return ~np.isin(status, [STATUS.index(word) for word in STILL if word != "jammed"])


def status_attributes() -> dict[str, Any]:
    """CF flag attributes of a ``status`` variable."""
    return {
        "long_name": "status of the point",
        "flag_values": np.arange(len(STATUS), dtype=np.int8),
        "flag_meanings": " ".join(STATUS),
    }


def edge_attributes() -> dict[str, Any]:
    """CF flag attributes of an ``edge_contact`` variable."""
    return {
        "long_name": "tip corner that carries load; the Hertzian pressure is not valid there",
        "flag_values": np.arange(len(EDGE_CONTACT), dtype=np.int8),
        "flag_meanings": " ".join(EDGE_CONTACT),
    }


FASTER_RULE = (
    "labels by a faster rule, an estimate: one start, left as soon as it closes or its exponent is "
    "positive; chaos may end later, and a start on a border may end elsewhere"
)
"""What proves the labels of maps, diagrams, basins and run-ups."""
FIXED_STEPS = (
    "over the turn motions are followed in fixed steps until a turn, or up to eight of them, "
    "repeats itself: no orbit is proven; what does not is undecided, its figures those of the "
    "later half of what was followed"
)
"""What proves the labels of run-ups and sweeps over a turn."""


def of_turn(mesh_periods: float) -> str:
    """Words after a count of periods that are turns of ``mesh_periods``; else nothing."""
    return " of the turn" if mesh_periods > 1 else ""


def label_words(name: str, *, followed: int, starts: int, mesh_periods: int = 1) -> str:
    """What a reader sees of a label: "chaotic for 32 268 periods, 16 starts", else the name.

    ``followed`` periods were run from each of ``starts`` starts and none closed; 0: not known.
    Where ``mesh_periods`` are a turn, after which a pair of gears repeats itself, an orbit closes
    after turns: "period 6 of the turn"; what went by is counted in mesh periods.
    """
    if name != "chaotic" or followed <= 0:
        turns = of_turn(mesh_periods) if name.startswith("period-") else ""
        return f"{name.replace('-', ' ')}{turns}" if turns else name
    length = f"{followed:,}".replace(",", " ")
    counted = "mesh periods" if mesh_periods > 1 else "periods"
    return f"chaotic for {length} {counted}, {starts} start{'s' * (starts > 1)}"


def told_labels(data: Dataset) -> NDArray[np.str_]:
    """:func:`label_words` of every stored label, in its shape."""
    names = data["label"].values.astype(str)
    seen = [
        data[name].values if name in data else np.zeros(names.shape)
        for name in ("followed_periods", "followed_starts")
    ]
    of = int(data.attrs.get("mesh_periods", 1))
    told = [
        label_words(str(name), followed=int(periods), starts=int(starts), mesh_periods=of)
        for name, periods, starts in zip(names.flat, seen[0].flat, seen[1].flat, strict=True)
    ]
    return np.array(told, dtype=np.str_).reshape(names.shape)


def told_operating(data: Dataset) -> int:
    """Place of the operating point that represents the rest: the first with a hot state, else 0."""
    if "status" not in data or "operating" not in data["status"].dims:
        return 0
    status = data["status"].isel(state=-1) if "state" in data["status"].dims else data["status"]
    known = is_known(status.transpose("operating", ...).values)
    places = np.flatnonzero(known.reshape(known.shape[0], -1).all(axis=1))
    return int(places[0]) if places.size else 0


def regime_attributes() -> dict[str, Any]:
    """CF flag attributes of a lubrication ``regime``."""
    return {
        "units": "1",
        "long_name": "lubrication regime by the film parameter",
        "flag_values": np.arange(len(REGIMES), dtype=np.int8),
        "flag_meanings": " ".join(REGIMES),
    }


FLAGS = {
    "status": status_attributes,
    "edge_contact": edge_attributes,
    "regime": regime_attributes,
}
"""Variables whose values are places in a list of words."""


def dressed(
    dims: str | tuple[str, ...], values: ArrayLike, unit: str = "", words: str = ""
) -> Variable:
    """A variable that is no part of the vocabulary, with its unit and long name where given."""

    told = {"units": unit, "long_name": words}
    return _variable(dims, np.asarray(values), {k: v for k, v in told.items() if v})


def _variable(dims: Any, values: NDArray[Any], told: dict[str, Any]) -> Variable:
    """A variable of an array; of numbers and texts xarray need not look whether they are dask's,
    which it would load."""
    import xarray as xr

    return xr.Variable(dims, values, told, fastpath=values.dtype.kind not in "OMm")


def labelled(name: str, entry: Any) -> Variable:
    """One variable of :func:`label`."""
    import xarray as xr

    if isinstance(entry, xr.Variable):
        return entry
    dims, values, *told = entry if isinstance(entry, tuple) else (name, entry)
    if told:
        return dressed(dims, values, *told)
    if name in FLAGS:
        return _variable(dims, np.asarray(values, np.int8), FLAGS[name]())
    values = np.asarray(values)
    text = name not in QUANTITIES and values.dtype.kind in "UO"
    return _variable(dims, values, {} if text else attributes(name))


def label(
    variables: Mapping[str, Any],
    coordinates: Mapping[str, Any] | None = None,
    attributes_of_all: Mapping[str, Any] | None = None,
) -> Dataset:
    """The Dataset of ``variables`` and ``coordinates`` by name, with units and long names.

    An entry is (dims, values) of a name in :data:`QUANTITIES` or :data:`FLAGS`, or of texts, which
    have no unit; (dims, values, unit, words) of what is described on the spot; a variable with
    labels already; or the values alone of a dimension's own coordinate. Raises InputError for a
    number without a unit, which says the nearest name.
    """
    import xarray as xr

    def made(entries: Mapping[str, Any]) -> dict[str, Any]:
        # an array out of a Dataset brings its own coordinates
        return {
            name: one if isinstance(one, xr.DataArray) else labelled(name, one)
            for name, one in entries.items()
        }

    return xr.Dataset(made(variables), made(coordinates or {}), dict(attributes_of_all or {}))


FLANKS = ("drive flank", "back flank")
"""The first contacts; bearings follow, one by one."""


def contact_name(contact: int, bearings: Sequence[str] = ()) -> str:
    """The contact's name: a flank, or its bearing by name, else by its number in the model.

    >>> contact_name(0), contact_name(2), contact_name(2, ["pinion left"])
    ('drive flank', 'bearing 1', 'pinion left')
    """
    bearing = contact - len(FLANKS)
    if bearing < 0:
        return FLANKS[contact]
    return bearings[bearing] if bearing < len(bearings) else f"bearing {bearing + 1}"
