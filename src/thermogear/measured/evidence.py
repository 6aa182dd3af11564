"""What a record's lines say about teeth, as hypotheses with weights.

A hypothesis foretells lines: a mesh line and its harmonics; around each seen harmonic sidebands 1
to 3 of each of its gears' shafts; those shafts' own lines 1 to 4; and combs of impacts or shaft
harmonics on all that is left. "No gear" has the combs alone. The log evidence of each is that of
its groups of lines over chance (:mod:`thermogear.measured.groups`), with the prior of its free
numbers: mesh line anywhere, teeth one of 12..250 for each gear. Weights are evidences, normalised.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import special

from thermogear.measured.groups import (
    Flags,
    Seen,
    falling,
    mean_exp,
    narrow,
    refined,
    some_of,
    take,
)
from thermogear.measured.impacts import Comb, best_background, combs_of, orders_of, standing_out
from thermogear.measured.peaks import Peaks

Floats = NDArray[np.float64]

TEETH = (12, 250)
"""Tooth numbers looked for: fewer are not made as power gears."""
CLEAR = 0.99
"""Weight from which something is called decided."""

_HARMONICS = 6
_MESH_SPREAD = 1.5  # nepers, of mesh harmonics about a fall with their rank
_SIDE_SPREAD = 1.2  # of sidebands, and of a shaft's own lines, about a fall with their order
_FALL = 0.7  # nepers for each order
_SIDES = np.array([-1, 1, -2, 2, -3, 3])
_OWN = np.arange(1, 5)
_MESHES = 48  # lines tried as mesh lines
_PAIRS = 60  # pairs of mesh line and teeth looked at closely
_STATED_PAIRS = 12
_MEMBERS = 6  # tooth numbers that are put together in twos
_FINAL = 24
_APART = 3.0  # bins between the lines of two shafts
_SAME_STEP = 1e-4
_TOLD = 1e-3  # least weight that is told
_MOST_TOLD = 6
_GIVEN = 0.9  # how far a stated tooth number or speed is trusted
_SPEED_SPREAD = 0.05  # a stated speed is nominal


_ALIKE = 3e-4
"""Relative distance of two lines that are one."""


@dataclass(frozen=True, kw_only=True)
class Stated:
    """What a user says: teeth of a gear, and its shaft's turns per sample."""

    teeth: int | None = None
    shaft: float | None = None


@dataclass(frozen=True, kw_only=True)
class Hypothesis:
    """``kind`` "gear" or "no gear"; ``mesh`` [cycles/sample] (nan: none), ``teeth`` of the gears
    whose shafts show, ``evidence`` its logarithm over chance, ``weight``, ``combs``: steps of the
    combs beside it [cycles/sample], ``sides``: log evidence of each gear's first sidebands
    alone."""

    kind: str
    mesh: float
    teeth: tuple[int, ...]
    evidence: float
    weight: float = 0.0
    combs: tuple[float, ...] = ()
    sides: tuple[float, ...] = ()

    @property
    def words(self) -> str:
        """In words."""
        beside = ", ".join(f"{step:.6f}" for step in self.combs)
        if self.kind == "gear":
            teeth = " and ".join(map(str, self.teeth))
            return f"mesh line {self.mesh:.6f} cycles/sample, {teeth} teeth"
        return "no gear" + (f": lines every {beside} cycles/sample" if beside else "")


