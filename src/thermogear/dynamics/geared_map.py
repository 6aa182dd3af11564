"""The return map of a drive train: its state at mesh phase 0, one cycle of its forces later."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import ClassVar

import numpy as np

from thermogear.base.arrays import Floats
from thermogear.dynamics.extremes import WATCHED, Extremes, extremes_of
from thermogear.dynamics.geared_equation import GearedEquation
from thermogear.dynamics.ladder import Engine, Steps
from thermogear.dynamics.plane import Plane
from thermogear.dynamics.return_map import StateMap, Stretch, Visit

MICROMETRE = 1e-6


@dataclass(frozen=True, eq=False, kw_only=True)
class GearedMap(StateMap):
    """P of a :class:`~thermogear.dynamics.geared_equation.GearedEquation`, by its engine.

    The state (q, q') is that of the model; a period is its ``cycle`` of mesh periods, one without
    forces at shaft orders. ``samples`` a mesh period of what a visit records.
    """

    model: GearedEquation
    how: Steps = field(default_factory=Steps)
    samples: int = 0
    concurrent: ClassVar[bool] = True
    """Runs of several states may go on threads: each has its own memory, and no lock is held."""

    @cached_property
    def engine(self) -> Engine:
        """The tables of the steps."""
        return Engine(self.model, self.how)

    @property
    def period(self) -> float:
        """Duration of one application [s]."""
        return self.model.cycle * self.model.period

    @cached_property
    def finer(self) -> GearedMap:
        """The same map by finer steps: what both differ by is the error of this one."""
        how = self.how
        steps = replace(
            how, accuracy=0.01 * how.accuracy, longest=2 * how.longest, rungs=how.rungs + 2
        )
        return GearedMap(model=self.model, how=steps, samples=self.samples)

    @cached_property
    def slowest(self) -> float:
        """Largest multiplier of one application with the drive flank and the bearings closed.

        What the rule of labels asks any map for, by this name
        (:func:`~thermogear.analysis.any_motion.settle`).
        """
        return float(np.exp(self.engine.lam.real.max() * self.period))

    @cached_property
    def unit(self) -> Floats:  # type: ignore[override]  # made when first asked for
        """Scales of a state: what moves the mesh by a half backlash, 2 pi/T times that for q'.

        A coordinate's scale is b' times its share in the shape that the mesh force pulls the train
        into, at least a thousandth of the largest by mass.
        """
        model = self.model
        n, b = model.size, model.half_backlash
        mass = np.sqrt(np.abs(np.diag(model.mass)))
        inertia = float(model.drive @ np.linalg.solve(model.mass, model.drive))
        # of all shapes with the energy of the pair moving by b'
        size = b / np.sqrt(inertia) / mass
        found = np.concatenate([size, 2.0 * np.pi / model.period * size])
        if model.slip is not None:
            vector, fall, _ = model.slip
            speed = float(np.abs(vector) @ found[n : 2 * n])
            found = np.append(found, max(fall * speed, 1e-12))
        return found

    @cached_property
    def plane(self) -> Plane:
        """What is drawn: the teeth's deflection over b' and its rate over 2 pi b'/T.

        A start moves the train as a blow of the teeth would, from where it rests under its
        constant loads with the drive flank and the bearings closed. Where the model names a
        journal, its two displacements in micrometres; a start pushes the train there.
        """
        model = self.model
        pull = np.zeros(model.dimension)
        pull[model.size : 2 * model.size] = np.linalg.solve(model.mass, model.force)
        rest = np.asarray(-np.linalg.solve(model.state_matrix, pull), dtype=float)
        if model.seen is not None:
            return _of_journal(model, model.seen, rest)
        n, b = model.size, model.half_backlash
        rate = 2.0 * np.pi * b / model.period
        onto = np.zeros((2, model.dimension))
        onto[0, :n], onto[1, n : 2 * n] = model.drive / b, model.drive / rate
        shape = np.linalg.solve(model.mass, model.drive)
        shape = shape / float(model.drive @ shape)
        lift = np.zeros((model.dimension, 2))
        lift[:n, 0], lift[n : 2 * n, 1] = b * shape, rate * shape
        return Plane(onto=onto, lift=lift, rest=rest, unit=np.ones(2), scale=(b, rate))

    def determinant(self, periods: int) -> float:
        """det D P^n = exp(T tr A), whatever the contacts do."""
        return self.model.determinant(periods * self.model.cycle)

    def carry(self, start: Floats, periods: int, *, turn: int = 0) -> Floats:
        """The states (periods, d) after 1, 2, ... cycles from ``start``.

        ``turn``: mesh periods gone before, which what never comes again has to know.
        """
        cycle = self.model.cycle
        run = self.engine.run(start, periods * cycle, turn=turn)
        return run.sections[cycle - 1 :: cycle]

    def stretch(self, start: Floats, *, direction: Floats, periods: int) -> Stretch:
        """Carry ``start`` and a tangent vector ``direction``, made unit after every cycle."""
        state = np.asarray(start, dtype=float)
        along = np.asarray(direction, dtype=float) / self.unit
        along = along / np.linalg.norm(along)
        growth = np.zeros(periods)
        for number in range(periods):
            run = self.engine.run(state, self.model.cycle, directions=along[None] * self.unit)
            along = run.directions[0] / self.unit
            size = float(np.linalg.norm(along))
            growth[number], along, state = np.log(size), along / size, run.state
        return Stretch(state=state, direction=along * self.unit, growth=growth)

    def spread(self, start: Floats, *, directions: Floats) -> tuple[Floats, Floats]:
        """State (d,) and tangent vectors (d, count) one cycle later."""
        run = self.engine.run(start, self.model.cycle, directions=directions.T)
        return run.state, run.directions.T

    def visit(self, start: Floats, periods: int = 1, *, sampled: bool = False) -> Visit:
        """Run ``periods`` cycles from ``start`` with the variational equations."""
        cycle = self.model.cycle
        run = self.engine.run(
            start, periods * cycle, tangent=True, samples=self.samples if sampled else 0
        )
        points = np.vstack([np.asarray(start, dtype=float)[None], run.sections[cycle - 1 :: cycle]])
        return Visit(
            points=points,
            jacobian=run.jacobian,
            contact_losses=run.counts["losses"],
            back_impacts=run.counts["impacts"],
            shares=run.shares,
            samples=run.samples,
        )

    def extremes(self, start: Floats, periods: int) -> Extremes:
        """Extremes of the depths of flanks and bearings along the closed orbit from ``start``."""
        model, n = self.model, self.model.size
        whole = periods * model.cycle
        run = self.engine.run(start, whole, samples=WATCHED)
        bend = model.forces(run.sample_phase, states=run.samples)["acceleration"]
        step = model.period / WATCHED
        motion = np.stack(
            [run.samples[:, :n], step * run.samples[:, n : 2 * n], step**2 * bend]
        ) @ model.outputs.T  # fmt: skip

        def depths(displacements: Floats, phase: Floats) -> Floats:
            return model.depths(displacements, phase * model.cycle) / model.half_backlash

        return extremes_of(motion, depths, periods=periods)


def _of_journal(model: GearedEquation, seen: Floats, rest: Floats) -> Plane:
    """(u_x, u_y) of a journal [um], in shapes that move it against the least inertia."""
    n = model.size
    onto, lift = np.zeros((2, model.dimension)), np.zeros((model.dimension, 2))
    onto[:, :n] = seen.T / MICROMETRE
    shape = np.linalg.solve(model.mass, seen)
    lift[:n] = MICROMETRE * shape @ np.linalg.inv(seen.T @ shape)
    words = (("displacement of the journal along x", "um"), ("along y", "um"))
    return Plane(onto=onto, lift=lift, rest=rest, unit=np.ones(2), words=words)
