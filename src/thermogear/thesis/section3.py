"""Claims of section 3: backlash, stiffness, equations of motion."""

from __future__ import annotations

import numpy as np

from thermogear.base.display import CELSIUS, MICROMETRE, MILLIMETRE, PERCENT, SPEED, STIFFNESS
from thermogear.base.vocabulary import UNDEFORMED
from thermogear.dynamics.models import dead_zone
from thermogear.thesis import chain
from thermogear.thesis.claim import Claim, Finding, Verdict, listed, verdict_of
from thermogear.thesis.evidence import Evidence

CYCLE = "thermogear.mesh.cycle.mesh_cycle"
THERMAL, SPRING_MODEL = "thermogear.mesh.thermal", "thermogear.gears.stiffness"
MODELS, EXCITE = "thermogear.dynamics.models", "thermogear.mesh.excite.excitation"


def _by_heat(e: Evidence, name: str) -> list[float]:
    """Hot over cold at the first operating point [%]: thesis, consistent."""
    k = e.groups["mesh"][name].isel(operating=0)
    return [
        PERCENT(float(k.sel(bundle=b, state="hot") / k.sel(bundle=b, state=UNDEFORMED) - 1.0))
        for b in ("thesis", "consistent")
    ]


def _row(e: Evidence, name: str, bundle: str) -> np.ndarray:
    """A figure over the gear temperatures of the row, first operating point."""
    data = e.groups["temperature"].sel(bundle=bundle).isel(operating=0)
    return np.asarray(data[name].values, dtype=float)


def _temperatures(e: Evidence) -> str:
    return listed(CELSIUS(e.case.gear_temperatures), ".0f", "°C")


def _reduces(e: Evidence) -> Finding:
    cold = MICROMETRE(e.case.operating.half_backlash)
    thesis, right = (MICROMETRE(_row(e, "half_backlash", b)) for b in ("thesis", "consistent"))
    uniform, _ = chain.uniform_change(e.case, e.case.gear_temperatures[-1])
    return Finding(
        f"half backlash {cold:.4g} µm cold, {listed(thesis, '.4g')} µm at {_temperatures(e)}",
        f"{listed(right, '.4g')} µm; with the housing as hot as the gears {uniform:+.1e} of it",
        verdict_of(bool(np.all(right < cold)), assumption=True),
        "It does as long as the housing stays cooler than the gears. How much cooler, which is "
        "not stated, decides nearly all of it: equally hot, nothing changes.",
    )


def _half_gap(e: Evidence) -> Finding:
    thesis, right = (
        MICROMETRE(float(_row(e, "half_backlash", b)[-1])) for b in ("thesis", "consistent")
    )
    cold = MICROMETRE(e.case.operating.half_backlash)
    mesh = e.groups["temperature"].sel(bundle="consistent").isel(operating=0, gear_temperature=-1)
    jam = CELSIUS(float(mesh["jam_temperature"]))
    return Finding(
        f"loses {cold - thesis:.3g} µm of {cold:.4g} µm at the hottest",
        f"loses {cold - right:.3g} µm; jams at {jam:.0f} °C with the housing as it is",
        verdict_of(abs((cold - thesis) / (cold - right) - 1.0) < 0.05),
        "Both flanks of both gears grow, so the sum of the two deformations counts whole and not "
        "half, and the warm housing moves the axes apart, which is missing. The printed form also "
        "says nothing of a gap that is used up.",
    )


def _half_gap_symbols(e: Evidence) -> Finding:
    path = e.bundle("path", "consistent").isel(operating=0)
    total = MICROMETRE(path["deformation_sum"].values)
    return Finding(
        "one deformation for each gear",
        f"the sum of both runs from {total.min():.4g} to {total.max():.4g} µm along the path",
        Verdict.ASSUMED,
        "At which point of the flank the deformations are taken is not said; the sum of both "
        f"hardly depends on it ({np.ptp(total):.2g} µm) while each alone does.",
    )


