"""The load-shared mesh force: every tooth pair a spring of its own, drive and back flanks."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from thermogear.base.arrays import Dataset, Floats
from thermogear.base.errors import InputError
from thermogear.base.excitation import Excitation, Periodic
from thermogear.base.pair_springs import PairSprings
from thermogear.dynamics.kernels.shared import advance_shared
from thermogear.dynamics.models import require_finite
from thermogear.dynamics.outcome import Result, dataset

NO_ERROR = Periodic(0.0)


@dataclass(frozen=True, eq=False)
class LoadSharedModel:
    """Relative motion under a mesh force shared pair by pair (SI).

    m y'' + c y' + sum_j k_j(phi) <y - b + S_j(phi)>_+
                 - sum_j k_j^c(phi) <-y - b + S_j^c(phi)>_+ = F(phi),

    between first touch and knee as :class:`PairSprings` says.

    y [m] displacement of the pinion's base circle over the wheel's less the kinematic error,
    positive on the drive side; ``half_backlash`` b [m] the cold one, because heat is in
    S_j as a deviation; ``mass`` m [kg], ``damping`` c [N s/m], ``mesh_frequency`` [rad/s],
    ``force`` F [N] with -m e'' of the kinematic error in it; ``drive`` and ``back`` flanks.
    Where the one-spring form opens and closes the whole mesh at once, here pairs touch and
    leave by themselves: the stiffness depends on the load.
    """

    mass: float
    damping: float
    mesh_frequency: float
    half_backlash: float
    force: Periodic
    drive: PairSprings
    back: PairSprings

    def __post_init__(self) -> None:
        for name in ("mass", "mesh_frequency", "half_backlash", "damping"):
            require_finite(self, name, positive=name != "damping", floor=True)

    @classmethod
    def from_excitation(
        cls,
        excitation: Excitation,
        drive: PairSprings,
        back: PairSprings,
        error: Periodic = NO_ERROR,
    ) -> LoadSharedModel:
        """The pairs' springs on the masses, damping and load of ``excitation``.

        ``error`` the kinematic error [m] alone: what deviations and heat do is in the
        springs. The excitation's own stiffness gives no more than c = 2 zeta sqrt(k_m m_e).
        Raises InputError where it repeats after a turn.
        """
        if excitation.mesh_periods > 1:
            raise InputError(
                "mesh_periods",
                excitation.mesh_periods,
                allowed="1: the springs of the tooth pairs are those of one mesh period",
                fix="take the teeth as alike: gears.period = 'mesh'",
            )
        mass = excitation.equivalent_mass
        turn = excitation.mesh_frequency / (2.0 * np.pi)
        return cls(
            mass,
            2.0 * excitation.damping_ratio * mass * excitation.natural_frequency,
            excitation.mesh_frequency,
            excitation.reference_half_backlash,
            error.derivative(2) * (-mass * turn**2) + excitation.mean_force,
            drive,
            back,
        )

    @property
    def period(self) -> float:
        """Mesh period [s]."""
        return 2.0 * np.pi / self.mesh_frequency

    def mesh_force(self, y: ArrayLike, phase: ArrayLike) -> Floats:
        """Force of the teeth [N] at ``y`` [m] and mesh ``phase``; negative on the back flanks."""
        x, b = np.asarray(y, dtype=float), self.half_backlash
        return self.drive.force(x - b, phase) - self.back.force(-x - b, phase)

    def clearance(self, phase: ArrayLike) -> Floats:
        """Free play 2 b' [m] between both flanks' first touches at ``phase``; <= 0 is jammed."""
        return 2.0 * self.half_backlash + self.drive.touch(phase) + self.back.touch(phase)

    def derivative(self, t: float, y: ArrayLike) -> Floats:
        """(y', y'') of the state ``y`` = (y, y'), first axis the component."""
        x, v = np.asarray(y, dtype=float)
        phase = np.asarray(t / self.period)
        pull = self.force(phase) - self.damping * v - self.mesh_force(x, phase)
        return np.stack(np.broadcast_arrays(v, pull / self.mass))

    def rest(self, phase: float = 0.0) -> float:
        """y [m] at which the pairs carry the mean force at ``phase``: where to start."""
        load = self.force.mean
        if load == 0.0:
            return self.half_backlash
        springs, side = (self.drive, 1.0) if load > 0.0 else (self.back, -1.0)
        return side * (float(springs.deflection(abs(load), phase)) + self.half_backlash)


def simulate_shared(
    model: LoadSharedModel, start: Floats, *, periods: int, discard: int, steps: int, samples: int
) -> Dataset:
    """Classical Runge-Kutta steps of ``model`` from (y, y'); see ``simulate``."""
    if start.shape != (2,):
        raise InputError("initial_state", f"shape {start.shape}", allowed="(y, y')")
    phase = np.arange(2 * steps) / (2 * steps)
    sides = (model.drive, model.back)
    drive, back = (np.ascontiguousarray(side.at(phase)) for side in sides)
    drive_stretch, back_stretch = (np.ascontiguousarray(side.stretch_at(phase)) for side in sides)
    constants = np.array([model.mass, model.damping, model.half_backlash])
    state = np.array(start, dtype=float)
    result = Result(lanes=1, periods=periods, samples=samples)
    stride = steps // samples if samples else 1
    none = np.empty((0, 2))
    counts, spent = np.zeros(2, np.int64), np.zeros(3)
    for length, path in ((discard, none), (periods, np.empty((periods * samples, 2)))):
        counts[:] = 0
        spent[:] = 0.0
        sections = np.empty((length, 2))
        first = state.copy()
        advance_shared(
            drive,
            back,
            drive_stretch,
            back_stretch,
            model.force(phase),
            constants,
            model.period / steps,
            state,
            sections,
            path,
            stride,
            counts,
            spent,
        )
    result.sections[0] = np.vstack([first, sections]).T
    result.samples[0] = path.T
    result.losses[0], result.impacts[0] = counts
    result.shares[0] = spent / spent.sum()
    result.substeps[0] = steps
    return dataset(
        result, period=np.array([model.period]), periods=periods, discard=discard, samples=samples
    )
