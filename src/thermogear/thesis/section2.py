"""Claims of section 2: flash temperature, friction, thermal deformation."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from thermogear.base.units import ZERO_CELSIUS
from thermogear.gears.contact import hertz_half_width
from thermogear.heat.friction import benedict_kelley, benedict_kelley_as_printed
from thermogear.heat.temperature import FLASH_FACTORS, blok_as_printed, blok_flash
from thermogear.heat.thesis_profile import (
    deformed_profile,
    flank_growth_as_printed,
    profile_as_printed,
    thesis_flank_growth,
)
from thermogear.mesh.thermal import HotPair
from thermogear.thesis import chain
from thermogear.thesis.claim import Claim, Finding, Verdict, listed, rising, verdict_of
from thermogear.thesis.evidence import Evidence

HEAT, FRICTION = "thermogear.heat.temperature", "thermogear.heat.friction"
CYCLE, GRID = "thermogear.mesh.cycle.mesh_cycle", "thermogear.thesis.chain.operating_grid"
PROFILE, GROWTH = "thermogear.heat.thesis_profile", "thermogear.heat.expansion.flank_growth"
BALANCE = "thermogear.mesh.balance.heat_balance"
MM = 1e3
"""Millimetres in a metre: what a change of the length unit multiplies lengths with."""


def contact_at_a(e: Evidence) -> dict[str, float]:
    """The contact at A, first operating point, hot, consistent bundle, oil as supplied (SI)."""
    here = e.bundle("path", "consistent").isel(operating=0, path_position=0)
    supplied = e.bundle("mesh", "thesis").isel(operating=0)
    shared = e.groups["path"].isel(operating=0, path_position=0)
    pair = e.case.pair
    return {
        "load": float(here["line_load"]),
        "v1": float(shared["pinion_rolling_velocity"]),
        "v2": float(shared["wheel_rolling_velocity"]),
        "width": float(here["hertz_half_width"]),
        "friction": float(here["friction_coefficient_mixed"]),
        "viscosity": float(supplied["dynamic_viscosity"]),
        "roughness": 0.5 * (pair.pinion.roughness + pair.wheel.roughness),
        "b1": pair.pinion.material.thermal_contact_coefficient,
        "b2": pair.wheel.material.thermal_contact_coefficient,
        "radius": float(shared["reduced_radius"]),
    }


def _flash_arguments(a: dict[str, float], length: float = 1.0) -> dict[str, float]:
    """The contact as the flash formulas take it; ``length``: units of length in a metre."""
    return {
        "friction": a["friction"],
        "line_load": a["load"],
        "speed_1": length * a["v1"],
        "speed_2": length * a["v2"],
        "half_width": length * a["width"],
        "contact_coefficient_1": a["b1"],
        "contact_coefficient_2": a["b2"],
    }


def _flash_formula(e: Evidence) -> Finding:
    a = contact_at_a(e)
    units = [_flash_arguments(a), _flash_arguments(a, length=MM)]
    printed = [abs(float(blok_as_printed(**given))) for given in units]
    u = FLASH_FACTORS["parabola"]
    right = [float(blok_flash(**given, factor=u)) for given in units]
    changed = printed[1] / printed[0]
    return Finding(
        f"{printed[0]:.3g} in SI at A; {changed:.4g} times that with lengths in mm",
        f"{right[0]:.3g} K at A in metres and in mm alike (ratio {right[1] / right[0]:.6g})",
        verdict_of(abs(changed - 1.0) < 1e-9),
        "A temperature cannot depend on the unit of length. The half width's root belongs below "
        "the line and the root of π does not belong; with both mended it is Blok's formula.",
    )


def _flash_symbols(e: Evidence) -> Finding:
    u = FLASH_FACTORS
    spread = 100.0 * (u["parabola"] / u["ellipse"] - 1.0)
    names = ", ".join(f"{name} {value:.5f}" for name, value in u.items())
    return Finding(
        f"u = {u['parabola']:.4f} with the root of the half width (heat as a parabola)",
        f"u = {u['ellipse']:.5f} (heat as the Hertzian pressure)",
        Verdict.ASSUMED,
        f"u is not given. Beside the root of the half width it is {names}; the customary 1.11 "
        f"goes with the whole width. The choice moves the flash by {spread:.1f} %. The "
        "conductivities and densities are steel's; the load per width is that of the one pair.",
    )


def _speeds(e: Evidence) -> Finding:
    first, second = chain.rolling_by_radius(e.case)
    return Finding(
        f"differs from ωρ by {first:.1e} (pinion) and {second:.1e} (wheel) along the path",
        "ωρ with the curvature radius ρ",
        verdict_of(max(first, second) < 1e-9),
        "Radius times the sine of the pressure angle is the curvature radius of the involute.",
    )


def _speed_symbols(e: Evidence) -> Finding:
    data = e.groups["path"].isel(operating=0)
    ends = [data[f"{g}_rolling_velocity"].values[[0, -1]] for g in ("pinion", "wheel")]
    slide = data["sliding_velocity"].values
    return Finding(
        f"pinion {listed(ends[0])} m/s, wheel {listed(ends[1])} m/s at A, E (slowest speed)",
        f"sliding {listed(slide[[0, -1]])} m/s at A, E, zero between",
        Verdict.REPRODUCED,
        "The quantities are the usual ones; with them the sliding speed vanishes once, at the "
        "pitch point.",
    )


def _half_width(e: Evidence) -> Finding:
    a = contact_at_a(e)
    steel = e.case.pair.pinion.material
    modulus = steel.youngs_modulus / (2.0 * (1.0 - steel.poisson_ratio**2))
    true = float(hertz_half_width(a["load"], a["radius"], modulus))
    one = math.sqrt(
        2.0 * a["load"] * (1.0 - steel.poisson_ratio**2) * a["radius"]
        / (math.pi * steel.youngs_modulus)
    )  # fmt: skip
    eta = (true / one) ** 2
    return Finding(
        f"{1e6 * one * math.sqrt(eta):.4g} µm at A with η = {eta:.6g}",
        f"{1e6 * true:.4g} µm at A from the reduced modulus",
        Verdict.ASSUMED,
        f"The formula is Hertz's for equal materials if η = {eta:.4g}, which is not given, and if "
        "the force is that of the one tooth pair and not of the whole mesh.",
    )


def _half_width_symbols(e: Evidence) -> Finding:
    share = e.bundle("path", "consistent")["load_share"].isel(operating=0).values
    equal = e.bundle("path", "thesis")["load_share"].isel(operating=0).values
    return Finding(
        f"share of the force on one pair {equal.min():.2g} to {equal.max():.2g} (equal parts)",
        f"{share.min():.3g} to {share.max():.3g} from the loaded contact",
        Verdict.ASSUMED,
        "How two pairs share the normal force is not said; the half width goes with its root.",
    )


def _friction_matters(e: Evidence) -> Finding:
    a = contact_at_a(e)
    given = _flash_arguments(a)
    twice = given | {"friction": 2.0 * a["friction"]}
    ratio = float(blok_flash(**twice)) / float(blok_flash(**given))
    return Finding(
        f"doubled friction gives {ratio:.6g} times the flash",
        "the same",
        verdict_of(abs(ratio - 2.0) < 1e-9),
        "Flash temperature is proportional to the coefficient of friction.",
    )


def _two_states(e: Evidence) -> Finding:
    here = e.bundle("path", "consistent").isel(operating=0)
    mixed, dry = (here[f"friction_coefficient_{k}"].values for k in ("mixed", "dry"))
    lam = here["film_parameter"].values
    return Finding(
        f"dry {dry.mean():.3g}; mixed {mixed.min():.3g} to {mixed.max():.3g} along the path",
        f"film parameter {np.nanmin(lam):.2g} to {np.nanmax(lam):.2g}: mixed or boundary film",
        Verdict.REPRODUCED,
        "Both states are computed; the film parameter says that a mixed state is the likely one "
        "with the oil and roughness assumed.",
    )


def _mixed_formula(e: Evidence) -> Finding:
    a = contact_at_a(e)
    slide, total = a["v1"] - a["v2"], a["v1"] + a["v2"]

    def both(viscosity: float) -> tuple[float, float]:
        printed = benedict_kelley_as_printed(
            a["load"],
            sliding_speed=slide,
            entrainment_speed=0.5 * total,
            viscosity=viscosity,
            roughness=a["roughness"],
        )
        right = benedict_kelley(
            a["load"],
            sliding_speed=slide,
            sum_speed=total,
            viscosity=viscosity,
            roughness=a["roughness"],
        )
        return abs(float(printed)), float(right)

    (p0, r0), (p1, r1) = both(a["viscosity"]), both(2.0 * a["viscosity"])
    return Finding(
        f"{p0:.3g} in SI at A, {p1:.3g} with twice the viscosity",
        f"Benedict and Kelley {r0:.3g} at A, {r1:.3g} with twice the viscosity",
        verdict_of(p0 < 0.2 and (p1 < p0) == (r1 < r0)),
        "Power and logarithm are taken of quantities with units, and the printed coefficient rises "
        "with viscosity while measured friction falls. The numbers in it are Benedict and "
        "Kelley's, in the wrong places.",
    )


def _mixed_symbols(e: Evidence) -> Finding:
    a = contact_at_a(e)
    slide, mean = a["v1"] - a["v2"], 0.5 * (a["v1"] + a["v2"])
    speeds = {"sliding_speed": slide, "entrainment_speed": mean}
    si, custom = (
        abs(
            float(
                benedict_kelley_as_printed(
                    load * a["load"],
                    viscosity=viscosity * a["viscosity"],
                    roughness=roughness * a["roughness"],
                    **speeds,
                )
            )
        )
        for load, viscosity, roughness in ((1.0, 1.0, 1.0), (1e-3, 1e3, 1e6))
    )
    return Finding(
        f"{si:.3g} in SI; {custom:.3g} in N/mm, mPa s, µm",
        "the repaired law states its units",
        Verdict.UNDECIDED,
        "No units are given for viscosity, roughness and load, and the formula needs them: the "
        "same contact gives different coefficients.",
    )


def _dry_range(e: Evidence) -> Finding:
    a = contact_at_a(e)
    given = _flash_arguments(a)
    flash = [float(blok_flash(**given | {"friction": mu})) for mu in (0.1, 0.5)]
    own = e.case.models[0].dry_coefficient
    return Finding(
        f"flash {listed(flash)} K at A for 0.1 and 0.5",
        f"{own:g} taken here",
        Verdict.ASSUMED,
        "The range is assumed, not computed; it spans a factor of five in every dry flash "
        f"temperature. {own:g} is ours.",
    )


def _curves(e: Evidence) -> Finding:
    ours = len(e.case.assumptions)
    return Finding(
        "curves of friction for both states drawn",
        f"{ours} values of the case are ours and said so",
        Verdict.UNDECIDED,
        "The parameters announced are not listed: width, oil, roughness, torque and sharing are "
        "missing, so the printed curves cannot be recomputed, only curves like them.",
    )


def _expands(e: Evidence) -> Finding:
    radial, across = chain.tip_displacement(e.case, e.case.gear_temperatures[0])
    return Finding(
        f"radial {1e6 * radial:.3g} µm, half tooth {1e6 * across:.3g} µm at the pinion's tip",
        "the same, at the lowest temperature of the row",
        verdict_of(radial > 0.0 and across > 0.0),
        "Both are positive; the body's radial displacement is much the larger.",
    )


def _surface_drives(e: Evidence) -> Finding:
    path = e.bundle("path", "consistent").isel(operating=0)
    flash = float(path["flash_temperature_mixed"].max())
    rise = float(path["pinion_body_temperature"].mean()) - e.case.operating.temperatures.reference
    steel = e.case.pair.pinion.material
    diffusivity = steel.thermal_conductivity / (steel.density * steel.specific_heat)
    a = contact_at_a(e)
    depth = math.sqrt(diffusivity * 2.0 * a["width"] / min(a["v1"], a["v2"]))
    bulge = steel.thermal_expansion * flash * depth
    grown = float(path["deformation_sum"].mean())
    return Finding(
        f"flash {flash:.3g} K is about {1e6 * depth:.2g} µm deep and lifts {1e9 * bulge:.2g} nm",
        f"the body is {rise:.3g} K warmer and its flanks grow {1e6 * grown:.3g} µm",
        verdict_of(bulge > 0.1 * grown),
        "It is the body's temperature, not the surface's flash, that deforms the profile; the "
        "flash enters no formula of the deformation, printed or repaired.",
    )


def _field(e: Evidence) -> Finding:
    uneven = chain.conduction_balance(e.case)
    mesh = e.bundle("mesh", "consistent").isel(operating=0)
    heat = [float(mesh[f"{g}_shaft_heat"]) for g in ("pinion", "wheel")]
    loss = float(mesh["frictional_power"])
    return Finding(
        f"radial heat flow constant within {uneven:.1e}",
        f"carries {listed(heat)} W into the shafts; the mesh makes {loss:.3g} W at this point",
        verdict_of(uneven < 1e-6, assumption=True),
        "It is the steady field of a disc that loses no heat from its faces. The temperatures at "
        "both ends are given, not computed, and with those assumed here more heat flows than the "
        "slowest operating point produces.",
    )


def _field_symbols(e: Evidence) -> Finding:
    t = e.case.operating.temperatures
    drop = float(np.ravel(t.pinion_addendum)[0]) - float(np.ravel(t.pinion_bore)[0])
    balance = e.grid.sel(thermal="balance")["gear_temperature"].values - ZERO_CELSIUS
    return Finding(
        f"bore {drop:.3g} K below the addendum, assumed",
        f"heat balance over speed and torque: {balance.min():.3g} to {balance.max():.3g} °C",
        Verdict.ASSUMED,
        "Where the two temperatures come from is not said. Given them the field follows; the "
        "heat balance of losses and cooling gives them too.",
    )


def _radial(e: Evidence) -> Finding:
    gear = e.case.pair.pinion
    field = HotPair(e.case.pair, e.case.operating, e.textbook).field(gear)
    r = np.linspace(max(gear.form_radius, gear.base_radius), gear.tip_radius, 61)
    printed = np.atleast_2d(profile_as_printed(gear, field, r)[0])[0] - r
    right = np.atleast_2d(deformed_profile(gear, field, r)[0])[0] - r
    worst = float(np.max(np.abs(printed - right)))
    return Finding(
        f"{1e6 * printed[0]:.4g} to {1e6 * printed[-1]:.4g} µm from form circle to tip",
        f"{1e6 * right[0]:.4g} to {1e6 * right[-1]:.4g} µm",
        verdict_of(worst < 0.01 * float(right.max()), assumption=True),
        f"Right within {1e6 * worst:.1e} µm if u_b, which is not defined, is the displacement of "
        "the base circle by body and tooth root.",
    )


def _angle(e: Evidence) -> Finding:
    gear = e.case.pair.pinion
    r = np.array([gear.tip_radius])
    psi = float(gear.half_thickness_angle(gear.tip_radius))
    operating = e.case.operating
    turns = []
    for one in (replace(operating, temperatures=operating.temperatures.cold()), operating):
        field = HotPair(e.case.pair, one, e.textbook).field(gear)
        turns.append(
            [
                float(np.ravel(profile(gear, field, r)[1])[0]) - psi
                for profile in (profile_as_printed, deformed_profile)
            ]
        )
    (cold, none), (hot, right) = turns
    return Finding(
        f"{cold:.2e} rad at the pinion's tip cold and {hot:.2e} rad hot",
        f"{none:.2e} rad cold and {right:.2e} rad hot",
        verdict_of(abs(cold) < 1e-3 * abs(right)),
        "The printed turn of the flank holds no temperature and no tooth thickness (its unit is "
        "1/K): a cold tooth turns as much as a hot one.",
    )


def _base_growth(e: Evidence) -> Finding:
    mesh = e.bundle("mesh", "consistent").isel(operating=0)
    u = [1e6 * float(mesh[f"{g}_base_growth"]) for g in ("pinion", "wheel")]
    reference = e.case.operating.temperatures.reference - ZERO_CELSIUS
    return Finding(
        "u_b is named and not defined",
        f"{listed(u)} µm for pinion and wheel, from {reference:.3g} °C, free bores",
        Verdict.ASSUMED,
        "Read as the radial displacement of the base circle of a disc with a free bore; clamped "
        "bores give less.",
    )


def _deformation(e: Evidence) -> Finding:
    gear = e.case.pair.pinion
    hot = HotPair(e.case.pair, e.case.operating, e.textbook)
    r = np.array([gear.tip_radius])
    field = hot.field(gear)
    printed = float(np.ravel(flank_growth_as_printed(gear, field, r))[0])
    thesis = float(np.ravel(thesis_flank_growth(gear, field, r))[0])
    right = 1e6 * float(
        e.bundle("path", "consistent")["pinion_deformation"].isel(operating=0).values[-1]
    )
    return Finding(
        f"{1e6 * printed:.4g} µm literally, {1e6 * thesis:.3g} µm with the first term as a length",
        f"{right:.3g} µm normal growth of one flank at the pinion's tip",
        verdict_of(abs(1e6 * thesis / right - 1.0) < 0.1),
        "The first term is a pure number, the second a stretch along the flank and not normal to "
        f"it, and the body's growth u_b is missing: repaired as far as it goes it still gives "
        f"{right / (1e6 * thesis):.2g} times too little.",
    )


def _simulated(e: Evidence) -> Finding:
    g = e.grid
    points = g.sizes["speed"] * g.sizes["torque"]
    settled = int(g["settled"].sum())
    return Finding(
        f"{points} operating points with given temperatures",
        f"the same {points} with the closed heat balance, {settled} settled",
        Verdict.REPRODUCED,
        "Which conditions the document used is not said; ours run over "
        f"{chain.SPEEDS[0]:.0f} to {chain.SPEEDS[1]:.0f} rpm and {chain.TORQUES[0]:.0f} to "
        f"{chain.TORQUES[1]:.0f} N m.",
    )


WORDS = {"friction": "friction coefficient", "flash": "flash temperature", "growth": "growth"}


def trend(e: Evidence, quantity: str, along: str) -> Finding:
    """How a quantity goes with speed or torque: at given temperatures and in the closed loop."""
    name = quantity if quantity == "growth" else f"{quantity}_mixed"
    words = {}
    for thermal in ("given", "balance"):
        table = e.grid[name].sel(thermal=thermal)
        words[thermal] = rising(table.transpose(..., along).values)
    dry = "" if quantity == "growth" else rising(
        e.grid[f"{quantity}_dry"].sel(thermal="given").transpose(..., along).values
    )  # fmt: skip
    both = set(words.values())
    if both == {"rises"}:
        verdict = Verdict.REPRODUCED
    elif "rises" in both:
        verdict = Verdict.ASSUMED
    else:
        verdict = Verdict.CONTRADICTED
    said = f"mixed {words['given']}" + (f", dry {dry}" if dry else "")
    if quantity == "growth":
        said = words["given"]
    reasons = {
        "rises": "It does so with given and with computed temperatures.",
        "friction-speed": "Mixed friction falls as the film grows with speed; dry friction is a "
        "constant. In the closed loop the oil also thins, which works against it.",
        "flash-speed": "More sliding speed and less friction work against each other.",
        "growth": "Given temperatures do not know of the load; once the heat balance computes "
        "them, more loss means warmer gears.",
    }
    key = "rises" if both == {"rises"} else f"{quantity}-{along}"
    reason = reasons.get(key) or reasons.get(quantity) or ""
    return Finding(
        f"with {along}, temperatures given: {said}",
        f"with {along}, heat balance: {words['balance']}",
        verdict,
        reason,
    )


def _correlated(e: Evidence) -> Finding:
    def said(found: dict[str, float]) -> str:
        return ", ".join(
            f"{name} " + ("undefined" if math.isnan(v) else f"{v:+.2f}")
            for name, v in found.items()
        )

    given, balance = (chain.correlations(e.grid, t) for t in ("given", "balance"))
    least = min(-1.0 if math.isnan(v) else v for v in balance.values())
    return Finding(
        f"temperatures given: {said(given)}",
        f"heat balance: {said(balance)}",
        verdict_of(least > 0.7),
        "Strong and positive would be near +1 for every couple. With given temperatures the "
        "growth is a constant and correlates with nothing; closing the loop couples flash and "
        "growth through the losses, while friction and growth go apart over speed.",
    )


def _claims() -> tuple[Claim, ...]:
    rows = [
        ("2.1.1", "2.1, flash formula", "formula",
         "Flash temperature of a tooth contact from friction, load, sliding, conductivities and "
         "the contact band, after Blok.", _flash_formula,
         (f"{HEAT}.blok_as_printed", f"{HEAT}.blok_flash"), "flash-mixed"),
        ("2.1.2", "2.1, symbols of the flash formula", "statement",
         "The formula's factor u and its other quantities are named.", _flash_symbols,
         (f"{HEAT}.FLASH_FACTORS", "thermogear.heat.moving_source.peclet_factor"), ""),
        ("2.1.3", "2.1, flank speeds", "formula",
         "Each flank's speed is angular velocity times radius times sine of the pressure angle.",
         _speeds, ("thermogear.gears.contact.rolling_velocities",), "speeds"),
        ("2.1.4", "2.1, symbols of the speeds", "statement",
         "The speeds follow from the gears' geometry at the mesh point.", _speed_symbols,
         ("thermogear.gears.contact.sliding_velocity",), "speeds"),
        ("2.1.5", "2.1, contact half width", "formula",
         "Half width of the contact band after Hertz, with a coefficient η.", _half_width,
         ("thermogear.gears.contact.hertz_half_width",), "hertz"),
        ("2.1.6", "2.1, symbols of the half width", "statement",
         "The half width takes the normal force, the width and both curvature radii.",
         _half_width_symbols,
         ("thermogear.gears.sharing.equal_share", "thermogear.gears.loaded.loaded_contact"),
         "share"),
        ("2.2.1", "2.2", "statement", "Friction is decisive for the flash temperature.",
         _friction_matters, (f"{HEAT}.blok_flash",), "flash-dry"),
        ("2.2.2", "2.2", "statement", "Two states are looked at, dry and mixed.", _two_states,
         (f"{FRICTION}.LAWS", "thermogear.heat.film.film_parameter"), "friction"),
        ("2.2.3", "2.2, mixed friction", "formula",
         "Friction in mixed lubrication as a power of viscosity times load over roughness, times a "
         "logarithm.", _mixed_formula,
         (f"{FRICTION}.benedict_kelley_as_printed", f"{FRICTION}.benedict_kelley"), "friction"),
        ("2.2.4", "2.2, symbols of mixed friction", "statement",
         "Viscosity, roughness, load, entrainment and sliding speeds enter.", _mixed_symbols,
         (f"{FRICTION}.benedict_kelley_as_printed",), ""),
        ("2.2.5", "2.2", "figure", "Dry friction lies between 0.1 and 0.5.", _dry_range,
         (f"{FRICTION}.constant_dry", f"{HEAT}.blok_flash"), "flash-dry"),
        ("2.2.6", "2.2", "statement",
         "Curves of both states were computed for a pair whose parameters follow.", _curves,
         (CYCLE, "thermogear.case.case.load_example"), "friction"),
        ("2.3.1", "2.3", "statement", "Hot teeth expand radially and in circumference.", _expands,
         ("thermogear.heat.expansion.radial_displacement",), "profile-0"),
        ("2.3.2", "2.3", "statement", "The rise of the surface temperature is what expands them.",
         _surface_drives, (CYCLE, GROWTH), "temperatures"),
        ("2.3.3", "2.3, temperature field", "formula",
         "The body's temperature runs with the logarithm of the radius from shaft to addendum.",
         _field, (f"{HEAT}.radial_temperature", f"{HEAT}.conduction_power"), "temperatures"),
        ("2.3.4", "2.3, symbols of the field", "statement",
         "Shaft and addendum temperatures fix the field.", _field_symbols, (BALANCE,), ""),
        ("2.3.5", "2.3, deformed profile, radius", "formula",
         "A point of the flank moves outwards by the stretch above the base circle and u_b.",
         _radial,
         (f"{PROFILE}.profile_as_printed", f"{PROFILE}.deformed_profile"), "profile-0"),
        ("2.3.6", "2.3, deformed profile, angle", "formula",
         "The flank turns by a term of involute functions and the distance from the pitch circle.",
         _angle, (f"{PROFILE}.profile_as_printed", f"{PROFILE}.deformed_profile"), "profile-1"),
        ("2.3.7", "2.3, symbols of the profile", "statement",
         "Expansion coefficient, base circle deformation and initial temperature enter.",
         _base_growth, ("thermogear.heat.expansion.base_circle_growth",), ""),
        ("2.3.8", "2.3, deformation Δf", "formula",
         "Deformation of the flank: a tooth-thickness term and a stretch over the cosine.",
         _deformation,
         (f"{PROFILE}.flank_growth_as_printed", f"{PROFILE}.thesis_flank_growth", GROWTH),
         "growth"),
        ("2.3.9", "2.3", "statement", "Several operating conditions were simulated.", _simulated,
         (GRID, BALANCE), "grid-friction"),
    ]  # fmt: skip
    found = [Claim(*row) for row in rows]
    number = 10
    for quantity in ("friction", "flash", "growth"):
        for along in ("speed", "torque"):
            found.append(
                Claim(
                    f"2.3.{number}", "2.3, results", "statement",
                    f"The {WORDS[quantity]} rises with {along}.",
                    lambda e, q=quantity, a=along: trend(e, q, a),  # type: ignore[misc]
                    (GRID, BALANCE), f"grid-{quantity}",
                )
            )  # fmt: skip
            number += 1
    found.append(
        Claim(
            "2.3.16", "2.3, results", "statement",
            "Friction, flash and deformation are positively and most strongly correlated.",
            _correlated, ("thermogear.thesis.chain.correlations", BALANCE), "grid-growth",
        )
    )  # fmt: skip
    return tuple(found)


CLAIMS = _claims()
