"""Claims of section 2.3: thermal deformation, and what rises with speed and torque."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial
from itertools import product
from typing import Any

import numpy as np

from thermogear.base.display import CELSIUS, MICROMETRE, NANOMETRE
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

HEAT, GRID = "thermogear.heat.temperature", "thermogear.thesis.chain.operating_grid"
CYCLE, BALANCE = "thermogear.mesh.cycle.mesh_cycle", "thermogear.mesh.balance.heat_balance"
PROFILE, GROWTH = "thermogear.heat.thesis_profile", "thermogear.heat.expansion.flank_growth"


def _expands(e: Evidence) -> Finding:
    radial, across = chain.tip_displacement(e.case, e.case.gear_temperatures[0])
    return Finding(
        f"radial {MICROMETRE(radial):.3g} µm, half tooth {MICROMETRE(across):.3g} µm at the "
        "pinion's tip",
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
    a = e.contact_at_a
    depth = math.sqrt(diffusivity * 2.0 * a["width"] / min(a["v1"], a["v2"]))
    bulge = steel.thermal_expansion * flash * depth
    grown = float(path["deformation_sum"].mean())
    return Finding(
        f"flash {flash:.3g} K is about {MICROMETRE(depth):.2g} µm deep and lifts "
        f"{NANOMETRE(bulge):.2g} nm",
        f"the body is {rise:.3g} K warmer and its flanks grow {MICROMETRE(grown):.3g} µm",
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
    balance = CELSIUS(e.grid.sel(thermal="balance")["gear_temperature"].values)
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
        f"{MICROMETRE(printed[0]):.4g} to {MICROMETRE(printed[-1]):.4g} µm from form circle to tip",
        f"{MICROMETRE(right[0]):.4g} to {MICROMETRE(right[-1]):.4g} µm",
        verdict_of(worst < 0.01 * float(right.max()), assumption=True),
        f"Right within {MICROMETRE(worst):.1e} µm if u_b, which is not defined, is the "
        "displacement of "
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
    u = [MICROMETRE(float(mesh[f"{g}_base_growth"])) for g in ("pinion", "wheel")]
    reference = CELSIUS(e.case.operating.temperatures.reference)
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
    printed, at_radius = (
        MICROMETRE(float(np.ravel(flank_growth_as_printed(gear, field, r, thickness_at=at))[0]))
        for at in (None, r)
    )
    thesis = float(np.ravel(thesis_flank_growth(gear, field, r))[0])
    right = MICROMETRE(
        float(e.bundle("path", "consistent")["pinion_deformation"].isel(operating=0).values[-1])
    )
    return Finding(
        f"{printed:.4g} µm literally with the tooth thickness at the pitch circle, "
        f"{at_radius:.3g} µm with that at r_k; {MICROMETRE(thesis):.3g} µm with the first "
        "term as a "
        "length",
        f"{right:.3g} µm normal growth of one flank at the pinion's tip",
        verdict_of(abs(MICROMETRE(thesis) / right - 1.0) < 0.1),
        "The first term is a pure number, the second a stretch along the flank and not normal to "
        f"it, and the body's growth u_b is missing: repaired as far as it goes it still gives "
        f"{right / (MICROMETRE(thesis)):.2g} times too little.",
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
    said = (
        words["given"]
        if quantity == "growth"
        else f"mixed {words['given']}" + (f", dry {dry}" if dry else "")
    )
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


_ROWS: list[tuple[Any, ...]] = [
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
    *(
        (f"2.3.{number}", "2.3, results", "statement", f"The {WORDS[quantity]} rises with {along}.",
         partial(trend, quantity=quantity, along=along), (GRID, BALANCE), f"grid-{quantity}")
        for number, (quantity, along) in enumerate(product(WORDS, ("speed", "torque")), 10)
    ),
    ("2.3.16", "2.3, results", "statement",
     "Friction, flash and deformation are positively and most strongly correlated.", _correlated,
     ("thermogear.thesis.chain.correlations", BALANCE), "grid-growth"),
]  # fmt: skip
CLAIMS = tuple(Claim(*row) for row in _ROWS)
