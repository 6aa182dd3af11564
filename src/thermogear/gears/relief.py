"""Tip relief that makes the loaded mesh run evenly at one load and temperature."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from thermogear.base.arrays import Floats
from thermogear.base.bounds import RELIEF_AMOUNT, RELIEF_LENGTH
from thermogear.base.errors import InputError
from thermogear.gears.candidates import mesh_points
from thermogear.gears.deviations import (
    GEARS,
    Contacts,
    Deviation,
    FlankShape,
    Relief,
    active_profile,
)
from thermogear.gears.loaded import LoadedModel, solve_mesh
from thermogear.gears.pair import GearPair
from thermogear.gears.stiffness import Moduli

_SHORTEST = 0.05  # base pitches
PLACES = 10
"""Places of the screening that are refined."""
STARTS = 2
"""Of these, the best from which the simplex goes on with the first touch."""
MOST_EVALUATIONS = 120
"""Evaluations of the mesh period from one of them, at most."""
_EDGE = 0.05
"""Edge of the first simplex, part of the bounds; places nearer to each other count as one."""


@dataclass(frozen=True, eq=False)
class _Asked:
    """A deviation's gap [m] at the only contacts that it is asked for."""

    values: Floats

    def gap(self, _: Contacts) -> Floats:
        """e [m], (..., position, pair)."""
        return self.values


def _at_nominal(depth: Floats, amount: Floats, length: Floats, shape: str) -> _Asked:
    """Tip reliefs of many cases that count at the nominal point of contact, without a search.

    amount, length [m]: (case, gear); depth [m]: contacts outside the start of the tip, (gear,
    position, pair). Next to the first touch, which a relief moves along the flank, the
    peak-to-peak error is off by some per cent, at a twentieth of the time.
    """
    x = np.minimum(np.maximum(1.0 + depth / length[..., None, None], 0.0), 1.0)
    x = x if shape == "linear" else x * x
    return _Asked(np.asarray((amount[..., None, None] * x).sum(axis=1)))


@dataclass(frozen=True, kw_only=True)
class ReliefDesign:
    """The relief found and the peak-to-peak transmission error [m] without and with it."""

    pinion: Relief
    wheel: Relief
    unrelieved: float
    relieved: float
    evaluations: int


