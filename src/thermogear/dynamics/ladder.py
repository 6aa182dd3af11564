"""The engine of a drive train's equation: tables of its steps, and runs.

The steps themselves are :mod:`~thermogear.dynamics.kernels.ladder`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.base.arrays import Floats
from thermogear.base.errors import ConvergenceError, InputError
from thermogear.base.excitation import Periodic
from thermogear.dynamics.geared_equation import Function, GearedEquation
from thermogear.dynamics.kernels import drive as k
from thermogear.dynamics.kernels import ladder as steps
from thermogear.dynamics.kernels.drive_run import advance
from thermogear.dynamics.tables import Pieces

DEGREE = 7
"""Of the polynomials that stand for the periodic functions on a panel."""
FREE = 1e-12
"""A rate below this share of the greatest is that of a free motion."""
GRADED, CROWDED = 16, 4
"""Places of a rule for what is like a broken power of the distance from a border, over half of a
piece, and the power in which they crowd there: (1/2)^-9 of what they miss of the power 1/9."""
PANEL = 0.2
"""Half width of a panel [rad] in the highest harmonic."""


@dataclass(frozen=True, kw_only=True)
class Steps:
    """How finely the engine goes.

    ``accuracy``: error allowed in one step over the half backlash. ``nodes`` s of a step (order 2 s
    between contact changes), ``longest``: longest step as a share 1/``longest`` of a mesh period,
    halved up to ``rungs`` - 1 times. ``sweep``: share of the accuracy at which sweeps end.
    """

    accuracy: float = 1e-9
    nodes: int = 6
    longest: int = 8
    rungs: int = 10
    sweep: float = 0.1


@dataclass(frozen=True, kw_only=True)
class Run:
    """What one run of a state through mesh periods gave.

    ``sections`` (periods, d): the state at the end of every mesh period; ``state`` the last one.
    ``jacobian`` (d, d) of the whole and tangent ``directions`` (count, d), where asked for.
    ``samples`` (periods samples, d) from the start on and their ``sample_phase``; ``times``
    (periods) [s] how long each took. ``counts`` of steps, rejected ones, contact changes, sweeps,
    losses of the drive flank, closings of the back flank, lifts of bearings; ``shares`` of time in
    back contact, free flight, drive contact.
    """

    sections: Floats
    jacobian: Floats
    directions: Floats
    samples: Floats
    sample_phase: Floats
    times: Floats
    counts: dict[str, int]
    shares: Floats

    @property
    def state(self) -> Floats:
        """The last state, (d,)."""
        return np.asarray(self.sections[-1])


COUNTS = ("steps", "rejected", "events", "sweeps", "losses", "impacts", "lifts", "forced")


class Engine:
    """A model with the tables of its steps; stateless between runs.

    ``ramp`` [Hz/s]: how the mesh frequency rises during a run.
    """

    def __init__(
        self, model: GearedEquation, how: Steps | None = None, *, ramp: float = 0.0
    ) -> None:
        self.model = model
        self.how = how or Steps()
        self.ramp = ramp
        self._modes()
        self._tables()

    def _modes(self) -> None:
        model = self.model
        a = model.state_matrix
        scale = np.ones(a.shape[0])
        scale[model.size : 2 * model.size] = float(
            np.sqrt(np.abs(np.diag(a[model.size : 2 * model.size, : model.size])).mean())
        )
        values, vectors = np.linalg.eig(a * scale[None, :] / scale[:, None])
        right = vectors * scale[:, None]
        left = np.linalg.inv(vectors) / scale[None, :]
        real = np.abs(values.imag) <= 1e-12 * np.abs(values).max()
        keep = real | (values.imag > 0.0)
        weight = np.where(real, 1.0, 2.0)
        if np.any(np.abs(values) <= FREE * np.abs(values).max()):
            raise InputError(
                "train",
                "a free motion",
                allowed="none: leave out the rotation of the train",
                why="nothing holds it, so that it has no equilibrium",
            )
        lam = np.where(real, values.real, values)[keep]
        self.lam = np.ascontiguousarray(lam, dtype=complex)
        into = np.zeros((model.dimension, model.inputs.shape[1]))
        into[model.size : 2 * model.size] = np.linalg.solve(model.mass, model.inputs)
        steady = np.zeros(model.dimension)
        steady[model.size : 2 * model.size] = np.linalg.solve(model.mass, model.force)
        self.rest = -np.linalg.solve(a, steady)
        self.to_modes = np.ascontiguousarray(left[keep])
        self.from_modes = np.ascontiguousarray((right * weight)[:, keep])
        self.into = np.ascontiguousarray(self.to_modes @ into, dtype=complex)
        rows = np.hstack(
            [model.outputs, np.zeros((model.outputs.shape[0], model.dimension - model.size))]
        )
        c = rows @ self.from_modes
        felt = rows.shape[0]
        out = np.zeros((2 * lam.size, padded(felt)))
        out[0::2, :felt], out[1::2, :felt] = c.real.T, -c.imag.T
        self.out = out.ravel()
        self.offset = np.zeros(padded(felt))
        self.offset[:felt] = rows @ self.rest

    def _tables(self) -> None:
        model, how = self.model, self.how
        friction = int(model.friction is not None)
        modes, inputs = self.into.shape
        outputs = int(model.outputs.shape[0])
        count = len(model.bearings)
        s = how.nodes
        self.sizes = np.array(
            [
                modes,
                s,
                outputs,
                inputs,
                friction,
                count,
                how.rungs,
                padded(2 * modes),
                padded(s * outputs),
                padded(outputs),
                DEGREE + 1,
                int(any(one.elements or one.exponent != 1.0 for one in model.bearings)),
            ]
        )
        kinds, laws = np.zeros((max(count, 1), 3), np.int64), np.zeros((max(count, 1), 8))
        rays = [np.zeros((1, 2))]
        for row, one in enumerate(model.bearings):
            first = sum(len(some) for some in rays)
            kinds[row] = (k.ELEMENTS if one.elements else k.RING, one.elements, first)
            turn = 2.0 * np.pi * one.order
            laws[row] = (one.coefficient, one.exponent, one.clearance, *np.ravel(one.base), turn)
            rays.append(one.rays)
        outer = np.array(
            [[one.order, one.shift, float(one.rotating)] for one in model.outer] or [[0.0] * 3]
        )
        edges, guide, table, borders, broken = periodic_table(model)
        self.numbers = np.zeros(8)
        self.numbers[[k.BASE, k.BACKLASH, k.DAMPING, k.FREQUENCY, k.RAMP]] = (
            model.base_stiffness,
            model.half_backlash,
            model.mesh_damping,
            model.mesh_frequency,
            self.ramp,
        )
        self.numbers[k.TOLERANCE] = how.accuracy * model.half_backlash
        self.numbers[k.SWEEP] = how.sweep
        around = np.concatenate(rays).ravel()
        wobbles = np.array([one.row for one in model.wobbles]).reshape(-1, 5)
        self._arrays = (kinds, laws, around, outer, wobbles, edges, guide, table, borders, broken)
        nodes = 0.5 * (np.polynomial.legendre.leggauss(s)[0] + 1.0)
        powers = np.linalg.inv(np.vander(nodes, s, increasing=True))
        places = np.r_[0.0, nodes, 1.0]
        gaps = places[:, None] - places[None, :] + np.eye(s + 2)
        shifted = np.polynomial.legendre.leg2poly(np.eye(s + 1)[s])
        # P_s(2 x - 1) in powers of x
        line = np.polynomial.Polynomial(shifted)(np.polynomial.Polynomial([-1.0, 2.0]))
        # one more for a tangent's step to a cut
        size = how.rungs + 1
        gauss, weight = np.polynomial.legendre.leggauss(GRADED)
        near = 0.5 * (gauss + 1.0)
        self.ladder = steps.Ladder(
            nodes=nodes,
            powers=np.ascontiguousarray(powers),
            factorial=np.array([float(math.factorial(q)) for q in range(s + 4)]),
            legendre=np.ascontiguousarray(line.coef),
            at_end=np.ascontiguousarray(np.ones(s) @ powers),
            places=places,
            weights=1.0 / np.prod(gaps, axis=1),
            lengths=np.zeros(size),
            reach=np.zeros(size * 2 * modes * padded(s * outputs)),
            couple=np.zeros(size * s * inputs * padded(s * outputs)),
            decay=np.zeros(size * 2 * modes),
            push=np.zeros(size * s * inputs * padded(2 * modes)),
            miss=np.zeros(size * inputs),
            wider=np.linalg.inv(np.vander(places, s + 2, increasing=True)).ravel(),
            miss_within=np.zeros(size * inputs),
            graded=np.stack([near**CROWDED, 0.5 * weight * CROWDED * near ** (CROWDED - 1)]),
        )
        train, work = self._train(), self._work(0)
        for rung in range(how.rungs):
            length = model.period / model.mesh_periods / how.longest / 2.0**rung
            steps.fill(train, self.ladder, work, rung, length)

    def _train(self, turn: float = 0.0) -> k.Train:
        kinds, laws, rays, outer, wobbles, edges, guide, table, borders, broken = self._arrays
        numbers = self.numbers.copy()
        numbers[k.TURN] = turn
        return k.Train(
            sizes=self.sizes,
            numbers=numbers,
            lam=self.lam,
            into=self.into,
            out=self.out,
            offset=self.offset,
            kinds=kinds,
            laws=laws,
            rays=rays,
            outer=outer,
            wobbles=wobbles,
            edges=edges,
            guide=guide,
            table=table,
            borders=borders,
            broken=broken,
        )

    def _work(self, columns: int) -> steps.Work:
        _, s, outputs, inputs, _, count, _, span, wide, felt, *_ = (int(n) for n in self.sizes)
        c, big = max(columns, 1), s * outputs if columns else 1
        return steps.Work(
            counts=np.zeros(8, np.int64),
            spent=np.zeros(3),
            closed=np.zeros(2 + count, np.int64),
            held=np.zeros(2 + count, np.int64),
            phi=np.zeros(s + 4, complex),
            weight=np.zeros(s, complex),
            base=np.zeros(wide),
            y=np.zeros(wide),
            before=np.zeros(wide),
            ends=np.zeros(2 * felt),
            force=np.zeros(s * inputs),
            end_force=np.zeros(max(inputs, 8)),
            shape=np.zeros((s + 2) * inputs),
            values=np.zeros((s + 2) * 8),
            matrix=np.zeros((2 * s, 2 * s)),
            gaps=np.zeros(s + 2),
            trial=np.zeros(span),
            full=np.zeros(big * big),
            right=np.zeros(max(c * wide, 2 * s)),
            pushed=np.zeros(s * inputs),
            slope=np.zeros(s * (4 + 4 * count)),
            sample=np.zeros(span),
            added=np.zeros(4 * s),
            kept=np.zeros(8),
            pace=np.array([1.0, 0.0]),
            start_force=np.zeros(max(inputs, 8)),
            lacking=np.zeros(inputs),
            journal_x=np.zeros(s + 2),
            journal_y=np.zeros(s + 2),
            pieces=np.zeros(18),
            moments=np.zeros(4 * s),
            local=np.zeros(4),
        )

    def modal(self, states: ArrayLike) -> Floats:
        """Modal numbers (..., 2 modes) of physical states (..., d)."""
        return _split((np.asarray(states, dtype=float) - self.rest) @ self.to_modes.T)

    def physical(self, numbers: ArrayLike) -> Floats:
        """Physical states (..., d) of modal numbers (..., 2 modes)."""
        return np.asarray(self.rest + (_joined(numbers) @ self.from_modes.T).real)

    def run(
        self,
        start: ArrayLike,
        periods: int = 1,
        *,
        tangent: bool = False,
        directions: ArrayLike | None = None,
        samples: int = 0,
        turn: float = 0.0,
    ) -> Run:
        """Run ``periods`` mesh periods from the state ``start`` [m, m/s] (d,) at phase 0.

        ``tangent``: with the Jacobian; ``directions`` (count, d): with these tangent vectors alone.
        ``samples`` a period. ``turn``: whole mesh periods since the outer forces began. Raises
        ConvergenceError where the motion runs away.
        """
        d, span = self.model.dimension, padded(2 * self.lam.size)
        along = np.eye(d) if tangent else np.zeros((0, d))
        if directions is not None and not tangent:
            along = np.asarray(directions, dtype=float)
        columns = along.shape[0]
        state = np.zeros(span)
        state[: 2 * self.lam.size] = self.modal(np.asarray(start, dtype=float))
        bundle = np.zeros((max(columns, 1), span))
        if columns:
            bundle[:, : 2 * self.lam.size] = _split(along @ self.to_modes.T)
        flat = bundle.ravel()
        train, work = self._train(turn), self._work(columns)
        sections = np.zeros(periods * span)
        sampled = np.zeros(max(periods * samples * span, 1))
        times = np.zeros(periods)
        failed = advance(
            train,
            self.ladder,
            work,
            periods,
            samples,
            columns,
            state,
            flat,
            sections,
            sampled,
            times,
        )
        if failed:
            raise ConvergenceError(
                "drive train: the motion runs away; check stiffness, damping and torque"
            )
        turned = _joined(flat.reshape(-1, span)[:, : 2 * self.lam.size]) @ self.from_modes.T
        rows = sampled[: periods * samples * span].reshape(-1, span)[:, : 2 * self.lam.size]
        return Run(
            sections=self.physical(sections.reshape(-1, span)[:, : 2 * self.lam.size]),
            jacobian=np.ascontiguousarray(turned.real.T) if tangent else np.eye(d),
            directions=np.ascontiguousarray(turned.real[:columns]),
            samples=self.physical(rows),
            sample_phase=np.arange(periods * samples) / max(samples, 1),
            times=times,
            counts=dict(zip(COUNTS, work.counts.tolist(), strict=True)),
            shares=work.spent / max(work.spent.sum(), 1e-300),
        )


def padded(count: int) -> int:
    """The next multiple of eight."""
    return 8 * ((count + 7) // 8)


def _split(u: NDArray[np.complex128]) -> Floats:
    found = np.empty((*u.shape[:-1], 2 * u.shape[-1]))
    found[..., 0::2], found[..., 1::2] = u.real, u.imag
    return found


def _joined(numbers: ArrayLike) -> NDArray[np.complex128]:
    both = np.asarray(numbers, dtype=float)
    return np.asarray(both[..., 0::2] + 1j * both[..., 1::2])


def periodic_table(
    model: GearedEquation,
) -> tuple[Floats, NDArray[np.int64], Floats, Floats, NDArray[np.int64]]:
    """Edges of panels, the guide to them, polynomials, borders of steps, which functions jump.

    The polynomials (panel, power, function) are in the phase from the panel's middle; a border is
    where a function jumps.
    """
    own: list[tuple[int, Function]] = [
        (k.STIFFNESS, model.mesh_stiffness),
        (k.ERROR, model.error),
    ]
    if model.friction is not None:
        pairs = ((k.PITCH, model.friction_at_pitch), (k.METRE, model.friction_per_metre))
        own += [(place, Periodic(0.0) if one is None else one) for place, one in pairs]
    harmonics = max([len(one.harmonics) for _, one in own if isinstance(one, Periodic)], default=1)
    count = max(int(np.ceil(np.pi * max(harmonics, 1) / PANEL)), 4)
    starts = sorted({s for _, one in own if isinstance(one, Pieces) for s in one.starts} - {0.0})
    edges = np.unique(np.r_[np.linspace(0.0, 1.0, count + 1), starts])
    edges = edges[np.r_[True, np.diff(edges) > 1e-12]]
    edges[-1] = 1.0
    points = -0.5 * np.cos(np.pi * (np.arange(DEGREE + 1) + 0.5) / (DEGREE + 1))
    width = np.diff(edges)
    at = 0.5 * (edges[:-1] + edges[1:])[:, None] + width[:, None] * points
    fit = np.linalg.inv(np.vander(points, DEGREE + 1, increasing=True))
    table = np.zeros((width.size, DEGREE + 1, 8))
    scale, broken = width[:, None] ** -np.arange(DEGREE + 1.0), np.zeros(8, np.int64)
    for place, one in own:
        table[:, :, place] = (one(at) @ fit.T) * scale
        broken[place] = isinstance(one, Pieces)
    table[:, :, k.BACK_ERROR] = -table[:, :, k.ERROR]
    table[:, :-1, k.RATE] = table[:, 1:, k.ERROR] * np.arange(1.0, DEGREE + 1.0)
    guide = np.searchsorted(edges, np.arange(count) / count, side="right") - 1
    inner = [phase for phase in model.jumps if phase > 0.0]
    if not inner and any(isinstance(one, Pieces) for _, one in own):
        inner = [0.5]
    borders = np.array([*inner, 1.0])
    broken[[k.RATE, k.BACK_ERROR]] = broken[k.ERROR]
    return edges, guide.astype(np.int64), table.ravel(), borders, broken