def _gap_function(e: Evidence) -> Finding:
    b = float(_row(e, "half_backlash", "consistent")[0])
    x = np.linspace(-3.0 * b, 3.0 * b, 1201)
    printed = np.where(x < -b, x + b, np.where(x > b, x - b, 0.0))
    off = float(np.max(np.abs(printed - dead_zone(x, half_backlash=b)))) / b
    return Finding(
        f"differs from the dead zone computed with by {off:.1e} of b′",
        "the same function",
        verdict_of(off < 1e-12),
        "A dead zone of width 2b′ with unit slopes, continuous at its edges.",
    )


def _energy_method(e: Evidence) -> Finding:
    f = e.fit
    loaded = e.bundle("mesh", "consistent", UNDEFORMED).isel(operating=0)
    k = loaded["mesh_stiffness"].values
    return Finding(
        f"{listed([STIFFNESS(f['minimum']), STIFFNESS(f['maximum'])], '.4g')}·10⁸ N/m, one "
        "and two pairs",
        f"{listed([STIFFNESS(k.min()), STIFFNESS(k.max())], '.4g')}·10⁸ N/m from the loaded "
        "contact",
        Verdict.ASSUMED,
        "The textbook sum can be computed with width and bores assumed. It lets two teeth on one "
        "gear body know nothing of each other and so is too stiff where two pairs carry.",
    )


def _five_parts(e: Evidence) -> Finding:
    mesh = e.bundle("mesh", "thesis", UNDEFORMED).isel(operating=0)
    middle = mesh.sizes["path_position"] // 2
    parts = [
        float(mesh[name].values[middle])
        for name in mesh.data_vars
        if str(name).endswith(("_bending_stiffness", "_shear_stiffness", "_axial_stiffness",
                               "_body_stiffness")) or name == "hertz_stiffness"
    ]  # fmt: skip
    total = float(mesh["pair_stiffness"].values[middle])
    series = 1.0 / sum(1.0 / k for k in parts)
    return Finding(
        f"{len(parts)} springs in series give {STIFFNESS(series):.5g}·10⁸ N/m at mid path",
        f"the pair's stiffness there: {STIFFNESS(total):.5g}·10⁸ N/m",
        verdict_of(abs(series / total - 1.0) < 1e-9),
        "Contact, and for each gear bending, shear, axial compression and body: five kinds.",
    )


def _thermal_spring(e: Evidence) -> Finding:
    reference = e.case.operating.temperatures.reference
    warm = np.array([reference + 10.0, e.case.gear_temperatures[0], e.case.gear_temperatures[-1]])
    spring, elastic = chain.thermal_springs(e.case, warm)
    torque = chain.thermal_spring_over_torque(e.case, np.array([50.0, 200.0]))
    _, change = chain.uniform_change(e.case, e.case.gear_temperatures[-1])
    return Finding(
        f"k_T {listed(STIFFNESS(spring))}·10⁸ N/m at {listed(CELSIUS(warm), '.0f')} °C beside "
        f"{STIFFNESS(elastic[0]):.3g}·10⁸ N/m; {torque[1] / torque[0]:.3g} times as much at 4 "
        "times "
        "the torque",
        f"growth alone changes the tangent stiffness by {change:+.1e}",
        verdict_of(spring[0] < spring[-1]),
        "Its unit is N/m² (divided by the width), it tends to infinity as the gears get cold and "
        "falls as they heat. Thermal strain does not depend on load: it is an offset of the "
        "flanks, not a spring.",
    )


def _series(e: Evidence) -> Finding:
    path = e.bundle("path", "thesis").isel(operating=0, path_position=0)
    force = float(e.bundle("mesh", "thesis")["normal_force"].isel(operating=0))
    k1, k2 = (force / float(path[f"{gear}_deformation"]) for gear in ("pinion", "wheel"))
    ours = 1.0 / (1.0 / k1 + 1.0 / k2)
    printed = k1 * k2 / (k1 + k2)
    grown = force / float(path["deformation_sum"])
    return Finding(
        f"k1 k2/(k1 + k2) against 1/(1/k1 + 1/k2): {printed / ours - 1.0:+.1e}",
        f"that is the force over the sum of both deformations: {grown / ours - 1.0:+.1e}",
        verdict_of(
            max(abs(printed / ours - 1.0), abs(grown / ours - 1.0)) < 1e-12, assumption=True
        ),
        "Two springs in series, right if there were springs (and if the face width is left out, "
        "so that the unit is that of a stiffness).",
    )


