"""Periodic orbits: Newton shooting on the event-exact map, multipliers, what happens on them.

Single shooting: Newton's method for P^n(z) = z with D P^n of the variational equations, which finds
unstable orbits too and converges quadratically near one; Floquet multipliers are the eigenvalues of
that matrix. A step costs n periods with d tangents. Steps are cut to a half backlash, for the map
has kinks. It fails from a far guess, at a fold, and on orbits so long and unstable that rounding
times D P^n is larger than the tolerance.
Checked by ``tests/analysis/test_orbits.py``: independent orbits, the determinant
exp(-4 pi zeta n / w), the forced oscillation in closed form.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from thermogear.base.arrays import Complexes, Floats
from thermogear.base.bounds import whole
from thermogear.base.errors import ConvergenceError, InputError
from thermogear.dynamics.lanes import Lanes
from thermogear.dynamics.return_map import ReturnMap, Visit, return_map

SAMPLES = 2**17
"""Samples along a turn at most, unless a mesh period would have fewer than 64."""
CHORDS = 6
"""Corrections of an orbit by finer steps at most: each leaves about a thousandth."""
BETWEEN = 8
"""Places from one sample of a turn to the next at which its force is looked at."""


@dataclass(frozen=True, kw_only=True)
class Orbit:
    """A closed orbit of ``period`` periods of its model, which has states of any length d.

    ``model`` it belongs to with its return map ``section``, ``points`` (period, d) on the section,
    ``jacobian`` D P^n at the first of them, ``residual`` |P^n z - z| in units of the map (of one
    mass the half backlash), counts and shares over one orbit, ``iterations`` of Newton.
    :attr:`minimal_period` says whether it closes sooner.

    >>> model = TorsionalModel(
    ...     damping_ratio=0.05, frequency=0.5, stiffness_amplitude=0.0,
    ...     mean_force=0.1, force_amplitude=0.05,
    ... )
    >>> orbit = periodic_orbit(model, guess=(1.1, 0.0))
    >>> abs(orbit.multipliers).round(4), orbit.contact_losses
    (array([0.5335, 0.5335]), 0)
    """

    section: ReturnMap = field(repr=False)
    model: object = field(repr=False)
    period: int
    points: Floats
    jacobian: Floats
    residual: float
    contact_losses: int
    back_impacts: int
    shares: Floats
    iterations: int

    @property
    def lanes(self) -> Lanes:
        """The flat parameters of a one-mass model; AttributeError for another one."""
        lanes: Lanes = self.section.lanes  # type: ignore[attr-defined]
        return lanes

    @property
    def state(self) -> Floats:
        """The state at phase 0, (d,): (x, x') of one mass."""
        return np.asarray(self.points[0])

    @property
    def multipliers(self) -> Complexes:
        """Floquet multipliers over the whole orbit, the larger modulus first."""
        return multipliers(self.jacobian, self.determinant)

    @property
    def determinant(self) -> float:
        """The product of the multipliers, exp(-c n T) of one mass."""
        return self.section.determinant(self.period)

    @property
    def stable(self) -> bool:
        """All multipliers inside the unit circle."""
        return bool(np.max(np.abs(self.multipliers)) < 1.0)

    @property
    def time_share(self) -> dict[str, float]:
        """Share of time in back contact, free flight and drive contact."""
        return dict(zip(("back", "free", "drive"), map(float, self.shares), strict=True))

    @property
    def minimal_period(self) -> int:
        """The smallest number of periods after which the orbit closes."""
        unit = self.section.unit
        for lag in range(1, self.period):
            if self.period % lag == 0:
                gap = np.max(np.abs(self.points[lag] - self.points[0]) / unit)
                if gap <= max(1e-8, 1e3 * self.residual):
                    return lag
        return self.period

    def sampling(self, per_period: int) -> int:
        """Samples a mesh period: ``per_period``, of long turns fewer, :data:`SAMPLES` in all."""
        most = max(SAMPLES // self.lanes.mesh_periods, 64)
        return min(per_period, most) if self.lanes.mesh_periods > 1 else per_period

    def samples(self, per_period: int = 256) -> tuple[Floats, Floats, Floats]:
        """Phase (in mesh periods), x and x' along the whole orbit at uniform phases.

        :meth:`sampling` of ``per_period`` in each mesh period.
        """
        count = self.sampling(per_period)
        turn = count * self.lanes.mesh_periods
        visit = return_map(self.lanes, turn).visit(self.state, self.period, sampled=True)
        phase = np.arange(self.period * turn) / count
        return phase, visit.samples[:, 0], visit.samples[:, 1]

    def extremes(self, per_period: int = 256) -> tuple[float, float]:
        """Least and largest x on the orbit, between the samples too."""
        _, x, v = self.samples(per_period)
        c1, c2, c3 = self._cubics(x, v, per_period)
        low, high = float(x.min()), float(x.max())
        for i in np.flatnonzero(v * np.roll(v, -1) < 0.0):
            roots = np.roots([3 * c3[i], 2 * c2[i], c1[i]])
            for t in roots[np.isreal(roots)].real:
                if 0.0 <= t <= 1.0:
                    value = float(x[i] + t * (c1[i] + t * (c2[i] + t * c3[i])))
                    low, high = min(low, value), max(high, value)
        return low, high

    def _cubics(self, x: Floats, v: Floats, per_period: int) -> tuple[Floats, Floats, Floats]:
        """Cubic Hermite from each sample to the next: coefficients of t, t^2, t^3, t from 0 to 1.

        Its error is of fourth order in the step.
        """
        step = float(self.lanes.mesh_period[0]) / self.sampling(per_period)
        d, v1 = np.roll(x, -1) - x, np.roll(v, -1)
        return step * v, 3 * d - step * (2 * v + v1), step * (v + v1) - 2 * d

    def dynamic_load_factor(self, per_period: int = 1024) -> float:
        """max |k f| over the mean of k f on the orbit (1 for a quasi-static, constant mesh).

        The mean of the elastic force equals the mean of F(t) on every closed orbit. Infinite
        when that mean is 0. Over a turn it is looked for between the samples too.
        """
        _, x, v = self.samples(per_period)
        if self.lanes.mesh_periods > 1:
            t = np.arange(BETWEEN) / BETWEEN
            c1, c2, c3 = (c[:, None] for c in self._cubics(x, v, per_period))
            x = (x[:, None] + t * (c1 + t * (c2 + t * c3))).ravel()
        count = x.size // self.period
        once = self.lanes.values("stiffness", np.arange(count) / count)[:, 0]
        b = float(self.lanes.half_backlash[0])
        force = np.tile(once, self.period) * (x - np.clip(x, -b, b))
        mean = float(self.lanes.force[0, 0].real)
        piece = self.lanes.force_pieces[0]
        mean += 0.0 if piece is None else piece.mean
        return float(np.max(np.abs(force)) / abs(mean)) if mean != 0.0 else float("inf")


def multipliers(jacobian: Floats, determinant: float) -> Complexes:
    """Eigenvalues of a Jacobian, the larger modulus first; ``determinant`` nan: not known.

    Of two by two with a known one mu = tr/2 +- sqrt(tr^2/4 - det); the smaller real one as det/mu,
    free of cancellation. Of a pair the one in the upper half plane comes first.
    """
    if jacobian.shape != (2, 2) or (np.isnan(determinant) and np.all(np.isfinite(jacobian))):
        if not np.all(np.isfinite(jacobian)):
            return np.full(len(jacobian), complex("nan"))
        found = np.linalg.eigvals(jacobian).astype(complex)
        # of one modulus the upper half plane first
        order = np.lexsort((-found.imag, -np.round(np.abs(found), 12)))
        return np.asarray(found[order])
    half = 0.5 * float(jacobian[0, 0] + jacobian[1, 1])
    square = half * half - determinant
    if square < 0.0:
        return np.array([complex(half, np.sqrt(-square)), complex(half, -np.sqrt(-square))])
    large = half + np.copysign(np.sqrt(square), half)
    # over a long turn both may lie below the least number
    return np.array([large, determinant / large if large else 0.0], complex)


def shoot(
    section: ReturnMap,
    guess: Floats,
    period: int,
    *,
    tolerance: float = 1e-13,
    most: int = 30,
    model: object = None,
) -> Orbit | None:
    """Newton from ``guess`` to a fixed point of P^n; None when it does not settle.

    Steps longer than a half backlash are shortened. Converged when the residual in units of
    the half backlash is below ``tolerance``, or no longer falls and is below 1e-9: a long
    orbit carries its own rounding.
    """
    unit = section.unit
    z = np.array(guess, dtype=float)
    best: tuple[float, Floats, Visit] | None = None
    stalled = 0
    used = 0
    for _ in range(most):
        used += 1
        visit = section.visit(z, period)
        gap = visit.points[-1] - z
        if not (np.all(np.isfinite(gap)) and np.all(np.isfinite(visit.jacobian))):
            return None
        residual = float(np.max(np.abs(gap) / unit))
        if best is None or residual < best[0]:
            best, stalled = (residual, z.copy(), visit), 0
        else:
            stalled += 1
        if residual < tolerance or (stalled >= 3 and best[0] < 1e-9):
            break
        matrix = visit.jacobian - np.eye(z.size)
        try:
            step = np.linalg.solve(matrix, -gap)
        except np.linalg.LinAlgError:
            return None
        length = float(np.max(np.abs(step) / unit))
        if length > 1.0:
            step = step / length
        z = z + step
    if best is None or best[0] > 1e-9:
        return None
    residual, z, visit = best
    return closed(section, z, period, model=model, visit=visit, iterations=used)


def closed(
    section: ReturnMap,
    state: Floats,
    period: int,
    *,
    model: object = None,
    visit: Visit | None = None,
    iterations: int = 0,
) -> Orbit:
    """The orbit through ``state``, which is taken to close after ``period`` periods.

    ``visit``: where they lead, if that is known.
    """
    visit = section.visit(state, period) if visit is None else visit
    residual = float(np.max(np.abs(visit.points[-1] - visit.points[0]) / section.unit))
    return Orbit(
        section=section,
        model=model,
        period=period,
        points=visit.points[:-1],
        jacobian=visit.jacobian,
        residual=residual,
        contact_losses=visit.contact_losses,
        back_impacts=visit.back_impacts,
        shares=visit.shares,
        iterations=iterations,
    )


def by_finer_steps(orbit: Orbit) -> Orbit | None:
    """The same orbit by the ``finer`` steps of its map; None where these do not close there.

    Newton's rule with the Jacobian at hand (the chord method), then the finer one. What both
    multipliers differ by is the error of the coarser one. A map without finer steps has no error
    to tell: its orbit is returned.
    """
    section: ReturnMap | None = getattr(orbit.section, "finer", None)
    if section is None:
        return orbit
    z, matrix = orbit.state, orbit.jacobian - np.eye(orbit.state.size)
    for _ in range(CHORDS):
        gap = section.carry(z, orbit.period)[-1] - z
        if float(np.max(np.abs(gap) / section.unit)) < 1e-11:
            break
        z = z - np.linalg.solve(matrix, gap)
    again = closed(section, z, orbit.period, model=orbit.model)
    return again if again.residual < 1e-9 else None


def multiplier_error(orbit: Orbit) -> float:
    """What finer steps along ``orbit`` change its largest multiplier by; 0 of an exact map."""
    section: ReturnMap | None = getattr(orbit.section, "finer", None)
    if section is None:
        return 0.0
    again = closed(section, orbit.state, orbit.period)
    return float(abs(again.multipliers[0] - orbit.multipliers[0]))


def periodic_orbit(
    model: object, period: int = 1, guess: ArrayLike = (0.0, 0.0), *, tolerance: float = 1e-13
) -> Orbit:
    """The orbit of ``period`` periods of ``model`` near ``guess`` = (x, x') at phase 0.

    Stable or not; a period is a mesh period, or the turn of a model whose tables repeat after one.

    Newton shooting on the event-exact return map P with its variational equations: P^n(s) = s,
    multipliers the eigenvalues of D P^n. States (x, x') are in the units of the model: pure numbers
    for :class:`TorsionalModel`, SI for a model in SI.

    Raises InputError for a period that is no whole number >= 1 or a model of several lanes, and
    ConvergenceError when Newton does not settle from this guess.

    >>> model = TorsionalModel(
    ...     damping_ratio=0.05, frequency=0.5, stiffness_amplitude=0.0,
    ...     mean_force=0.1, force_amplitude=0.05,
    ... )
    >>> orbit = periodic_orbit(model, guess=(1.1, 0.0))
    >>> orbit.points.round(4)
    array([[1.1664, 0.0022]])
    """
    period = whole("period", period, least=1)
    start = np.asarray(guess, dtype=float)
    section = return_map(model)
    if start.shape != (section.dimension,) or not np.all(np.isfinite(start)):
        named = "two finite numbers (x, x')" if section.dimension == 2 else "finite numbers"
        raise InputError("guess", start.tolist(), allowed=f"{named}, shape ({section.dimension},)")
    orbit = shoot(section, start, period, tolerance=tolerance, model=model)
    if orbit is None:
        raise ConvergenceError(
            f"no orbit of period {period} reached from {start.tolist()}: Newton did not settle "
            "within 30 iterations to a residual of 1e-9 of its unit (of gears the half backlash); "
            "try another guess"
        )
    return orbit
