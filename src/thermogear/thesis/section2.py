"""Claims of sections 2.1 and 2.2: flash temperature and friction."""

from __future__ import annotations

import math

import numpy as np

from thermogear.base.display import MICROMETRE, MILLIMETRE, PERCENT
from thermogear.base.vocabulary import REGIMES
from thermogear.gears.contact import hertz_half_width
from thermogear.heat.friction import benedict_kelley, benedict_kelley_as_printed
from thermogear.heat.temperature import FLASH_FACTORS, blok_as_printed, blok_flash
from thermogear.thesis import chain
from thermogear.thesis.claim import Claim, Finding, Verdict, listed, verdict_of
from thermogear.thesis.evidence import Evidence

HEAT, FRICTION = "thermogear.heat.temperature", "thermogear.heat.friction"
CYCLE = "thermogear.mesh.cycle.mesh_cycle"
IN_MILLIMETRES = MILLIMETRE.scale
"""Millimetres in a metre: what a change of the length unit multiplies lengths with."""


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
    a = e.contact_at_a
    units = [_flash_arguments(a), _flash_arguments(a, length=IN_MILLIMETRES)]
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
    spread = PERCENT(u["parabola"] / u["ellipse"] - 1.0)
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
    a = e.contact_at_a
    steel = e.case.pair.pinion.material
    modulus = steel.youngs_modulus / (2.0 * (1.0 - steel.poisson_ratio**2))
    true = float(hertz_half_width(a["load"], a["radius"], modulus))
    one = math.sqrt(
        2.0 * a["load"] * (1.0 - steel.poisson_ratio**2) * a["radius"]
        / (math.pi * steel.youngs_modulus)
    )  # fmt: skip
    eta = (true / one) ** 2
    return Finding(
        f"{MICROMETRE(one) * math.sqrt(eta):.4g} µm at A with η = {eta:.6g}",
        f"{MICROMETRE(true):.4g} µm at A from the reduced modulus",
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
    a = e.contact_at_a
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
    film = " and ".join(sorted({REGIMES[place] for place in here["regime"].values}))
    return Finding(
        f"dry {dry.mean():.3g}; mixed {mixed.min():.3g} to {mixed.max():.3g} along the path",
        f"film parameter {np.nanmin(lam):.2g} to {np.nanmax(lam):.2g}: {film}",
        Verdict.ASSUMED if "mixed" in film else Verdict.UNDECIDED,
        "Both states are computed. A film is mixed at a film parameter from 1 to 3; that of this "
        "pair rests on the oil and roughness assumed.",
    )


def _mixed_formula(e: Evidence) -> Finding:
    a = e.contact_at_a
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
    a = e.contact_at_a
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
    a = e.contact_at_a
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


_ROWS = [
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
]  # fmt: skip
CLAIMS = tuple(Claim(*row) for row in _ROWS)