def _sum_of_stiffness(e: Evidence) -> Finding:
    parts = _by_heat(e, "mean_stiffness")
    return Finding(
        f"mean stiffness {parts[0]:+.2f} % by the added spring",
        f"{parts[1]:+.2f} % by Young's modulus",
        verdict_of(parts[1] > 0.0),
        "Nothing can be added: heat acts on the tangent stiffness by lowering Young's modulus.",
    )


def _cold_stiffness(e: Evidence) -> Finding:
    mesh = e.bundle("mesh", "thesis", UNDEFORMED).isel(operating=0)
    spring = float(np.abs(mesh["thermal_stiffness"].values).max())
    return Finding(
        f"k_T set to {spring:g} where nothing has grown",
        "no such term",
        Verdict.ASSUMED,
        "Without heat the printed term is infinite; it must be left out by hand.",
    )


def _raises(e: Evidence) -> Finding:
    thesis, right = (
        PERCENT(_row(e, "thermal_stiffness_ratio", b)) for b in ("thesis", "consistent")
    )
    return Finding(
        f"{listed(thesis, '+.2f')} % at {_temperatures(e)}",
        f"{listed(right, '+.2f')} %",
        verdict_of(bool(np.all(right > 0.0))),
        "The printed increase comes from the thermal spring alone, and shrinks as the gears get "
        "hotter. With E(T) of steel the stiffness falls.",
    )


def _fluctuation(e: Evidence) -> Finding:
    change = _by_heat(e, "peak_to_peak_stiffness")
    return Finding(
        f"peak to peak {change[0]:+.2f} %",
        f"peak to peak {change[1]:+.2f} %",
        verdict_of(abs(change[1]) > 0.1),
        "It changes in both, for different reasons: k_T varies over the mesh, E(T) scales all.",
    )


def _average(e: Evidence) -> Finding:
    f = e.fit
    return Finding(
        f"{STIFFNESS(f['middle']):.4g}·10⁸ N/m mid-range on the assumed rig; met exactly with "
        f"{MILLIMETRE(f['width']):.4g} mm of width",
        f"time mean {STIFFNESS(f['mean_at_width']):.4g}·10⁸ N/m of the same curve",
        verdict_of(abs(f["middle"] / chain.PRINTED_MIDDLE - 1.0) < 0.05, assumption=True),
        "Read as the middle between highest and lowest, the textbook curve meets it with a round "
        "width and bores; as a time mean the same curve does not.",
    )


def _amplitude(e: Evidence) -> Finding:
    f = e.fit
    off = f["swing_at_width"] / chain.PRINTED_SWING - 1.0
    half = 0.5 * f["swing_at_width"]
    return Finding(
        f"peak to peak {STIFFNESS(f['swing_at_width']):.4g}·10⁸ N/m at that width "
        f"({PERCENT(off):+.1f} %)",
        f"amplitude {STIFFNESS(half):.4g}·10⁸ N/m, half of it",
        verdict_of(abs(off) < 0.05, assumption=True),
        "It is the peak to peak value. As an amplitude it is impossible: the stiffness would swing "
        f"down to {STIFFNESS(chain.PRINTED_MIDDLE - chain.PRINTED_SWING):.3g}·10⁸ N/m, below one "
        "pair's.",
    )


def _two_gears(e: Evidence) -> Finding:
    found = e.two_gears
    return Finding(
        "two rotations integrated as they stand",
        f"x differs from the single equation's by {found['difference']:.1e} half backlashes; "
        f"momentum constant within {found['momentum']:.1e}",
        verdict_of(found["difference"] < 1e-6 and found["momentum"] < 1e-9),
        "Signs and factors are right: with balanced torques I1ω1/r1 + I2ω2/r2 stays, and the "
        "relative motion is that of one oscillator.",
    )


