"""What the thesis prints wrongly, with the value as printed beside the repaired one.

The values are those of the case's own pair at its first operating point, at the start of
contact A (friction, flash) or at the tips (deformation). Printed formulas feed nothing.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from thermogear.base.arrays import Dataset
from thermogear.base.display import GRAVITY, MICROMETRE, PERCENT
from thermogear.case.base import Case
from thermogear.case.case import GearCase
from thermogear.case.thesis_cases import of_the_thesis
from thermogear.heat.expansion import flank_growth
from thermogear.heat.friction import benedict_kelley_as_printed
from thermogear.heat.temperature import blok_as_printed
from thermogear.heat.thesis_profile import flank_growth_as_printed
from thermogear.mesh.model import MeshModel
from thermogear.mesh.thermal import HotPair
from thermogear.results.result import Result

Row = dict[str, Any]


def _row(
    number: int,
    printed: str,
    problem: str,
    as_printed: float | None = None,
    repaired: float | None = None,
    unit: str = "",
) -> Row:
    def finite(value: float | None) -> float | None:
        return None if value is None or not math.isfinite(value) else float(value)

    return {
        "number": number,
        "printed": printed,
        "problem": problem,
        "value_as_printed": finite(as_printed),
        "value_repaired": finite(repaired),
        "unit": unit,
    }


def with_errata(result: Result, case: Case) -> Result:
    """What ``run(case)`` returned, with the errata beside it where the case is the thesis's own."""
    if isinstance(case, GearCase) and of_the_thesis(case):
        return result.with_(errata=errata(case, result.groups))
    return result


