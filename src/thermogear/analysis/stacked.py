"""Several maps of the same axes as one plan: one for each state of what does not vary in them."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from thermogear.analysis.maps import MapPlan
from thermogear.base.arrays import Dataset
from thermogear.base.errors import InputError
from thermogear.base.plan import Alive, Arrays, Coordinate, Key, Variable
from thermogear.base.progress import Progress

AXIS = "state"


@dataclass(frozen=True, kw_only=True)
class StackedPlan:
    """``plans`` over equal axes, each called one of the ``words``: a further axis "state" in front.

    Every chunk is a chunk of one of them, to the last bit.
    """

    plans: tuple[MapPlan, ...]
    words: tuple[str, ...]
    kind: str = "map"

    def __post_init__(self) -> None:
        if len(self.plans) != len(self.words) or not self.plans:
            raise InputError("words", list(self.words), allowed=f"{len(self.plans)}, one a plan")
        if any(one.sizes != self.plans[0].sizes for one in self.plans):
            raise InputError("plans", "other sizes", allowed="maps over the same axes")

    @property
    def sizes(self) -> dict[str, int]:
        return {AXIS: len(self.plans), **self.plans[0].sizes}

    @property
    def cuts(self) -> dict[str, int]:
        return {AXIS: 1, **self.plans[0].cuts}

    def inputs(self) -> dict[str, Any]:
        return {"states": list(self.words), "maps": [one.inputs() for one in self.plans]}

    def variables(self) -> dict[str, Variable]:
        own = self.plans[0].variables()
        return {name: replace(one, dims=(AXIS, *one.dims)) for name, one in own.items()}

    def coordinates(self) -> dict[str, Coordinate]:
        about = {"long_name": "state of heat", "names": json.dumps(list(self.words))}
        states: Coordinate = ((AXIS,), np.arange(len(self.plans)), about)
        return {AXIS: states, **self.plans[0].coordinates()}

    def needs(self, key: Key) -> Key | None:
        before = self.plans[key[0]].needs(key[1:])
        return None if before is None else (key[0], *before)

    def pilot(self, share: float, *, turn: int) -> float:
        """Compute about a ``share`` of the points, of one map a turn; what share it was."""
        place, count = turn % len(self.plans), len(self.plans)
        return self.plans[place].pilot(share * count, turn=turn // count) / count

    @property
    def visited(self) -> float:
        """Share of the points that is computed; where some are spared a guess."""
        return self.plans[0].visited

    def sparing(self) -> StackedPlan:
        """The same with points spared where neighbours are alike."""
        return replace(self, plans=tuple(one.sparing() for one in self.plans))

    def telling(self, stages: Progress) -> StackedPlan:
        """The same that tells ``stages`` what it does behind its chunks."""
        return replace(self, plans=tuple(one.telling(stages) for one in self.plans))

    def behind(self) -> str:
        """How long each border takes, in words, as of one map."""
        return self.plans[0].behind()

    def compute(self, key: Key, before: Arrays | None, alive: Alive) -> Arrays:
        inner = None if before is None else {name: v[0] for name, v in before.items()}
        found = self.plans[key[0]].compute(key[1:], inner, alive)
        return {name: values[None] for name, values in found.items()}

    def finish(self, data: Dataset) -> Dataset:
        whole = replace(self.plans[0], sheet=None).finish(data)
        whole.attrs["full_periods"] *= len(self.plans)
        return self.plans[0].bordered(whole, self.plans)
