"""The largest Lyapunov exponent along a trajectory, with its batch-means error.

One tangent vector travels along and is made unit every period; the mean of the logarithms of its
growth is the exponent (Benettin's method with one vector). Tangents are those of the variational
equations, so that no small distance has to be chosen. Its error is the standard error of the means
of batches, true if a batch is long beside the memory of the motion. A long chaotic transient looks
like chaos: the exponent is that of the stretch that was run.
Checked by ``tests/analysis/test_lyapunov.py``: closed orbits against their multipliers, chaos
against independent values.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.analysis.section import lanes_of, starts_of
from thermogear.analysis.settle import ALIGN
from thermogear.base.arrays import Floats
from thermogear.base.bounds import whole
from thermogear.base.errors import InputError
from thermogear.base.period import turns
from thermogear.dynamics.blocks import Pace, Progress, run_blocks
from thermogear.dynamics.bundle import Bundle, bundles
from thermogear.dynamics.lanes import Lanes
from thermogear.dynamics.models import ClearanceModel
from thermogear.dynamics.return_map import ReturnMap, return_map


@dataclass(frozen=True, kw_only=True)
class Lyapunov:
    """Largest exponent ``value`` per unit time with the standard ``error`` of its batch means.

    ``sum`` is that of all exponents: -c exactly of one mass, ln |det D P|/T of another model, nan
    where that is not known; ``batches`` the batch means,
    ``state`` the last state on the section.

    >>> model = TorsionalModel(
    ...     damping_ratio=0.05, frequency=0.5, stiffness_amplitude=0.0,
    ...     mean_force=0.1, force_amplitude=0.05,
    ... )
    >>> exponent = lyapunov_exponent(model, discard=100, batches=4, batch_periods=50)
    >>> f"{exponent.sum:.2f}"
    '-0.10'
    """

    value: float
    error: float
    sum: float
    batches: Floats
    state: Floats

    @property
    def second(self) -> float:
        """Of two exponents the other one: sum - value."""
        return self.sum - self.value

    @property
    def kaplan_yorke(self) -> float:
        """Kaplan-Yorke dimension on the section: 1 + value/|second|, 0 when not chaotic.

        Of states (x, x') alone; a longer state has more exponents than are known here.
        """
        return 0.0 if self.value <= 0.0 else 1.0 + self.value / abs(self.second)


def _block(
    prepared: Callable[[], Bundle],
    index: NDArray[np.int64],
    start: Floats,
    discard: int,
    means: Floats,
    ends: Floats,
    length: int,
    align: int,
    pace: Pace,
) -> None:
    mine = prepared()
    crowd = mine.crowd(start[index])
    for _, count in pace.chunks(discard, lanes=index.size):
        crowd.run(count)
    # the tangent turns into its own direction before it is counted
    crowd.aim()
    crowd.stretch(min(align, length))
    for batch in range(means.shape[1]):
        total = np.zeros(index.size)
        for _, count in pace.chunks(length, lanes=index.size):
            _, stretch = crowd.stretch(count)
            # one after the other, so that neither chunks nor company change the last bit
            total = np.cumsum(np.vstack([total, stretch]), axis=0)[-1]
        means[index, batch] = total / (length * mine.period)
    ends[index] = crowd.state


def lyapunov_exponents(
    model: object,
    *,
    initial_state: ArrayLike = (0.0, 0.0),
    discard: int = 2000,
    batches: int = 20,
    batch_periods: int = 1000,
    threads: int | None = None,
    progress: Progress | None = None,
    refine: int = 1,
) -> list[Lyapunov]:
    """:func:`lyapunov_exponent` of every lane of ``model``; ``refine`` times the sub-steps.

    Of lanes whose period is a turn ``discard`` and ``batch_periods`` are rounded up to turns.
    ``model`` may be a sequence of models with return maps, states of one length.
    """
    for name, value, least in (
        ("discard", discard, 0),
        ("batches", batches, 2),
        ("batch_periods", batch_periods, 1),
    ):
        whole(name, value, least=least)
    lanes = _many(model)
    if isinstance(lanes, Lanes):
        start = starts_of(initial_state, len(lanes))
        sums = -lanes.damping
    else:
        sections = [return_map(one) for one in lanes]
        start = starts_of(initial_state, len(lanes), dimension=sections[0].dimension)
        sums = np.array([np.log(abs(one.determinant(1))) / one.period for one in sections])
    # where a period is a turn, the counts of mesh periods are rounded up to turns
    of = lanes.mesh_periods if isinstance(lanes, Lanes) else 1
    discard, batch_periods, align = (turns(n, of=of) for n in (discard, batch_periods, ALIGN))
    means = np.full((len(lanes), batches), np.nan)
    ends = np.full(start.shape, np.nan)
    work = [
        partial(_block, prepared, index, start, discard, means, ends, batch_periods, align)
        for index, prepared in bundles(lanes, refine=refine)
    ]
    total = len(lanes) * (discard + batches * batch_periods)
    run_blocks(work, total, threads=threads, progress=progress)
    errors = means.std(axis=1, ddof=1) / np.sqrt(batches)
    return [
        Lyapunov(
            value=float(means[i].mean()),
            error=float(errors[i]),
            sum=float(sums[i]),
            batches=means[i],
            state=ends[i],
        )
        for i in range(len(lanes))
    ]


def lyapunov_exponent(
    model: object,
    *,
    initial_state: ArrayLike = (0.0, 0.0),
    discard: int = 2000,
    batches: int = 20,
    batch_periods: int = 1000,
    threads: int | None = None,
    progress: Progress | None = None,
) -> Lyapunov:
    """Largest Lyapunov exponent of the trajectory of one lane, or of a model with a return map.

    lambda_1 = lim ln|D P^n e|/(n T); the tangent vector follows the variational equations
    through every contact change (the saltation matrix is the identity) and is normalised every
    period. The mean of ``batches`` batches of ``batch_periods`` periods after ``discard``; the
    error is the standard error of the batch means. ``initial_state`` has the length of the model's
    states. Unit: one over the model's unit of time, 1 for :class:`TorsionalModel`, 1/s for a model
    in SI.

    >>> model = TorsionalModel(
    ...     damping_ratio=0.05, frequency=0.5, stiffness_amplitude=0.0,
    ...     mean_force=0.1, force_amplitude=0.05,
    ... )
    >>> start = (1.166, 0.002)
    >>> exponent = lyapunov_exponent(
    ...     model, initial_state=start, discard=100, batches=4, batch_periods=50
    ... )
    >>> f"{exponent.value:.3f}"
    '-0.050'
    """
    lanes = _many(model)
    if len(lanes) != 1:
        raise InputError("model", f"{len(lanes)} lanes", allowed="one lane; use the plural form")
    return lyapunov_exponents(
        lanes,
        initial_state=initial_state,
        discard=discard,
        batches=batches,
        batch_periods=batch_periods,
        threads=threads,
        progress=progress,
    )[0]


def _many(model: object) -> Lanes | Sequence[object]:
    """Its lanes; or the models themselves, one or a sequence, that have return maps."""
    if isinstance(model, list | tuple):
        return model
    return [model] if of_any_dimension(model) else lanes_of(model)


def of_any_dimension(model: object) -> bool:
    """Whether a model is no mass with clearance and has a return map."""
    return not isinstance(model, Lanes | ClearanceModel) and (
        isinstance(model, ReturnMap) or hasattr(model, "return_map")
    )