def _motion_symbols(e: Evidence) -> Finding:
    mass, (i1, i2) = e.case.equivalent_mass, e.case.inertias
    return Finding(
        f"inertias {i1:.4g} and {i2:.4g} kg m², solid discs assumed",
        f"equivalent mass {mass:.4g} kg, damping ratio {e.case.damping_ratio:g} assumed",
        Verdict.ASSUMED,
        "Inertias, damping, torques and backlash are named and not given.",
    )


def _relative(e: Evidence) -> Finding:
    found = e.two_gears
    return Finding(
        "x = r1θ1 - r2θ2 - e",
        f"drives both equations; difference {found['difference']:.1e} half backlashes",
        verdict_of(found["difference"] < 1e-6),
        "With this x the mesh does the power of both gears together.",
    )


def _static_error(e: Evidence) -> Finding:
    mesh = e.bundle("mesh", "consistent", UNDEFORMED).isel(operating=0)
    loaded = MICROMETRE(float(np.ptp(mesh["transmission_error"].values)))
    own = e.case.transmission_error.harmonics
    kinematic = 2e6 * (abs(own[0]) if own else 0.0)
    return Finding(
        f"loaded (static) error of perfect flanks: {loaded:.3g} µm peak to peak",
        f"unloaded error: 0 for perfect flanks; {kinematic:.3g} µm peak to peak assumed",
        Verdict.CONTRADICTED,
        "The static transmission error under load already holds the elastic deflection that k(t) "
        "computes again: elasticity would count twice. The equation needs the unloaded error.",
    )


def _dimensionless(e: Evidence) -> Finding:
    mesh = e.bundle("mesh", "consistent").isel()
    ratio, force = (mesh[n].values for n in ("frequency_ratio", "force_amplitude"))
    rpm = SPEED(mesh["pinion_speed"].values)
    power = np.polyfit(np.log(ratio), np.log(force), 1)[0]
    return Finding(
        "F_h a free constant, B′ and the phases unscaled",
        f"F_h = {listed(force)} at {listed(rpm, '.0f')} rpm: it grows with ω_h to the power "
        f"{power:.3g}",
        verdict_of(abs(power - 2.0) < 1e-6, assumption=True),
        "The form is right for one cosine each of stiffness and error in phase, with lengths over "
        "the cold half backlash; a kinematic error gives F_h = (e/b) ω_h², so ω_h and F_h cannot "
        "be varied apart.",
    )


def _dimensionless_symbols(e: Evidence) -> Finding:
    mesh = e.bundle("mesh", "consistent").isel(operating=-1)
    names = ("damping_ratio", "frequency_ratio", "stiffness_amplitude", "thermal_stiffness_ratio",
             "mean_force", "force_amplitude", "half_backlash_ratio")  # fmt: skip
    symbols = ("ζ", "ω_h", "ε", "ε_T", "F_m", "F_h", "b′/b")
    values = ", ".join(f"{s} {float(mesh[n]):.3g}" for s, n in zip(symbols, names, strict=True))
    first = SPEED(e.case.speeds[-1])
    return Finding(
        "the numbers' values are not given for the rig",
        f"at {first:.0f} rpm: {values}",
        Verdict.ASSUMED,
        "Every one follows from the chain with the assumptions of the case.",
    )