def optimise_tip_relief(
    pair: GearPair,
    normal_force: float,
    *,
    pinion: Moduli | None = None,
    wheel: Moduli | None = None,
    deviations: Sequence[Deviation] = (),
    model: LoadedModel | None = None,
    shape: str = "linear",
    largest: float | None = None,
    positions: int = 100,
    symmetric: bool = False,
    evaluations: int = MOST_EVALUATIONS,
    progress: Callable[[int], None] | None = None,
) -> ReliefDesign:
    """Amount and length of the tip relief of both gears with the least peak-to-peak error.

    Minimises max - min of the static transmission error over one mesh period, which has many
    minima. Differential evolution, always with the same random numbers, screens the whole range
    with reliefs that count at the nominal point of contact. Nelder and Mead's simplex (the peak
    is not smooth) refines its best places, each with the difference of the curves that the first
    touch makes there, and the best of these with the first touch itself. The least minimum seen
    is returned, or no relief at all where that is better; a proof that none is less there is not.
    Source of the screening: Storn & Price 1997.

    normal_force: F_n [N] > 0; moduli and deviations (for example the hot pair's base-pitch
    difference) as :func:`loaded_contact`, without leading axes; shape: "linear" or "parabolic";
    largest: greatest amount [m], default three times the unrelieved error's mean height over its
    least value plus its peak-to-peak value; positions: of the mesh period; symmetric: both gears
    with one amount and one length; evaluations: of one simplex, at most; progress: called
    with the curves of first touch so far. Lengths are between 0.05 base pitches and the active
    profile, amounts and lengths within what a :class:`Relief` and a case file take.

    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> design = optimise_tip_relief(pair, 4e3, positions=16, symmetric=True, evaluations=20)
    >>> design.relieved < design.unrelieved
    True
    """
    if not (np.isfinite(normal_force) and normal_force > 0.0):
        raise InputError("normal_force", f"{normal_force} N", allowed="> 0, finite")
    phase, model = np.arange(positions) / positions, model or LoadedModel()

    def error(step: int, with_these: Sequence[Deviation]) -> Floats:
        return (
            solve_mesh(
                pair,
                normal_force,
                phase[::step],
                pinion=pinion,
                wheel=wheel,
                deviations=with_these,
                model=model,
            )
            .checked()
            .deflection
        )

    plain = error(1, deviations)
    contacts = {
        step: mesh_points(pair, phase[::step], "drive", model.extended).contacts for step in (1, 2)
    }
    # heat and pitch errors count at the nominal point, which no relief moves
    kept = {
        step: [d if isinstance(d, FlankShape) else _Asked(d.gap(at)) for d in deviations]
        for step, at in contacts.items()
    }
    depth = {
        step: np.stack([at.string(g) - active_profile(pair, g)[2] for g in GEARS])
        for step, at in contacts.items()
    }
    unrelieved = float(np.ptp(plain))
    most = 3.0 * float(plain.mean() - plain.min() + np.ptp(plain)) if largest is None else largest
    # as a case file has it, to a nanometre, it is still no longer than the active profile
    shortest, longest = (
        max(_SHORTEST * pair.base_pitch, RELIEF_LENGTH.least),
        1e-9 * np.floor(1e9 * (pair.path.e - pair.path.a)),
    )

    def sizes(x: Floats) -> tuple[Floats, Floats]:
        whole = np.clip(np.repeat(x, 2, axis=-1) if symmetric else x, 0.0, 1.0)
        return min(most, RELIEF_AMOUNT.most) * whole[..., :2], shortest + (
            longest - shortest
        ) * whole[..., 2:]

    def reliefs(x: Floats) -> list[Relief]:
        return [
            Relief(gear, amount=float(amount), length=float(length), shape=shape)
            for gear, amount, length in zip(GEARS, *sizes(x), strict=True)
        ]

    done = 1

    def curve(x: Floats) -> Floats:
        nonlocal done
        done += 1
        if progress is not None:
            progress(done)
        return error(1, [*kept[1], *reliefs(x)])

    def rough(x: Floats, step: int = 1) -> Floats:
        amounts, lengths = sizes(np.atleast_2d(x))
        return error(step, [*kept[step], _at_nominal(depth[step], amounts, lengths, shape)])

    from scipy.optimize import differential_evolution, minimize

    bounds = [(0.0, 1.0)] * (2 if symmetric else 4)

    def refined(start: Floats, model: Callable[[Floats], Floats], shift: Floats | float) -> Any:
        return minimize(
            lambda x: np.ptp(model(x) + shift),
            start,
            method="Nelder-Mead",
            bounds=bounds,
            options={
                "xatol": 1e-3,
                "fatol": 1e-4 * unrelieved,
                "maxfev": evaluations,
                "initial_simplex": start
                + np.vstack([0.0 * start, np.diag(np.where(start < 0.5, _EDGE, -_EDGE))]),
            },
        )

    screened = differential_evolution(
        lambda x: np.ptp(rough(x.T, 2), axis=-1),
        bounds,
        strategy="rand1bin",
        mutation=0.5,
        popsize=64,
        maxiter=25,
        init="sobol",
        rng=1,
        polish=False,
        updating="deferred",
        vectorized=True,
    )
    places: list[Floats] = []
    for x in screened.population[np.argsort(screened.population_energies)]:
        if len(places) < PLACES and all(np.abs(x - other).max() > _EDGE for other in places):
            places.append(x)
    starts = sorted(
        (refined(x, rough, curve(x) - rough(x)).x for x in places),
        key=lambda x: float(np.ptp(curve(x))),
    )[:STARTS]
    least = min((refined(x, curve, 0.0) for x in starts), key=lambda r: float(r.fun))
    one, two = reliefs(least.x if least.fun < unrelieved else 0.0 * least.x)
    return ReliefDesign(
        pinion=one,
        wheel=two,
        unrelieved=unrelieved,
        relieved=min(float(least.fun), unrelieved),
        evaluations=done,
    )
