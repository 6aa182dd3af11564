"""Hypotheses on the teeth behind a record's lines, and the evidence for each.

A hypothesis foretells lines: a mesh line and its harmonics up to an open one; around each seen
harmonic sidebands up to the first, second or third of each of its gears' shafts; those shafts' own
lines; perhaps a second mesh with the like; and combs of impacts or shaft harmonics on all that is
left. "No gear" has the combs alone, and a mesh whose teeth do not show has no sidebands. The log
evidence of each is that of its groups of lines over chance (:mod:`thermogear.measured.groups`),
with the prior of its free numbers: mesh line anywhere, teeth one of 12..250 for each gear
(:mod:`thermogear.measured.meshes`). Where the shaft would turn at a multiple of the mains'
frequency, an inverter is weighed against it.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from thermogear.measured.groups import (
    HIGHEST,
    mean_exp,
    refined,
)
from thermogear.measured.impacts import (
    TIMES,
    Background,
    combs_of,
    standing_out,
)
from thermogear.measured.meshes import (
    HARMONICS,
    TEETH,
    Draft,
    Gears,
    Stated,
    mesh_of,
    prior_of,
)
from thermogear.measured.peaks import Peaks

_LOWEST = 40.0  # bins, of a mesh line
_MESHES = 48  # lines tried as mesh lines
_PAIRS = 60  # pairs of mesh line and teeth looked at closely
_STATED_PAIRS = 12
_MESHES_BESIDE, _BESIDE = 12, 6  # meshes, and the lines beside each, that are read as sidebands
_ASIDE = 0.6  # bins
_MEMBERS = 6  # tooth numbers that are put together in twos
_FINAL = 24
_FIRST, _SECOND = 6, 24  # meshes that a second is put beside, and seconds tried
_FINAL_TWO = 10
_BARE = 4  # mesh lines without teeth
_APART = 3.0  # bins between a line and its sidebands, and between the lines of two shafts
_SAME_STEP = 1e-4
_SAME_RATE = 2e-4  # of two clocks: an inverter's and the recorder's


@dataclass(frozen=True, kw_only=True)
class Hypothesis:
    """``gears`` of one mesh or of two, none for "no gear"; ``evidence`` its logarithm over chance,
    ``weight``, ``combs``: steps of the combs beside them [cycles/sample], the first about an
    inverter's ``carrier`` if there is one."""

    gears: tuple[Gears, ...]
    evidence: float
    weight: float = 0.0
    combs: tuple[float, ...] = ()
    carrier: float | None = None

    @property
    def kind(self) -> str:
        """ "gear" or "no gear"."""
        return "gear" if self.gears else "no gear"

    @property
    def words(self) -> str:
        """In words."""
        if self.gears:
            return " and ".join(gears.words for gears in self.gears)
        beside = ", ".join(f"{step:.6f}" for step in self.combs)
        if self.carrier is not None:
            return (
                f"no gear: an inverter's carrier {self.carrier:.6f} cycles/sample, lines every "
                f"{beside}"
            )
        return "no gear" + (f": lines every {beside} cycles/sample" if beside else "")


def hypotheses(peaks: Peaks, stated: Stated) -> list[Hypothesis]:
    """All that are worth weighing, with their evidence."""
    singles = sorted(_drafts(peaks, stated), key=lambda draft: -draft.evidence)
    drafts = singles[:_FINAL]
    tops = drafts[:6]
    steps = [step for draft in tops for step in draft.steps]
    combs = combs_of(peaks, tuple(dict.fromkeys(steps + [draft.gears[0].mesh for draft in tops])))
    # where a comb holds all lines, those that stand out of it may be a mesh
    for comb in combs[:3]:
        known = [z for one in drafts for z in one.gears[0].teeth if _turns(one, z, comb.step)]
        drafts += [
            mesh_of(peaks, z * comb.step, (z,), stated)
            for z in standing_out(peaks, comb.step, fewest=TEETH[0], most=TEETH[1])
            if z not in known
        ]
    background = Background(peaks, combs, mains=stated.mains)
    alone, told = background.on(np.zeros(peaks.size, dtype=bool))
    none = Hypothesis(gears=(), evidence=max(0.0, alone), combs=tuple(one.step for one in told))
    found = [(_beside(draft, background), draft) for draft in drafts]
    found.sort(key=lambda pair: -pair[0].evidence)
    best = [draft for _, draft in found[:_FIRST]]
    bare = [mesh_of(peaks, mesh, (), stated) for mesh in _bare_lines(peaks, drafts)]
    twos = _with_second(peaks, best, singles, stated)
    others = [_beside(draft, background) for draft in (*bare, *twos)]
    # an inverter is set to one frequency: a speed that wanders is none of its
    mains = stated.mains if peaks.steady else ()
    carriers = [_carrier(one, draft, stated) for one, draft in found if _exact_mains(draft, mains)]
    return [none, *(one for one, _ in found), *others, *carriers]