_ROWS = (
    ("3.1.1", "3.1", "statement", "Thermal deformation takes backlash away.", _reduces,
     ("thermogear.mesh.clearance.Clearance", CYCLE), "gap-temperature"),
    ("3.1.2", "3.1, half gap", "formula",
     "The hot half gap is the cold one less half the sum of both deformations.", _half_gap,
     ("thermogear.heat.thesis_profile.thesis_half_backlash",
      "thermogear.heat.expansion.hot_half_backlash"), "gap-phase"),
    ("3.1.3", "3.1, symbols of the half gap", "statement",
     "The deformations are those of the driving and the driven flank.", _half_gap_symbols,
     ("thermogear.heat.expansion.flank_growth",), "growth"),
    ("3.1.4", "3.1, backlash function", "formula",
     "Restoring deflection with a dead zone between -b′ and b′.", _gap_function,
     (f"{MODELS}.dead_zone",), ""),
    ("3.2.1", "3.2", "statement", "Mesh stiffness comes from the potential energy method.",
     _energy_method, (f"{SPRING_MODEL}.mesh_stiffness", "thermogear.gears.loaded.loaded_contact"),
     "stiffness-1"),
    ("3.2.2", "3.2", "statement",
     "It holds contact, bending, shear, axial and body stiffness.", _five_parts,
     (f"{SPRING_MODEL}.pair_compliances",), "stiffness-parts-1"),
    ("3.2.3", "3.2, thermal stiffness", "formula",
     "Heat adds to each gear a stiffness: normal force over deformation times width.",
     _thermal_spring, (f"{THERMAL}.thesis_thermal_stiffness", CYCLE), "stiffness-1"),
    ("3.2.4", "3.2, thermal stiffness of the pair", "formula",
     "The two thermal stiffnesses act in series.", _series,
     (f"{THERMAL}.thesis_thermal_stiffness",), ""),
    ("3.2.5", "3.2, total stiffness", "formula",
     "The thermal stiffness adds to the mesh stiffness.", _sum_of_stiffness,
     (CYCLE, "thermogear.mesh.model.MeshModel"), "stiffness-0"),
    ("3.2.6", "3.2, symbols of the total", "statement",
     "The other summand is the stiffness without heat.", _cold_stiffness, (CYCLE,), ""),
    ("3.2.7", "3.2, results", "statement", "Heat raises the mesh stiffness slightly.", _raises,
     (CYCLE, "thermogear.base.materials.Material"), "stiffness-0"),
    ("3.2.8", "3.2, results", "statement", "Heat changes how far the stiffness swings.",
     _fluctuation, (CYCLE,), "stiffness-0"),
    ("3.2.9", "3.2, results", "figure", "The average mesh stiffness is 4.875·10⁸ N/m.", _average,
     (f"{SPRING_MODEL}.mesh_figures",), "stiffness-1"),
    ("3.2.10", "3.2, results", "figure", "The stiffness fluctuates by 2.75·10⁸ N/m.", _amplitude,
     (f"{SPRING_MODEL}.mesh_figures",), "stiffness-1"),
    ("3.3.1", "3.3", "statement", "Lumped masses give a torsional model of two rotations.",
     _two_gears, (f"{MODELS}.PairModel", "thermogear.dynamics.integrate.simulate"), ""),
    ("3.3.2", "3.3, equations of motion", "formula",
     "Two coupled equations with mesh damping, k(t) f(x) and the torques.", _two_gears,
     (f"{MODELS}.PairModel",), ""),
    ("3.3.3", "3.3, symbols of the equations", "statement",
     "Inertias, base radii, damping, stiffness, backlash function and torques enter.",
     _motion_symbols, ("thermogear.case.case.GearCase",), ""),
    ("3.3.4", "3.3, relative displacement", "formula",
     "Displacement along the line of action, less an error.", _relative,
     (f"{MODELS}.PairModel",), ""),
    ("3.3.5", "3.3, symbol e", "statement", "The error is the static transmission error.",
     _static_error, (CYCLE, EXCITE), ""),
    ("3.3.6", "3.3, dimensionless equation", "formula",
     "One equation with a cosine in stiffness and in force, and a thermal stiffness.",
     _dimensionless, (f"{MODELS}.TorsionalModel", f"{MODELS}.from_excitation"), ""),
    ("3.3.7", "3.3, symbols of the dimensionless equation", "statement",
     "Six dimensionless numbers describe the pair.", _dimensionless_symbols,
     ("thermogear.study.run.run",), ""),
)  # fmt: skip

CLAIMS = tuple(Claim(*row) for row in _ROWS)
