"""What a claim is, what judging one finds, and the four verdicts."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum

from thermogear.thesis.evidence import Evidence


class Verdict(StrEnum):
    """How a statement fares; the order is that of the counts."""

    REPRODUCED = "reproduced"
    ASSUMED = "reproduced under a stated assumption"
    UNDECIDED = "cannot be decided"
    CONTRADICTED = "contradicted"


KINDS = ("statement", "formula", "figure", "table entry")


@dataclass(frozen=True)
class Finding:
    """What the computation says about a claim.

    ``thesis``: the result as the thesis has it (its formula, its bundle, its reading);
    ``consistent``: the result where units, energy and limits close; ``argument``: why the
    verdict follows. All three carry numbers that were computed for this page.
    """

    thesis: str
    consistent: str
    verdict: Verdict
    argument: str


@dataclass(frozen=True)
class Claim:
    """One statement, formula, figure or table entry of the document.

    ``number`` identifies it and begins with the document's section; ``words`` are ours, never the
    document's; ``code`` names the functions and commands that give the result; ``picture`` the
    picture of the page that shows it.
    """

    number: str
    place: str
    kind: str
    words: str
    judge: Callable[[Evidence], Finding]
    code: tuple[str, ...]
    picture: str = ""

    @property
    def section(self) -> int:
        """The document's section, 2 to 6."""
        return int(self.number.split(".")[0])


def verdict_of(holds: bool, *, assumption: bool = False) -> Verdict:
    """Reproduced (with an assumption, if there is one) where it ``holds``, else contradicted."""
    if not holds:
        return Verdict.CONTRADICTED
    return Verdict.ASSUMED if assumption else Verdict.REPRODUCED


def listed(values: object, form: str = ".3g", unit: str = "") -> str:
    """Numbers of any array, comma separated, with their unit."""
    import numpy as np

    text = ", ".join(format(float(v), form) for v in np.ravel(np.asarray(values, dtype=float)))
    return f"{text} {unit}".strip()


def rising(values: object, least: float = 1e-9) -> str:
    """ "rises", "falls", "stays" or "rises and falls" along the last axis of every row."""
    import numpy as np

    rows = np.atleast_2d(np.asarray(values, dtype=float))
    steps = np.diff(rows, axis=-1) / np.abs(rows).max()
    if np.all(np.abs(steps) <= least):
        return "stays"
    if np.all(steps >= -least):
        return "rises"
    return "falls" if np.all(steps <= least) else "rises and falls"