def _exact_mains(draft: Draft, mains: tuple[float, ...]) -> bool:
    """Whether the one shaft turns at a multiple of the mains' nominal frequency."""
    if len(draft.steps) != 1:
        return False
    ratios = [draft.steps[0] / line for line in mains]
    return any(
        1 <= np.rint(ratio) <= TIMES and abs(ratio / np.rint(ratio) - 1.0) < _SAME_RATE
        for ratio in ratios
    )


def _carrier(one: Hypothesis, draft: Draft, stated: Stated) -> Hypothesis:
    """The same lines without a gear: an inverter set to the mains' nominal frequency. Its carrier,
    by the same clock, is any whole multiple of its steps as well."""
    (gears,) = draft.gears
    choice = float(np.log(TIMES * len(stated.mains)))
    return Hypothesis(
        gears=(),
        evidence=one.evidence - prior_of(gears.mesh, teeth=gears.teeth[0], stated=stated) - choice,
        combs=(draft.steps[0], *one.combs),
        carrier=gears.mesh,
    )


def _bare_lines(peaks: Peaks, drafts: list[Draft]) -> list[float]:
    """Mesh lines to weigh without teeth: the drafts' and the highest, each once."""
    found: list[float] = []
    meshes = [draft.gears[0].mesh for draft in drafts]
    for mesh in (*meshes[:_BARE], *peaks.place[np.argsort(-peaks.level)[:_BARE]]):
        new = all(abs(mesh / other - 1.0) > _SAME_STEP for other in found)
        if new and _LOWEST * peaks.bin_width < mesh < HIGHEST:
            found.append(float(mesh))
    return found


def _with_second(
    peaks: Peaks, first: list[Draft], singles: list[Draft], stated: Stated
) -> list[Draft]:
    """The best of the drafts, each with a second mesh on the lines it leaves."""
    found: dict[frozenset[tuple[int, tuple[int, ...]]], Draft] = {}
    for one in first:
        beside: list[Draft] = []
        for other in singles:
            if len(beside) == _SECOND:
                break
            if not _harmonic(one.gears[0].mesh, other.gears[0].mesh):
                beside.append(other)
        for other in beside:
            mesh, teeth = other.gears[0].mesh, other.gears[0].teeth
            both = mesh_of(peaks, mesh, teeth, Stated(), one)
            key = frozenset(
                (int(np.rint(g.mesh / peaks.bin_width / 2.0)), g.teeth) for g in both.gears
            )
            if both.evidence > one.evidence and (
                key not in found or both.evidence > found[key].evidence
            ):
                found[key] = both
    return sorted(found.values(), key=lambda draft: -draft.evidence)[:_FINAL_TWO]


def _harmonic(one: float, other: float) -> bool:
    """Whether one mesh line is the other or a multiple of it."""
    ratio = max(one, other) / min(one, other)
    return bool(abs(ratio / np.rint(ratio) - 1.0) < _SAME_STEP)


def _turns(draft: Draft, teeth: int, step: float) -> bool:
    return abs(draft.gears[0].mesh / teeth / step - 1.0) < _SAME_STEP


def _drafts(peaks: Peaks, stated: Stated) -> list[Draft]:
    """Mesh lines with one gear each, and with two of the best."""
    drafts: dict[tuple[int, tuple[int, ...]], Draft] = {}
    members: dict[int, dict[int, float]] = {}
    meshes: dict[int, float] = {}
    for mesh, teeth in _screened(peaks, stated):
        key = int(np.rint(mesh / peaks.bin_width / 2.0))
        draft = mesh_of(peaks, meshes.setdefault(key, mesh), (teeth,), stated)
        drafts[key, (teeth,)] = draft
        members.setdefault(key, {})[teeth] = draft.evidence
    for key, own in members.items():
        best = sorted(sorted(own, key=lambda z: -own[z])[:_MEMBERS])
        for both in itertools.combinations(best, 2):
            if meshes[key] / both[0] - meshes[key] / both[1] < _APART * peaks.bin_width:
                continue  # one line cannot tell of two shafts
            drafts[key, both] = mesh_of(peaks, meshes[key], both, stated)
    return list(drafts.values())


