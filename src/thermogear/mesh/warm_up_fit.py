"""Heat-transfer factors out of a measured warm-up, with the intervals the record allows."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError, nearest
from thermogear.base.progress import Progress, silent
from thermogear.mesh.warm_up import FACTORS, Duty

Residuals = Callable[[Mapping[str, float]], Floats]
"""Computed less measured [K] under factors: (rows, columns), nan where nothing was measured."""

MOST_FACTORS = 2
MOST_RUNS = 40
REACH = 50.0
"""Factors are looked for between 1/50 and 50."""
STEP = 0.05
"""Of ln factor, for differences: large against the error of an integration."""
CONFIDENCE = 0.95


@dataclass(frozen=True, kw_only=True)
class Fitted:
    """One factor [-] with its 95 % interval, nan where the record allows none."""

    name: str
    value: float
    low: float
    high: float


@dataclass(frozen=True, kw_only=True)
class Fit:
    """What :func:`fit_factors` found.

    ``before``, ``after``: rms difference [K] without and with the factors; ``count`` of readings,
    ``effective``: how many independent ones they are worth; ``autocorrelation`` of neighbouring
    residuals [-]; ``correlation`` of two factors' errors [-], nan for one.
    """

    factors: tuple[Fitted, ...]
    before: float
    after: float
    count: int
    effective: float
    autocorrelation: float
    correlation: float
    runs: int


def require_factors(names: Sequence[str], field: str) -> tuple[str, ...]:
    """``names`` where at most two known ones are named once each; InputError under ``field``."""
    for name in names:
        if name not in FACTORS:
            fix = nearest(str(name), FACTORS)
            raise InputError(field, repr(name), allowed=" | ".join(FACTORS), fix=fix)
    if not names or len(names) > MOST_FACTORS or len(set(names)) < len(names):
        raise InputError(
            field,
            ", ".join(names) or "nothing",
            allowed="one or two different factors",
            why="a warm-up tells no more of them apart",
        )
    return tuple(names)


def until(duty: Duty, end: float) -> Duty:
    """The part of ``duty`` up to ``end`` [s] > 0."""
    begins = duty.time[:-1]
    kept = int(np.count_nonzero(begins < end))
    return replace(
        duty,
        time=np.append(begins[:kept], min(end, float(duty.time[-1]))),
        speed=duty.speed[:kept],
        torque=duty.torque[:kept],
        ambient=duty.ambient[:kept],
    )


def fit_factors(residuals: Residuals, names: Sequence[str], progress: Progress = silent) -> Fit:
    """Factors on conductances with the least sum of squared residuals, and their intervals.

    Least squares over ln factor from 1. The covariance is s^2 (J^T J)^-1 n/n_eff, s^2 the residual
    variance: residuals of a record follow each other, so n readings are worth
    n_eff = n (1 - r)/(1 + r), r the correlation of neighbours in a column (first-order
    autoregression; Bartlett). Interval: ln factor +- Student's t with n_eff - p degrees of freedom.
    They speak of scatter alone: what the model leaves out is not in them.

    ``residuals`` [K] under factors by name; ``names``: one or two of
    :data:`~thermogear.mesh.warm_up.FACTORS`. Raises InputError where the record says nothing of a
    factor or reaches no end.
    """
    known: dict[tuple[float, ...], Floats] = {}

    def table(x: Floats) -> Floats:
        key = tuple(float(v) for v in x)
        if key not in known:
            if len(known) >= MOST_RUNS:
                raise InputError(
                    "fit", f"no end after {MOST_RUNS} runs", fix="fit one factor, or another one"
                )
            progress("fit", len(known), MOST_RUNS)
            known[key] = residuals(dict(zip(names, np.exp(x).tolist(), strict=True)))
        return known[key]

    def flat(x: Floats) -> Floats:
        values = table(x)
        return values[np.isfinite(values)]

    def slope(x: Floats) -> Floats:
        base, columns = flat(x), []
        for k in range(x.size):
            moved = x.copy()
            moved[k] += STEP if x[k] < 0.5 * np.log(REACH) else -STEP
            columns.append((flat(moved) - base) / (moved[k] - x[k]))
        return np.stack(columns, axis=1)

    from scipy import optimize, stats

    reach, start = float(np.log(REACH)), np.zeros(len(names))
    found = optimize.least_squares(
        flat, start, jac=slope, bounds=(-reach, reach), xtol=1e-4, ftol=1e-6
    )
    x = np.asarray(found.x)
    final, jacobian = table(x), slope(x)
    for name, column in zip(names, jacobian.T, strict=True):
        if np.max(np.abs(column)) < 1e-3:
            raise InputError(
                "fit", repr(name), why="the record says nothing of it", fix="fit another factor"
            )
    one = flat(x)
    r = _neighbours(final)
    count = one.size
    effective = count * (1.0 - r) / (1.0 + r)
    freedom = effective - x.size
    spread, correlation = np.full(x.size, np.nan), np.nan
    normal = jacobian.T @ jacobian
    if freedom > 0.0 and np.linalg.cond(normal) < 1e12:
        variance = float(one @ one) / max(count - x.size, 1)
        covariance = variance * np.linalg.inv(normal) * count / effective
        spread = np.sqrt(np.diag(covariance)) * stats.t.ppf(0.5 + 0.5 * CONFIDENCE, freedom)
        # an interval wider than the search says nothing
        spread = np.where(spread < reach, spread, np.nan)
        if x.size == 2:
            correlation = covariance[0, 1] / np.sqrt(covariance[0, 0] * covariance[1, 1])
    progress("fit", MOST_RUNS, MOST_RUNS)
    return Fit(
        factors=tuple(
            Fitted(
                name=name,
                value=float(np.exp(v)),
                low=float(np.exp(v - d)),
                high=float(np.exp(v + d)),
            )
            for name, v, d in zip(names, x, spread, strict=True)
        ),
        before=_rms(flat(start)),
        after=_rms(one),
        count=int(count),
        effective=float(effective),
        autocorrelation=r,
        correlation=float(correlation),
        runs=len(known),
    )


def _rms(values: Floats) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _neighbours(table: Floats) -> float:
    """Correlation of neighbouring residuals, pooled over the columns, 0..0.999."""
    along = whole = 0.0
    for column in table.T:
        e = column[np.isfinite(column)]
        along += float(e[1:] @ e[:-1])
        whole += float(e @ e)
    return min(max(along / whole, 0.0), 0.999) if whole > 0.0 else 0.0
