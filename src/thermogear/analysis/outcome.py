"""What is stored of settled motions: names, types and meanings shared by maps and diagrams."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.analysis.family import taken
from thermogear.analysis.settle import LABELS, Rule, Settled, settle
from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError
from thermogear.base.plan import Alive, Arrays, Variable, keep_going
from thermogear.base.vocabulary import (
    FASTER_RULE,
    NO_COUNT,
    STATUS,
    STILL,
    moves,
    status_attributes,
)
from thermogear.dynamics.lanes import Lanes
from thermogear.dynamics.plane import plane_of

Models = Lanes | Sequence[object] | None

LABEL_ATTRIBUTES = {
    "long_name": "settled motion",
    "flag_values": np.arange(len(LABELS), dtype=np.int8),
    "flag_meanings": " ".join(LABELS),
    "comment": FASTER_RULE,
}
_NAN = float("nan")


def _real(words: str) -> tuple[str, float, dict[str, Any]]:
    """A pure number, nan where there is none."""
    return "float64", _NAN, {"long_name": words, "units": "1"}


VALUES: dict[str, tuple[str, float | int, dict[str, Any]]] = {
    "label": ("int8", 0, LABEL_ATTRIBUTES),
    "period": (
        "int32", 0, {"long_name": "mesh periods of the orbit, 0: none", "units": "1"} | NO_COUNT
    ),
    "multiplier_real": _real("largest Floquet multiplier of an orbit, real part; chaos has none"),
    "multiplier_imag": _real(
        "largest Floquet multiplier of an orbit, imaginary part; chaos has none"
    ),
    "lyapunov": (
        "float64", _NAN, {"long_name": "largest Lyapunov exponent", "units": "1", "symbol": "λ₁"}
    ),
    "lyapunov_error": _real("standard error of the Lyapunov exponent"),
    "contact_losses": _real("losses of drive contact per orbit"),
    "back_impacts": _real("back-side impacts per orbit"),
    "drive_share": _real("share of time in drive contact"),
    "back_share": _real("share of time in contact of the back flanks"),
    "point_x": _real("displacement of the orbit at phase 0"),
    "point_v": _real("velocity of the orbit at phase 0"),
    "used_periods": _real("mesh periods run for this point"),
    "status": ("int8", 0, status_attributes()),
}  # fmt: skip


def outcome_variables(dims: tuple[str, ...]) -> dict[str, Variable]:
    """The stored variables of settled motions over ``dims``."""
    return {n: Variable(dims, t, f, a) for n, (t, f, a) in VALUES.items()}


def require_free(names: Iterable[str], variables: Iterable[str]) -> None:
    """InputError where a parameter has the name of something that is stored over it."""
    for name in names:
        if name in {*variables, "direction", "start", "section", "coordinate"}:
            raise InputError(
                "parameter",
                repr(name),
                why="the result has something else of that name",
                fix="give the model a field with another name",
            )


def outcome_arrays(settled: Settled, status: NDArray[np.int8], lanes: Models = None) -> Arrays:
    """The stored arrays, flat over lanes; ``lanes`` draw the states of their models."""
    point = drawn(settled.point, lanes)
    done = status.copy()
    done[settled.label == LABELS.index("diverged")] = STATUS.index("diverged")
    lost = (settled.label == LABELS.index("undecided")) & moves(status)
    done[lost] = STATUS.index("not_converged")
    return {
        "label": settled.label,
        "period": settled.period,
        "multiplier_real": settled.multiplier[:, 0].real.copy(),
        "multiplier_imag": settled.multiplier[:, 0].imag.copy(),
        "lyapunov": settled.lyapunov,
        "lyapunov_error": settled.lyapunov_error,
        "contact_losses": settled.losses,
        "back_impacts": settled.impacts,
        "drive_share": settled.shares[:, 2].copy(),
        "back_share": settled.shares[:, 0].copy(),
        "point_x": point[:, 0].copy(),
        "point_v": point[:, 1].copy(),
        "used_periods": np.where(moves(status), settled.used, np.nan),
        "status": done,
    }


def drawn(states: Floats, lanes: Models) -> Floats:
    """(x, v) (lane, ..., 2) of states (lane, ..., d) by the plane of each lane's model."""
    if lanes is None or isinstance(lanes, Lanes):
        return states
    found = np.full((*states.shape[:-1], 2), np.nan)
    for place, model in enumerate(lanes):
        if model is not None:
            found[place] = plane_of(model).of(states[place])
    return found


def begun(starts: Floats, lanes: Models, dimension: int) -> Floats:
    """States (lane, d) of ``starts`` (lane, 2) in the planes of the lanes' models, or as given."""
    if starts.shape[1] == dimension or lanes is None or isinstance(lanes, Lanes):
        return starts
    found = np.zeros((len(starts), dimension))
    for place, model in enumerate(lanes):
        if model is not None:
            found[place] = plane_of(model).starts(starts[place])
    return found


def started(status: NDArray[np.int8], start: Floats, keep: int = 0) -> Settled:
    """Nothing known yet of motions from ``start`` (lane, d), but of those that stay still, why."""
    result = Settled.empty(len(start), keep=keep, dimension=start.shape[1])
    result.state[:] = start
    for word in STILL:
        result.label[status == STATUS.index(word)] = LABELS.index(word)
    return result


def settle_with_status(
    lanes: Lanes | Sequence[object],
    status: NDArray[np.int8],
    start: Floats,
    rule: Rule,
    keep: int = 0,
    alive: Alive = keep_going,
) -> Settled:
    """:func:`settle` for the lanes that move; the others carry their status as a label."""
    result = started(status, start, keep)
    moving = np.flatnonzero(moves(status))
    if moving.size:
        result.put(moving, settle(taken(lanes, moving), start[moving], rule, keep, alive))
    return result


def start_of(initial_state: ArrayLike, dimension: int = 2) -> tuple[float, ...]:
    """One start: (x, x'), or a whole state."""
    state = np.asarray(initial_state, dtype=float)
    if state.shape not in ((2,), (dimension,)) or not np.all(np.isfinite(state)):
        whole = f", or {dimension}" * (dimension != 2)
        raise InputError(
            "initial_state", state.tolist(), allowed=f"two finite numbers (x, x'){whole}"
        )
    return tuple(state.tolist())
