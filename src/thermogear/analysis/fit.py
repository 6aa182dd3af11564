"""Factors of any simulation fitted to data by least squares, with the fit's own uncertainty.

Every parameter is a factor on a stated value, on a logarithmic scale, so that it keeps its sign
and its unit.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import optimize

from thermogear.base.errors import ConvergenceError, InputError

Floats = NDArray[np.float64]

_VAGUE = 0.5  # standard deviation of a log factor: beyond it the data hardly tell
_PARALLEL = 0.99  # correlation beyond which two parameters cannot be told apart


@dataclass(frozen=True, kw_only=True)
class Fit:
    """``factors`` on the stated values, their relative standard uncertainties and correlations.

    ``residuals``: (simulated - measured)/uncertainty at the end. ``notices`` say where the data
    do not determine a parameter.
    """

    names: tuple[str, ...]
    factors: tuple[float, ...]
    uncertainties: tuple[float, ...]
    correlation: Floats
    residuals: Floats
    evaluations: int
    notices: tuple[tuple[str, str], ...]


def fit(
    simulate: Callable[[Floats], Floats],
    names: Sequence[str],
    *,
    measured: Floats,
    uncertainty: Floats,
    most: int = 60,
) -> Fit:
    """Factors that bring ``simulate(factors)`` to ``measured`` in the least-squares sense.

    min over p of sum ((y(exp p) - m)/u)^2;  covariance (J^T J)^-1 of the log factors p.

    ``measured``, ``uncertainty`` (standard, > 0) and what ``simulate`` returns share a unit.
    Raises InputError for no data or uncertainties that are not positive, ConvergenceError where
    the simulation gives no number. A parameter is called undetermined when there are fewer data
    than parameters, when its uncertainty exceeds 50 %, or when it moves the data as another one
    does.
    """
    m, u = np.asarray(measured, dtype=float), np.asarray(uncertainty, dtype=float)
    if not np.all(np.isfinite(m)):
        raise InputError("measured", m.tolist(), allowed="finite")
    if m.size == 0 or m.shape != u.shape or not np.all(np.isfinite(u) & (u > 0)):
        raise InputError(
            "uncertainty", u.tolist(), allowed="> 0, finite, one for each measured value"
        )
    if not names:
        raise InputError("parameters", "none", allowed="one or more fields")

    def residual(p: Floats) -> Floats:
        found = np.asarray((simulate(np.exp(p)) - m) / u)
        if not np.all(np.isfinite(found)):
            at = ", ".join(f"{n} = {f:.6g}" for n, f in zip(names, np.exp(p), strict=True))
            raise ConvergenceError(f"fit: no finite line at the factors {at}")
        return found

    done = optimize.least_squares(
        residual, np.zeros(len(names)), method="trf", diff_step=1e-3, max_nfev=most
    )
    information = done.jac.T @ done.jac
    covariance = np.linalg.pinv(information, hermitian=True)
    spread = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    # the inverse leaves out what the data do not see at all: there the spread has no bound
    strength = np.sqrt(np.diag(information))
    spread = np.where(strength < 1e-9 * max(float(strength.max()), 1e-300), np.inf, spread)
    with np.errstate(invalid="ignore", divide="ignore"):
        correlation = np.nan_to_num(covariance / np.outer(spread, spread))
    notices = []
    if m.size < len(names):
        notices.append(
            ("important", f"{len(names)} parameters from {m.size} values: not determined")
        )
    for i, name in enumerate(names):
        if not spread[i] <= _VAGUE:
            notices.append(
                (
                    "important",
                    f"the data do not determine {name}: its uncertainty is {100 * spread[i]:.3g} %",
                )
            )
        for j in range(i):
            if abs(_cosine(done.jac, i, j)) > _PARALLEL:
                notices.append(
                    ("important", f"the data cannot tell {names[j]} from {name}: they act alike")
                )
    if done.status <= 0:
        notices.append(("warning", f"the fit did not settle in {done.nfev} evaluations"))
    return Fit(
        names=tuple(names),
        factors=tuple(float(f) for f in np.exp(done.x)),
        uncertainties=tuple(float(s) for s in spread),
        correlation=correlation,
        residuals=np.asarray(done.fun),
        evaluations=int(done.nfev),
        notices=tuple(notices),
    )


def _cosine(jacobian: Floats, i: int, j: int) -> float:
    a, b = jacobian[:, i], jacobian[:, j]
    length = float(np.linalg.norm(a) * np.linalg.norm(b))
    return float(a @ b) / length if length > 0 else 0.0