@dataclass(frozen=True, kw_only=True)
class Evidence:
    """Hypotheses, best first; ``teeth`` decided on ``mesh`` (empty, nan: undecided)."""

    hypotheses: tuple[Hypothesis, ...]
    mesh: float
    teeth: tuple[int, ...]
    weights: tuple[float, ...]

    @property
    def mesh_weight(self) -> float:
        """Weight of all hypotheses with this mesh line."""
        return sum(one.weight for one in self.hypotheses if _same_mesh(one, self.mesh))

    @property
    def line_weight(self) -> float:
        """Weight of all hypotheses with this line: mesh of gears, or comb without any."""
        beside = (
            one.weight
            for one in self.hypotheses
            if one.kind != "gear" and any(abs(c / self.mesh - 1.0) < _ALIKE for c in one.combs)
        )
        return self.mesh_weight + sum(beside)

    @property
    def told(self) -> tuple[Hypothesis, ...]:
        """The hypotheses that carry any weight, best first."""
        kept = [one for one in self.hypotheses if one.weight >= _TOLD]
        return tuple(kept[:_MOST_TOLD])

    def fits(self, shaft: float, *, teeth: int | None, tolerance: float) -> bool:
        """Whether a reading with some weight has a shaft that turns so [turns/sample]."""
        return any(
            abs(one.mesh / z / shaft - 1.0) <= tolerance
            for one in self.hypotheses
            if one.kind == "gear" and one.weight >= _TOLD
            for z in one.teeth
            if teeth is None or z == teeth
        )

    @property
    def words(self) -> str:
        """Verdict and weights in words."""
        listed = "; ".join(f"{one.words} (weight {one.weight:.3f})" for one in self.told)
        if self.verdict == "decided":
            both = " and ".join(
                f"{z} teeth (weight {w:.4f})" for z, w in zip(self.teeth, self.weights, strict=True)
            )
            one = "" if len(self.teeth) > 1 else ", one of the mesh's two gears"
            return f"decided: {both} on mesh line {self.mesh:.6f} cycles/sample{one}"
        if self.verdict == "no gear found":
            return f"no gear found: {listed}"
        return f"teeth undecided: {listed}"

    @property
    def verdict(self) -> str:
        """ "decided", "undecided" or "no gear found"."""
        if self.teeth:
            return "decided"
        best = self.hypotheses[0]
        clear = best.kind == "no gear" and best.weight >= CLEAR
        return "no gear found" if clear else "undecided"


def weigh(peaks: Peaks, stated: Stated | None = None) -> Evidence:
    """Hypotheses on the teeth behind these lines, with weights."""
    stated = stated or Stated()
    drafts = sorted(_drafts(peaks, stated), key=lambda draft: -draft.evidence)[:_FINAL]
    steps = [draft.mesh / z for draft in drafts[:6] for z in draft.teeth]
    combs = combs_of(peaks, tuple(dict.fromkeys(steps + [draft.mesh for draft in drafts[:6]])))
    # where a comb holds all lines, those that stand out of it may be a mesh
    for comb in combs[:3]:
        known = [z for draft in drafts for z in draft.teeth if _turns(draft, z, comb.step)]
        drafts += [
            _gear(peaks, z * comb.step, (z,), stated)
            for z in standing_out(peaks, comb.step, fewest=TEETH[0], most=TEETH[1])
            if z not in known
        ]
    orders = orders_of(peaks, combs)
    alone, told = best_background(peaks, np.zeros(peaks.size, dtype=bool), orders)
    none = Hypothesis(
        kind="no gear",
        mesh=float("nan"),
        teeth=(),
        evidence=max(0.0, alone),
        combs=tuple(one.step for one in told),
    )
    return _decided([none, *(_beside(peaks, draft, orders) for draft in drafts)])


def _turns(draft: _Draft, teeth: int, step: float) -> bool:
    return abs(draft.mesh / teeth / step - 1.0) < _SAME_STEP


def _drafts(peaks: Peaks, stated: Stated) -> list[_Draft]:
    """Mesh lines with one gear each, and with two of the best."""
    drafts: dict[tuple[int, tuple[int, ...]], _Draft] = {}
    members: dict[int, dict[int, float]] = {}
    meshes: dict[int, float] = {}
    for mesh, teeth in _screened(peaks, stated):
        key = int(np.rint(mesh / peaks.bin_width / 2.0))
        draft = _gear(peaks, meshes.setdefault(key, mesh), (teeth,), stated)
        drafts[key, (teeth,)] = draft
        members.setdefault(key, {})[teeth] = draft.evidence
    for key, own in members.items():
        best = sorted(sorted(own, key=lambda z: -own[z])[:_MEMBERS])
        for both in itertools.combinations(best, 2):
            if meshes[key] / both[0] - meshes[key] / both[1] < _APART * peaks.bin_width:
                continue  # one line cannot tell of two shafts
            drafts[key, both] = _gear(peaks, meshes[key], both, stated)
    return list(drafts.values())