def _beside(draft: Draft, background: Background) -> Hypothesis:
    """The draft with combs on what is left: beside its sidebands, or with its shafts' lines among
    those of the combs, so that the mesh's alone stand out."""
    beside, told = background.on(draft.used, draft.steps)
    bare, bare_told = background.on(draft.mesh_lines, draft.steps)
    both = draft.evidence + beside, draft.bare + bare
    return Hypothesis(
        gears=draft.gears,
        evidence=mean_exp(both),
        combs=tuple(one.step for one in (told if both[0] > both[1] else bare_told)),
    )


def _screened(peaks: Peaks, stated: Stated) -> list[tuple[float, int]]:
    """The pairs of mesh line and teeth with the most lines where they foretell some."""
    if peaks.size < 3:
        return []
    gain = np.zeros(peaks.bins + 2)
    centre = np.rint(peaks.place / peaks.bin_width).astype(int)
    worth = np.clip(-np.log(peaks.density), 0.5, 8.0)
    for shift in (-1, 0, 1):
        np.maximum.at(gain, np.clip(centre + shift, 0, peaks.bins), worth)
    tops = peaks.place[np.argsort(-peaks.level)[:_MESHES]]
    tried = np.unique(np.concatenate([tops, tops / 2.0, tops / 3.0]))
    allowed = {*range(TEETH[0], TEETH[1] + 1), stated.teeth or TEETH[0]}
    teeth = np.array(sorted(allowed), dtype=float)
    pairs: list[tuple[float, float, int]] = []
    told: list[tuple[float, float, int]] = []
    for start in tried[tried > _LOWEST * peaks.bin_width]:
        highest = min(HARMONICS, int(HIGHEST / start))
        if highest < 1:
            continue
        mesh = refined(peaks, float(start), np.arange(1, highest + 1))[0]
        rank = np.arange(1, highest + 1)
        there = _looked(gain, peaks, rank * mesh) > 0
        if not np.any(there):
            continue
        around = rank[there][:, None, None] + np.array([-3, -2, -1, 1, 2, 3])[:, None] / teeth
        sides = np.sum(_looked(gain, peaks, around * mesh), axis=(0, 1))
        own = np.sum(_looked(gain, peaks, np.array([1, 2, 3])[:, None] * mesh / teeth), axis=0)
        carriers = np.sum(_looked(gain, peaks, rank * mesh))
        score = sides + own + 2.0 * carriers
        score[mesh / teeth < _APART * peaks.bin_width] = -np.inf
        best = np.argsort(-score)[:8]
        pairs += [(float(score[i]), mesh, int(teeth[i])) for i in best]
        if stated.teeth is not None:
            own = float(score[np.searchsorted(teeth, stated.teeth)])
            told.append((own, mesh, stated.teeth))
    kept = [(m, z) for _, m, z in sorted(pairs, reverse=True)[:_PAIRS]]
    kept += [(m, z) for _, m, z in sorted(told, reverse=True)[:_STATED_PAIRS]]
    best_meshes = list(dict.fromkeys(mesh for mesh, _ in kept))[:_MESHES_BESIDE]
    kept += [(mesh, z) for mesh in best_meshes for z in _of_highest_beside(peaks, mesh)]
    # halves and doubles of the best contradict them: they must be weighed too
    for mesh, z in kept[:12]:
        for k in (2, 3):
            kept += [(mesh, z * k), (mesh * k, z * k)]
            if z % k == 0:
                kept += [(mesh, z // k), (mesh / k, z // k)]
    fitting = [(m, z) for m, z in kept if z in allowed and m < HIGHEST]
    return list(dict.fromkeys(fitting))


def _of_highest_beside(peaks: Peaks, mesh: float) -> list[int]:
    """The teeth that the highest lines beside a mesh line and its harmonics tell as first
    sidebands: many others may have more lines where they foretell some, each lower."""
    rank = np.maximum(np.rint(peaks.place / mesh), 1.0)
    apart = np.abs(peaks.place - rank * mesh)
    beside = np.flatnonzero((apart > _APART * peaks.bin_width) & (apart < mesh / TEETH[0]))
    highest = beside[np.argsort(-peaks.level[beside])][:_BESIDE]
    teeth = np.rint(mesh / apart[highest])
    fits = np.abs(mesh / teeth - apart[highest]) < _ASIDE * peaks.bin_width
    return [int(z) for z in dict.fromkeys(teeth[fits])]


def _looked(
    gain: NDArray[np.float64], peaks: Peaks, position: NDArray[np.floating[Any]]
) -> NDArray[np.float64]:
    place = np.rint(position / peaks.bin_width).astype(int)
    return np.asarray(gain[np.where((place > 2) & (place < peaks.bins), place, peaks.bins + 1)])
