"""How hot the gears are: the one type that says it, in files, commands, calls and results."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from thermogear.base import vocabulary
from thermogear.base.arrays import Dataset
from thermogear.base.errors import InputError
from thermogear.base.units import ZERO_CELSIUS
from thermogear.base.vocabulary import HEAT_NOT_SETTLED, still
from thermogear.case.allowed import within
from thermogear.case.case import GearCase
from thermogear.case.fields import BODY
from thermogear.case.units import read_quantity
from thermogear.gears.contact import path_of_contact
from thermogear.mesh.balance import HeatBalance
from thermogear.mesh.balance_table import OF_OIL, STATED, blanked
from thermogear.mesh.cycle import Cycle
from thermogear.mesh.model import MeshModel
from thermogear.mesh.operating import Operating
from thermogear.mesh.thermal import HotPair

ALLOWED = "undeformed | hot | computed | degrees Celsius"


@dataclass(frozen=True)
class ThermalState:
    """A state of heat of a gear pair.

    ``kind`` "undeformed": the drawing's sizes, oil as in operation; "hot": as the case says, its
    temperatures given or computed; "computed": from the heat balance, whatever the case gives;
    "at": both addenda at ``temperature`` [K], the rest as ``temperatures.follow`` says; "held": as
    hot as the operating point ``held``, at any speed and torque.

    >>> ThermalState().kind
    'hot'
    """

    kind: str = vocabulary.HOT
    temperature: float | None = None
    held: Operating | None = field(default=None, repr=False, compare=False)

    @classmethod
    def at(cls, temperature: float, option: str = "state") -> ThermalState:
        """Both addenda at ``temperature`` [K]; InputError where no case file could say it."""
        within(option, BODY, temperature)
        return cls("at", float(temperature))

    @classmethod
    def of(cls, given: StateLike) -> ThermalState:
        """The state that a caller means: one of these, a word, kelvins, or None: undeformed."""
        if isinstance(given, ThermalState):
            return given
        if given is None:
            return UNDEFORMED
        if isinstance(given, float | int | np.number) and not isinstance(given, bool):
            return cls("at", float(given))
        if given not in list(BY_WORD):
            raise InputError("state", repr(given), allowed=" | ".join((*BY_WORD, "kelvins")))
        return BY_WORD[given]

    @classmethod
    def parse(cls, text: str, option: str = "state") -> ThermalState:
        """What a person writes: a word, or degrees Celsius, with a unit or without."""
        word = text.strip()
        if word in BY_WORD:
            return BY_WORD[word]
        try:
            kelvins = float(word) + ZERO_CELSIUS
        except ValueError:
            kelvins = _degrees(word, option)
        return cls.at(kelvins, option)

    @property
    def stored(self) -> str | float:
        """The state as results and stores name it: a word or kelvins."""
        return self.kind if self.temperature is None else self.temperature

    @property
    def words(self) -> str:
        """The state as a reader sees it."""
        if self.temperature is None:
            return self.kind
        return f"gears at {self.temperature - ZERO_CELSIUS:.6g} °C"

    def operating(self, case: GearCase, model: MeshModel) -> Operating:
        """Every operating point of ``case`` in this state under ``model``."""
        if self.held is not None:
            at = case.stated
            held = {n: getattr(at, n) for n in ("speed", "torque", "half_backlash", "varied")}
            return replace(self.held, **held)
        if self.temperature is not None:
            return case.operating_at(self.temperature, model)
        hot = case.balance(model).operating if self == COMPUTED else case.operating_of(model)
        return hot.as_drawn() if self == UNDEFORMED else hot

    def moving(self, case: GearCase, model: MeshModel) -> Operating:
        """:meth:`operating` as far as the teeth feel it: no balance for undeformed gears' oil."""
        return case.stated.as_drawn() if self == UNDEFORMED else self.operating(case, model)

    def hangs_on_the_load(self, case: GearCase) -> bool:
        """Whether another speed or torque makes it another temperature."""
        if self.held is not None or self == UNDEFORMED:
            return False
        return case.computed or self == COMPUTED

    def balance(
        self, case: GearCase, model: MeshModel, *, from_hot: bool = True
    ) -> HeatBalance | None:
        """The heat balance behind its temperatures; None where they are given.

        ``from_hot`` as of :meth:`~thermogear.case.case.GearCase.balance`.
        """
        if self != COMPUTED and not case.computed:
            return None
        teeth = None if case.follow == "proportional" else self.temperature
        return case.balance(model, teeth, from_hot=from_hot)

    def open(
        self, case: GearCase, balance: HeatBalance, *, given: bool = False
    ) -> NDArray[np.bool_]:
        """Where ``balance`` leaves the temperatures open, (operating,).

        Temperatures that are ``given`` ask a balance at most for the proportions of the other
        bodies to the gears (``follow`` "proportional"): its last nodes say them, steady or not.
        """
        fixed = not given and self.temperature is None
        return ~balance.settled if fixed or case.follow != "proportional" else balance.unknown

    def settled(self, case: GearCase, model: MeshModel, place: int | slice = 0) -> bool:
        """Whether the temperatures of the operating point ``place``, or of all, are known."""
        balance = None if self == UNDEFORMED else self.balance(case, model)
        return balance is None or not np.any(self.open(case, balance)[place])

    def require_settled(self, case: GearCase, model: MeshModel, place: int | slice = 0) -> None:
        """InputError where they are not."""
        if not self.settled(case, model, place):
            raise still(HEAT_NOT_SETTLED, self.words)

    def cycle(self, case: GearCase, model: MeshModel) -> Dataset:
        """The mesh cycle of every operating point, nan where nothing is known of its temperatures.

        Points are heat_not_settled where these are open; undeformed gears ask only for the oil's.
        """
        cycle = case.cycle(self.operating(case, model), model)
        balance = self.balance(case, model)
        if balance is None:
            return cycle
        lost = self.open(case, balance)
        if self == UNDEFORMED:
            return blanked(cycle, lost, OF_OIL)
        status = cycle["status"]
        values = np.where(lost, HEAT_NOT_SETTLED, status.values)
        kept = cycle.assign(status=(status.dims, values.astype(np.int8), status.attrs))
        return blanked(kept, lost)

    def quantities(
        self, case: GearCase, model: MeshModel, want: Sequence[str]
    ) -> dict[str, NDArray[Any]]:
        """What :meth:`cycle` holds of ``want``, of the points and the status, as bare arrays."""
        at = replace(self.operating(case, model), housing=case.housing)
        s = path_of_contact(case.pair, case.path_positions)
        cycle = Cycle(HotPair(case.pair, at, model), case.deviations, s, case.mesh_positions)
        found = {name: np.asarray(values) for name, values in cycle.quantities(want).items()}
        found |= {"pinion_speed": at.speed, "pinion_torque": at.torque}
        balance = self.balance(case, model)
        if balance is None:
            return found
        lost = self.open(case, balance)
        if self != UNDEFORMED:
            found["status"] = np.where(lost, HEAT_NOT_SETTLED, found["status"]).astype(np.int8)
        return found | unknown_where(lost, found, OF_OIL if self == UNDEFORMED else want)