def _beside(peaks: Peaks, draft: _Draft, orders: list[list[Comb]]) -> Hypothesis:
    """The draft with combs on what is left: beside its sidebands, or with its shafts' lines among
    those of the combs, so that the mesh's alone stand out."""
    fixed = tuple(draft.mesh / z for z in draft.teeth)
    beside, told = best_background(peaks, draft.used, orders, fixed)
    bare, bare_told = best_background(peaks, draft.mesh_lines, orders, fixed)
    both = draft.evidence + beside, draft.bare + bare
    return Hypothesis(
        kind="gear",
        mesh=draft.mesh,
        teeth=draft.teeth,
        evidence=mean_exp(both),
        combs=tuple(one.step for one in (told if both[0] > both[1] else bare_told)),
        sides=draft.sides,
    )


@dataclass(frozen=True)
class _Draft:
    mesh: float
    teeth: tuple[int, ...]
    evidence: float
    used: Flags
    bare: float  # evidence of the mesh line's harmonics alone
    mesh_lines: Flags
    sides: tuple[float, ...]  # evidence of each gear's first sidebands alone


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
    teeth = np.arange(TEETH[0], TEETH[1] + 1, dtype=float)
    pairs: list[tuple[float, float, int]] = []
    told: list[tuple[float, float, int]] = []
    for start in tried[tried > 40.0 * peaks.bin_width]:
        highest = min(_HARMONICS, int(0.47 / start))
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
        score[mesh / teeth < 4.0 * peaks.bin_width] = -np.inf
        best = np.argsort(-score)[:8]
        pairs += [(float(score[i]), mesh, int(teeth[i])) for i in best]
        if stated.teeth is not None and TEETH[0] <= stated.teeth <= TEETH[1]:
            told.append((float(score[stated.teeth - TEETH[0]]), mesh, stated.teeth))
    kept = [(m, z) for _, m, z in sorted(pairs, reverse=True)[:_PAIRS]]
    kept += [(m, z) for _, m, z in sorted(told, reverse=True)[:_STATED_PAIRS]]
    # halves and doubles of the best contradict them: they must be weighed too
    for mesh, z in kept[:12]:
        for k in (2, 3):
            kept += [(mesh, z * k), (mesh * k, z * k)]
            if z % k == 0:
                kept += [(mesh, z // k), (mesh / k, z // k)]
    fitting = [(m, z) for m, z in kept if TEETH[0] <= z <= TEETH[1] and m < 0.47]
    return list(dict.fromkeys(fitting))


def _looked(gain: Floats, peaks: Peaks, position: NDArray[np.floating[Any]]) -> Floats:
    place = np.rint(position / peaks.bin_width).astype(int)
    return np.asarray(gain[np.where((place > 2) & (place < peaks.bins), place, peaks.bins + 1)])


def _gear(peaks: Peaks, mesh: float, teeth: tuple[int, ...], stated: Stated) -> _Draft:
    """Log evidence of a mesh line with these gears, without what is left of the lines."""
    used = np.zeros(peaks.size, dtype=bool)
    ranks = np.arange(1, min(_HARMONICS, int(0.47 / mesh)) + 1)
    mesh, error = refined(peaks, mesh, ranks)
    rank = ranks.astype(float)
    carriers = falling(
        peaks,
        used,
        position=(rank * mesh)[None, :],
        order=ranks,
        error=(rank * error)[None, :],
        spread=_MESH_SPREAD,
        trend=-np.log(rank),
        top=np.inf,
    )
    evidence, seen_best = _open(carriers)
    total = evidence + narrow(error, width=0.47)
    lines = seen_best.lines[0]
    used[lines[lines >= 0]] = True
    bare, mesh_lines = total, used.copy()
    around: list[float] = []
    there = rank[lines >= 0]
    tops = peaks.level[lines[lines >= 0]]
    for z in teeth:
        sides = falling(
            peaks,
            used,
            position=(there[:, None] + _SIDES / z) * mesh,
            order=np.abs(_SIDES),
            error=there[:, None] * error,
            spread=_SIDE_SPREAD,
            trend=-_FALL * (np.abs(_SIDES) - 1.0),
            top=tops,
        )
        own = falling(
            peaks,
            used,
            position=(_OWN * mesh / z)[None, :],
            order=_OWN,
            error=(_OWN * error / z)[None, :],
            spread=_SIDE_SPREAD,
            trend=-_FALL * (_OWN - 1.0),
            top=np.inf,
        )
        prior = _prior(mesh, z, stated)
        bare += prior
        around.append(some_of(sides[0].evidence))
        total += prior
        for part in (sides, own):
            evidence, seen_best = _open(part)
            total += evidence
            take(used, seen_best)
    return _Draft(mesh, teeth, total, used, bare, mesh_lines, tuple(around))


def _open(parts: tuple[Seen, ...]) -> tuple[float, Seen]:
    """Log evidence of groups up to an order that is open, all alike, and the best of them."""
    each = [some_of(part.evidence) for part in parts]
    return mean_exp(each), parts[int(np.argmax(each))]


def _prior(mesh: float, teeth: int, stated: Stated) -> float:
    """Log prior of a gear: any tooth number alike, or as stated; a stated speed is nominal."""
    total = -float(np.log(TEETH[1] - TEETH[0] + 1))
    if stated.teeth is not None:
        own = _GIVEN if teeth == stated.teeth else 0.0
        total = float(np.log(own + (1.0 - _GIVEN) * np.exp(total)))
    if stated.shaft is not None:
        away = np.log(mesh / teeth / stated.shaft) / _SPEED_SPREAD
        # against a shaft anywhere within a factor of 30 to both sides
        near = np.exp(-0.5 * away**2) / (_SPEED_SPREAD * np.sqrt(2 * np.pi)) * 2 * np.log(30.0)
        total += float(np.log(_GIVEN * near + 1.0 - _GIVEN))
    return total


def _same_mesh(one: Hypothesis, mesh: float) -> bool:
    return one.kind == "gear" and abs(one.mesh / mesh - 1.0) < _ALIKE


def _decided(found: list[Hypothesis]) -> Evidence:
    """Weights of the hypotheses, and the gears that carry nearly all of it."""
    logs = np.array([one.evidence for one in found])
    weights = np.exp(logs - special.logsumexp(logs))
    named = [
        Hypothesis(**{**vars(one), "weight": float(w)})
        for one, w in zip(found, weights, strict=True)
    ]
    named.sort(key=lambda one: -one.weight)
    best = named[0]
    teeth, sure = [], []
    for z, sides in zip(best.teeth, best.sides, strict=True):
        # a shaft's own lines do not say which mesh it has: only first sidebands do; a gear whose
        # teeth divide another's puts its lines where that one has its second, third, ...
        divides = any(other != z and other % z == 0 for other in best.teeth)
        if divides or sides < np.log(CLEAR / (1.0 - CLEAR)):
            continue
        # the same gear under another hypothesis: the same mesh line, the same teeth
        share = sum(one.weight for one in named if _same_mesh(one, best.mesh) and z in one.teeth)
        if share >= CLEAR:
            teeth.append(z)
            sure.append(float(share))
    return Evidence(
        hypotheses=tuple(named),
        mesh=best.mesh,
        teeth=tuple(teeth),
        weights=tuple(sure),
    )
