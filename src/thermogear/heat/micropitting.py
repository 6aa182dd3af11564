"""Film thickness that wears and pits: regimes of lubrication by source, permissible film parameter.

The limits lie far apart because their film parameters differ in film and roughness: a limit holds
for the parameter it was found with.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.base.errors import InputError


class RegimeLimits(NamedTuple):
    """Film parameters [-] below which contact is boundary and above which the film is full.

    source: where they come from; confirmed: read there, else usual and unconfirmed.
    """

    boundary_below: float
    full_film_above: float
    source: str
    confirmed: bool


REGIME_LIMITS: dict[str, RegimeLimits] = {
    "usual": RegimeLimits(0.7, 3.0, "usual in gear texts, Lambda by Rq of both flanks", False),
    "AGMA 925": RegimeLimits(0.4, 1.0, "public gear codes after AGMA 925 and NASA", True),
}

_GRADES = (32.0, 100.0, 220.0, 460.0)  # ISO VG, mm^2/s at 40 C
_STAGES = (5.0, 10.0)
_PERMISSIBLE = ((0.13, 0.055), (0.25, 0.09), (0.40, 0.145), (0.57, 0.20))


def permissible_film_parameter(
    viscosity_40: ArrayLike, *, load_stage: ArrayLike
) -> NDArray[np.float64]:
    """lambda_GFP [-] of a mineral oil by its failure stage in the micropitting test C-GF/8.3/90.

    Straight lines in log(lambda) over log(viscosity) and over the stage, through values read off
    a figure: VG 32 0.13 (stage 5) to 0.055 (stage 10), 100 0.25 to 0.09, 220 0.40 to 0.145, 460
    0.57 to 0.20.

    ``viscosity_40`` nu [m^2/s] at 40 C, 32..460 mm^2/s within the grades' 10 %; ``load_stage``
    5..10. Any shape. For Ra 0.5 um, mineral oil. Raises outside. Compare it with the least
    lambda_GF = h/mean Ra at A, B, C, D, E and halfway along AB and DE. Source: figure of
    ISO/TR 15144-1 as public code reads it: expect some 10 %.

    >>> f"{permissible_film_parameter(100e-6, load_stage=10):.3f}"
    '0.090'
    """
    nu, stage = np.asarray(viscosity_40, dtype=float) * 1e6, np.asarray(load_stage, dtype=float)
    low, high = 0.9 * _GRADES[0], 1.1 * _GRADES[-1]
    if not np.all((nu >= low) & (nu <= high)):
        raise InputError(
            "lubricant.viscosity_40", f"{nu} mm^2/s", allowed=f"{low:g}..{high:g} mm^2/s"
        )
    if not np.all((stage >= _STAGES[0]) & (stage <= _STAGES[1])):
        raise InputError("micropitting.load_stage", f"{stage}", allowed="5..10")
    nu, stage = np.broadcast_arrays(np.clip(nu, _GRADES[0], _GRADES[-1]), stage)
    ends = [
        np.interp(np.log(nu), np.log(_GRADES), np.log([row[k] for row in _PERMISSIBLE]))
        for k in (0, 1)
    ]
    share = (stage - _STAGES[0]) / (_STAGES[1] - _STAGES[0])
    return np.asarray(np.exp((1.0 - share) * ends[0] + share * ends[1]))


def micropitting_safety(
    *, film_parameter: ArrayLike, permissible: ArrayLike
) -> NDArray[np.float64]:
    """S_lambda = min lambda_GF/lambda_GFP [-], the least over the last axis.

    ``film_parameter`` lambda_GF (..., position), h over the mean Ra of both flanks
    (:func:`~thermogear.heat.film.mean_roughness_film_parameter`), ``permissible`` lambda_GFP
    (...). Source: ISO/TR 15144-1.

    >>> f"{micropitting_safety(film_parameter=[0.3, 0.2, 0.4], permissible=0.1):.2f}"
    '2.00'
    """
    least = np.asarray(film_parameter, dtype=float).min(axis=-1)
    return np.asarray(least / np.asarray(permissible))