def errata(case: GearCase, groups: Mapping[str, Dataset]) -> list[Row]:
    """The twenty rows, with numbers where the formula can be evaluated at all."""
    mesh, bundle = groups["mesh"], -1
    path = groups["path"].isel(bundle=bundle, state=-1, operating=0, path_position=0)
    figures = mesh.isel(bundle=bundle, state=-1, operating=0)
    oil = float(path["dynamic_viscosity"]) if "dynamic_viscosity" in path else math.nan
    if not math.isfinite(oil):
        oil = float(figures["dynamic_viscosity"])
    pair = case.pair
    v1, v2 = float(path["pinion_rolling_velocity"]), float(path["wheel_rolling_velocity"])
    load, width = float(path["line_load"]), float(path["hertz_half_width"])
    friction = float(path["friction_coefficient_mixed"])
    rough = 0.5 * (pair.pinion.roughness + pair.wheel.roughness)
    printed_friction = float(
        np.abs(
            benedict_kelley_as_printed(
                load,
                sliding_speed=v1 - v2,
                entrainment_speed=0.5 * (v1 + v2),
                viscosity=oil,
                roughness=rough,
            )
        )
    )
    printed_flash = abs(
        float(
            blok_as_printed(
                friction,
                load,
                speed_1=v1,
                speed_2=v2,
                half_width=width,
                contact_coefficient_1=pair.pinion.material.thermal_contact_coefficient,
                contact_coefficient_2=pair.wheel.material.thermal_contact_coefficient,
            )
        )
    )
    hot = HotPair(pair, case.operating, MeshModel.consistent())
    tip = pair.pinion.tip_radius
    field = hot.field(pair.pinion)
    printed_growth = float(flank_growth_as_printed(pair.pinion, field, tip).ravel()[0])
    at_radius = float(flank_growth_as_printed(pair.pinion, field, tip, thickness_at=tip).ravel()[0])
    growth = float(flank_growth(pair.pinion, field, tip).ravel()[0])
    force = float(figures["normal_force"])
    grown = float(
        groups["path"]["pinion_deformation"].isel(
            bundle=bundle, state=-1, operating=0, path_position=-1
        )
    )
    printed_spring = force / (grown * pair.face_width) if grown > 0 else math.nan
    ratio = float(figures["frequency_ratio"])
    error = abs(case.transmission_error.harmonics[0]) if case.transmission_error.harmonics else 0.0
    lengths = error / float(figures["cold_half_backlash"])
    peak = mesh["peak_to_peak_stiffness"].isel(bundle=bundle, state=0, operating=0)
    return [
        _row(
            1,
            "flash temperature with the root of the half width above the line",
            "sqrt(B) belongs below, and the root of pi does not belong at all: "
            "the printed value carries K m",
            printed_flash,
            float(path["flash_temperature_mixed"]),
            "K",
        ),
        _row(2, "sliding speed v1 - v2 in the flash temperature", "its magnitude is meant"),
        _row(3, "coefficient eta of the contact half width", "left open; 4 for equal materials"),
        _row(
            4,
            "mixed friction coefficient",
            "a scrambled Benedict-Kelley formula: power and logarithm take arguments with units, "
            "and it rises with viscosity",
            printed_friction,
            friction,
            "1",
        ),
        _row(5, "deformed angle theta'", "lacks temperature and tooth thickness (unit 1/K)"),
        _row(
            6,
            "deformation Delta f at the pinion's tip",
            "adds a pure number to a stretch along the flank and leaves out u_b; with the tooth "
            f"thickness at r_k, as its symbol says, it would be {MICROMETRE(at_radius):.3g} um",
            MICROMETRE(printed_growth),
            MICROMETRE(growth),
            "um",
        ),
        _row(
            7,
            "base circle growth u_b",
            "never defined; the radial displacement of the annulus and tooth at the base circle",
            None,
            MICROMETRE(float(figures["pinion_base_growth"])),
            "um",
        ),
        _row(
            8,
            "hot half backlash",
            "both flanks of both gears grow (factor 2), and the housing moves the axes apart",
            _backlash(mesh, "thesis"),
            _backlash(mesh, "consistent"),
            "um",
        ),
        _row(
            9,
            "thermal stiffness k_T1 = F_n/(Delta f b)",
            "its unit is N/m^2, it tends to infinity as the gear gets cold and falls as it heats: "
            "thermal strain is an offset, not a spring",
            printed_spring,
            0.0,
            "N/m^2 | N/m",
        ),
        _row(
            10,
            "fluctuation amplitude of the stiffness",
            "the printed 2.75e8 N/m is peak to peak; as an amplitude it is impossible",
            2.75e8,
            float(peak),
            "N/m",
        ),
        _row(
            11,
            "alternating excitation F_h as a free constant",
            "F_h = (e_a/b) omega_h^2 grows with the frequency squared; scaling of B' and the "
            "phases are missing",
            None,
            lengths * ratio**2,
            "1",
        ),
        _row(
            12,
            "error table: 2000 rpm without heat",
            "the table's own entries give 21.27 to 21.73 %, however they were rounded",
            18.5,
            PERCENT((19.3 - 15.15) / 19.3),
            "%",
        ),
        _row(
            13,
            "simulated main frequencies 413/411, 826/823, 1248/1245 Hz",
            "a model forced at the mesh frequency has its lines there or at simple fractions",
            413.0,
            float(figures["mesh_frequency"]),
            "Hz",
        ),
        _row(
            14,
            "quasi-periodic motion",
            "impossible in the single equation: phase volume shrinks everywhere, so no torus "
            "exists",
        ),
        _row(15, "a growing half-frequency line read as quasi-periodic", "it is period doubling"),
        _row(
            16,
            "measured displacement 10.4 um at 1000 rpm",
            "implies this acceleration of a housing, and a twice integrated housing signal is "
            "not x",
            GRAVITY((2.0 * math.pi * 419.7) ** 2 * 10.4e-6),
            None,
            "g",
        ),
        _row(
            17,
            "flash temperature correlated with the deformation",
            "it never enters the radial field that the deformation comes from",
        ),
        _row(
            18,
            "frequencies 1.1 to 1.3 of the bifurcation study beside the tests' speeds",
            "two different regimes: the tests run at the frequency ratio on the right",
            1.1,
            ratio,
            "1",
        ),
        _row(19, "parameters announced as listed below", "they are not listed"),
        _row(
            20,
            "heat changes stability only, not structure",
            "contradicts the section that lets heat bring in a half-frequency line",
        ),
    ]


def _backlash(mesh: Dataset, name: str) -> float | None:
    """Hot half backlash [um] of the first operating point in the bundle whose name starts so."""
    for place, bundle in enumerate(mesh["bundle"].values):
        if str(bundle).startswith(name):
            found = mesh["half_backlash"].isel(bundle=place, state=-1, operating=0)
            return MICROMETRE(float(found))
    return None
