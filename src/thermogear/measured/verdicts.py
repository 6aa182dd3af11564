"""Which of several models is nearer to what was measured: row by row, and of heat over all rows.

The verdict follows the validation uncertainty of ASME V&V 20: u_val^2 = u_num^2 + u_input^2 +
u_D^2, and one model is better than another only where their errors differ by more than u_val, and
where the uncertainty of the measurement, and that of the inputs of a case, are stated as more than
zero.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

FAR = 1.0
"""Relative error beyond which no model is called better than another."""
HEAT = {"undeformed": "hot", "without heat": "with heat"}
"""Names of one model without heat and with it."""
LACKING = {
    "u_data": "undecided: the stated uncertainty of the measurement is zero",
    "u_input": "undecided: no tolerance of the case is stated, u_input is zero",
}
"""Why nothing can be decided: what an uncertainty of zero stands for is not known to be exact."""


@dataclass(frozen=True, kw_only=True)
class Row:
    """One quantity at one speed; uncertainties relative to ``measured`` (standard, k = 1).

    ``where`` an accelerometer sits and which of its lines it is, empty for the teeth's motion;
    ``record``: which of several it is of. ``computed``: by a case, whose fields have tolerances.
    """

    speed: float
    quantity: str
    measured: float
    simulated: tuple[float, ...]
    u_num: float = 0.0
    u_input: float = 0.0
    u_data: float = 0.0
    verdict: str = ""
    printed: tuple[str, ...] = ()
    where: str = ""
    record: str = ""
    computed: bool = False

    @property
    def lacking(self) -> str:
        """Why nothing can be decided of it; empty where its uncertainties are stated."""
        if self.u_data <= 0.0:
            return LACKING["u_data"]
        return LACKING["u_input"] if self.computed and self.u_input <= 0.0 else ""

    @property
    def errors(self) -> tuple[float, ...]:
        """(simulated - measured)/measured of every model."""
        return tuple(one / self.measured - 1.0 for one in self.simulated)

    @property
    def u_val(self) -> float:
        """Validation uncertainty, the root of the sum of squares."""
        return float(np.sqrt(self.u_num**2 + self.u_input**2 + self.u_data**2))


WITH_OR_WITHOUT = ("with heat", "without heat")
"""Verdicts on heat that decide."""


@dataclass(frozen=True, kw_only=True)
class Heat:
    """Whether a ``bundle`` is nearer to what is measured with heat, over all of its ``rows``.

    ``nearer``: rows in which it is; ``gain``: mean of |E without heat| - |E with heat|;
    ``u_val``: mean of the rows' u_val, as if all erred together, which is the most that the mean
    gain can be off. ``verdict``: "with heat", "without heat", or "undecided" within that, with the
    reason where nothing can be decided.
    """

    bundle: str
    rows: int
    nearer: int
    gain: float
    u_val: float
    verdict: str

    @property
    def words(self) -> str:
        """One sentence."""
        named = f"{self.bundle}: " if self.bundle else ""
        told = f"{self.verdict} is nearer" if self.verdict in WITH_OR_WITHOUT else self.verdict
        if not self.rows:
            return f"{named}{told}"
        return (
            f"{named}{told}; with heat nearer in {self.nearer} of {self.rows}, on the mean by "
            f"{100 * self.gain:.2f} % of what is measured, u_val {100 * self.u_val:.2f} %"
        )


def verdict(row: Row, names: Sequence[str]) -> str:
    """ "A better", "B better" or "not resolvable": |E_A| - |E_B| against u_val.

    Models that are all more than 100 % away describe something else: none is preferred. Nothing is
    decided where an uncertainty is stated as zero.
    """
    errors, u_val = row.errors, row.u_val
    if row.lacking:
        return row.lacking
    if len(errors) < 2:
        return "within u_val" if abs(errors[0]) <= u_val else "outside u_val"
    order = np.argsort(np.abs(errors), kind="stable")
    best, second = int(order[0]), int(order[1])
    if abs(errors[best]) > FAR:
        return "no preference: all are more than 100 % away"
    gap = abs(errors[second]) - abs(errors[best])
    return f"{names[best]} better" if gap > u_val else "not resolvable"


def heat_of(rows: Sequence[Row], models: Sequence[str]) -> tuple[Heat, ...]:
    """The verdict on heat of every bundle that ``models`` name without heat and with it."""
    return tuple(
        _heat(rows, before.strip(), models.index(before + cold), models.index(before + hot))
        for cold, hot in HEAT.items()
        for before in (name.removesuffix(cold) for name in models if name.endswith(cold))
        if before + hot in models
    )


def _heat(rows: Sequence[Row], bundle: str, cold: int, hot: int) -> Heat:
    """The models at places ``cold`` and ``hot`` against each other."""
    swings = [row for row in rows if row.quantity != "frequency"]
    near = [row for row in swings if min(abs(row.errors[k]) for k in (cold, hot)) <= FAR]
    known = [row for row in near if not row.lacking]
    gains = [abs(row.errors[cold]) - abs(row.errors[hot]) for row in known]
    gain, u_val = (float(np.mean(one)) if known else 0.0
                   for one in (gains, [row.u_val for row in known]))  # fmt: skip
    word = WITH_OR_WITHOUT[gain <= 0.0]
    if not near:
        word = "undecided: all are more than 100 % away"
    elif not known:
        word = near[0].lacking
    elif abs(gain) <= u_val:
        word = "undecided"
    nearer = sum(one > 0.0 for one in gains)
    return Heat(bundle=bundle, rows=len(known), nearer=nearer, gain=gain, u_val=u_val, verdict=word)