def unknown_where(
    lost: NDArray[np.bool_], found: Mapping[str, NDArray[Any]], names: Iterable[str]
) -> dict[str, NDArray[Any]]:
    """The numbers ``names`` of a cycle, nan at the points that are ``lost``."""
    return {
        name: np.where(lost.reshape(-1, *(1,) * (found[name].ndim - 1)), np.nan, found[name])
        for name in names
        if name in found and name not in STATED and found[name].dtype.kind == "f"
    }


StateLike: TypeAlias = "ThermalState | str | float | None"
"""What public functions take for a state: the words "hot", "undeformed", or kelvins."""


def _degrees(text: str, option: str) -> float:
    """A temperature with its unit as K."""
    fix = '"cold" is now called "undeformed"' if text == "cold" else None
    if not any(letter.isdigit() for letter in text):
        raise InputError(option, repr(text), allowed=ALLOWED, fix=fix)
    try:
        return read_quantity(text, "temperature")
    except InputError as error:
        raise InputError(
            option, repr(text), allowed=ALLOWED, why=error.why, fix=error.fix
        ) from error


UNDEFORMED = ThermalState(vocabulary.UNDEFORMED)
HOT = ThermalState(vocabulary.HOT)
COMPUTED = ThermalState("computed")
BY_WORD = {one.kind: one for one in (HOT, UNDEFORMED, COMPUTED)}
