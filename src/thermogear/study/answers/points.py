"""The numbers of the answers at many points at once, as sweeps carry them."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError, ThermogearError
from thermogear.base.plan import Variable
from thermogear.base.vocabulary import STATUS
from thermogear.case.allowed import LANE
from thermogear.case.case import GearCase
from thermogear.case.family import BESIDE, GearFamily
from thermogear.mesh.scuffing_rating import Scuffing, flash_rating, integral_rating
from thermogear.study.scuffing import borne_by, load_stage, not_steel

NUMBERS: dict[str, tuple[str, str]] = {
    "oil_temperature": ("K", "oil temperature"),
    "tooth_temperature": ("K", "temperature of the hotter teeth, without the flash"),
    "greatest_flash": ("K", "greatest flash temperature, of the worst tooth pair"),
    "least_film_parameter": ("1", "least film parameter, of the worst tooth pair"),
    "scuffing_margin": ("K", "scuffing temperature less contact temperature, ISO/TR 13989-1"),
    "scuffing_safety": ("1", "safety by integral temperature, ISO/TR 13989-2"),
    "backlash": ("m", "least backlash, whole gap, along the line of action"),
    "jam_temperature": (
        "K",
        "temperature of the pinion's teeth at which the pair jams, housing as it is",
    ),
    "jam_margin": (
        "K",
        "jam temperature, or what the materials bear where that is less, less temperature of the "
        "pinion's teeth",
    ),
    "static_error": ("m", "transmission error, static and loaded, peak to peak"),
}
"""Every number with its unit and words; those of the motion are sweeps' own."""
WANT = (
    "oil_temperature", "tooth_temperature", "pinion_temperature", "greatest_flash_temperature",
    "least_film_parameter", "least_half_backlash", "jam_temperature", "transmission_error",
)  # fmt: skip
UNRATED = ("pinion_speed", "pinion_torque", "gear_temperature", "cold_half_backlash",
           "damping_ratio", "operating.torque", *BESIDE, *LANE)  # fmt: skip
"""Parameters that change neither gears nor oil: a rating needs no other case."""


def answer_variables(dims: tuple[str, ...]) -> dict[str, Variable]:
    """How the numbers are stored over ``dims``."""
    return {
        name: Variable(dims, "float64", float("nan"), {"units": unit, "long_name": words})
        for name, (unit, words) in NUMBERS.items()
    }


def answer_numbers(family: GearFamily, rows: ArrayLike) -> dict[str, Floats]:
    """:data:`NUMBERS` of every row of ``family``, SI, (row,); nan where one is not known.

    The same as :func:`~thermogear.study.answers.survey.answers` tells of a case with these values:
    flash and film over the case's own positions along the path, scuffing by the standard's
    friction and body temperature with the oil's, the load stage 12 where none is given.
    """
    points = np.asarray(rows, dtype=float)
    case = family.case
    found = family.quasi_static(points, WANT, path_positions=case.path_positions)
    margin, safety = _scuffing(family, points, found)
    jam, teeth = found["jam_temperature"], found["pinion_temperature"]
    borne = borne_by(case.pair)[0]
    # a jammed pair has no running contact
    running = found["status"] != STATUS.index("jammed")
    of_path = (found[name] for name in ("greatest_flash_temperature", "least_film_parameter"))
    flash, film, margin, safety = (
        np.where(running, values, np.nan) for values in (*of_path, margin, safety)
    )
    return {
        "oil_temperature": found["oil_temperature"],
        "tooth_temperature": found["tooth_temperature"],
        "greatest_flash": flash,
        "least_film_parameter": np.where(np.isfinite(film), film, np.nan),
        "scuffing_margin": margin,
        "scuffing_safety": safety,
        "backlash": 2.0 * found["least_half_backlash"],
        "jam_temperature": jam,
        "jam_margin": np.minimum(jam, borne) - teeth,
        "static_error": np.where(running, np.ptp(found["transmission_error"], axis=1), np.nan),
    }


def _scuffing(
    family: GearFamily, rows: Floats, found: dict[str, NDArray[np.float64]]
) -> tuple[Floats, Floats]:
    """Margin [K] and safety [-] of every row, the gears and the oil of each."""
    margin, safety = np.full(len(rows), np.nan), np.full(len(rows), np.nan)
    other = [i for i, name in enumerate(family.names) if name not in UNRATED]
    kinds, which = np.unique(rows[:, other], axis=0, return_inverse=True)
    names = [family.names[i] for i in other]
    for kind, values in enumerate(kinds if other else np.empty((1, 0))):
        here = np.flatnonzero(which.ravel() == kind) if other else np.arange(len(rows))
        case = family.case
        try:
            if names:
                case = case.with_values(dict(zip(names, values, strict=True)), told=False)
        except ThermogearError:
            continue  # no case could have it: the status says so
        at = {n: found[n][here] for n in ("pinion_torque", "pinion_speed", "oil_temperature")}
        margin[here], safety[here] = _rated(case, *at.values())
    return margin, safety


def _rated(
    case: GearCase, torque: Floats, speed: Floats, oil: Floats
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    margin, safety = np.full(torque.shape, np.nan), np.full(torque.shape, np.nan)
    rated = (torque > 0.0) & (speed > 0.0) & np.isfinite(oil)
    if not_steel(case) or not rated.any():
        return margin, safety
    state = Scuffing(
        lubricant=case.stated.lubricant,
        oil_temperature=oil[rated],
        load_stage=load_stage(case).stage,
    )
    for values, rate, name in (
        (margin, flash_rating, "margin"), (safety, integral_rating, "safety")
    ):  # fmt: skip
        try:
            values[rated] = getattr(rate(case.pair, torque[rated], speed[rated], state), name)
        except InputError:
            continue  # the standard does not cover this pair
    return margin, safety
