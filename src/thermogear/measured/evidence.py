"""What a record's lines say about teeth, as hypotheses with weights.

Each is foretold lines over chance (:mod:`thermogear.measured.hypotheses`). No law of lines is
exact: what all lines together say, E nats of the best, is off by the sum of many small errors of
either sign, which grows as sqrt(E). So log evidences are divided by sqrt(1 + E/25) before they are
normalised to weights: ten lines are believed as they stand, of hundreds a small difference decides
nothing. A gear is named where nearly all the weight has it. What has it is parted in two: teeth, or
sidebands at a distance of their own, as of a torsional oscillation; the two have all other lines in
common, so that their odds count as they are.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np
from scipy import special

from thermogear.measured.hypotheses import Hypothesis, hypotheses
from thermogear.measured.meshes import Gears, Stated, whole
from thermogear.measured.peaks import Peaks

CLEAR = 0.99
"""Weight from which something is called decided."""

_SURE_OF = 25.0  # nats
_PLAIN = 0.1  # weight of a reading that may be the one
_TOLD = 1e-3  # least weight that is told
_MOST_TOLD = 6
_ALIKE = 3e-4  # relative distance of two lines that are one
_APART = 0.01  # of two mesh lines of one train


@dataclass(frozen=True, kw_only=True)
class Gear:
    """A gear of ``teeth`` on a mesh line [cycles/sample], and its weight."""

    mesh: float
    teeth: int
    weight: float

    @property
    def words(self) -> str:
        """In words."""
        return f"{self.teeth} teeth on mesh line {self.mesh:.6f} cycles/sample"


_Weighed = TypeVar("_Weighed", Gear, Hypothesis)


@dataclass(frozen=True, kw_only=True)
class Named:
    """A mesh line [cycles/sample] and the teeth decided on it, each with its weight."""

    mesh: float
    teeth: tuple[int, ...]
    weights: tuple[float, ...]

    @property
    def words(self) -> str:
        """In words."""
        both = " and ".join(
            f"{z} teeth (weight {w:.4f})" for z, w in zip(self.teeth, self.weights, strict=True)
        )
        one = "" if len(self.teeth) > 1 else ", one of the mesh's two gears"
        return f"{both} on mesh line {self.mesh:.6f} cycles/sample{one}"


@dataclass(frozen=True, kw_only=True)
class Evidence:
    """Hypotheses, best first; ``named``: the meshes with decided gears, the clearest first."""

    hypotheses: tuple[Hypothesis, ...]
    named: tuple[Named, ...] = ()

    @property
    def mesh(self) -> float:
        """Mesh line [cycles/sample] of the gears named, else of the heaviest; nan: none."""
        if self.named or self.gears:
            return self.named[0].mesh if self.named else self.gears[0].mesh
        return next((one.gears[0].mesh for one in self.hypotheses if one.gears), float("nan"))

    @property
    def teeth(self) -> tuple[int, ...]:
        """Teeth decided on that line; empty: undecided."""
        return self.named[0].teeth if self.named else ()

    @property
    def weights(self) -> tuple[float, ...]:
        """Their weights."""
        return self.named[0].weights if self.named else ()

    @property
    def mesh_weight(self) -> float:
        """Weight of all hypotheses with this mesh line."""
        return sum(one.weight for one in self.hypotheses if _on(one, self.mesh))

    @property
    def line_weight(self) -> float:
        """Weight of all hypotheses with this line: mesh of gears, or comb without any."""
        beside = (
            one.weight
            for one in self.hypotheses
            if one.kind != "gear" and any(abs(c / self.mesh - 1.0) < _ALIKE for c in one.combs)
        )
        return self.mesh_weight + sum(beside)

    def share_of(self, mesh: float, *, teeth: int, least: float) -> float:
        """Weight of the ``mesh`` line [cycles/sample] as that of a gear of ``teeth`` known to be
        there: of each hypothesis the line that has them, else any of its lines alike. Combs without
        a gear are such lines from ``least`` on, lower ones do not count; one that has no line at
        all has nothing against it."""
        share = total = 0.0
        for one in self.hypotheses:
            lines = [own.mesh for own in one.gears if teeth in own.teeth]
            lines = lines or [own.mesh for own in one.gears]
            lines = lines or [step for step in one.combs if step >= least]
            if not lines and not one.combs:
                lines = [mesh]
            if lines:
                here = [abs(line / mesh - 1.0) < _APART for line in lines]
                share += one.weight * float(np.mean(here))
                total += one.weight
        return share / total if total > 0.0 else 1.0

    @property
    def gears(self) -> tuple[Gear, ...]:
        """Every gear with the weight of all hypotheses that have it, the heaviest first; two gears
        can both be there, so that these weights add up to more than one."""
        found = [
            ((round(np.log(mesh) / _ALIKE), z), Gear(mesh=mesh, teeth=z, weight=one.weight))
            for one in self.hypotheses
            for mesh, z in dict.fromkeys((g.mesh, z) for g in one.gears for z in g.teeth)
        ]
        return tuple(gear for gear in _together(found)[:_MOST_TOLD] if gear.weight >= _TOLD)

    @property
    def told(self) -> tuple[Hypothesis, ...]:
        """The readings that carry any weight, of which one at most is true, best first: of the
        hypotheses of one reading (the same gears, or none) the best, with the weight of all."""
        heavy = _together((one.words if one.gears else one.kind, one) for one in self.hypotheses)
        return tuple(one for one in heavy[:_MOST_TOLD] if one.weight >= _TOLD)

    @property
    def rest(self) -> float:
        """Weight of all readings that are not told; with theirs it adds up to one."""
        return max(0.0, 1.0 - sum(one.weight for one in self.told)) if self.hypotheses else 0.0

    def scaled(self, factor: float) -> Evidence:
        """The same with every place times ``factor``: counted in samples of another length."""
        return Evidence(
            hypotheses=tuple(
                replace(
                    one,
                    gears=tuple(own.scaled(factor) for own in one.gears),
                    combs=tuple(step * factor for step in one.combs),
                    carrier=None if one.carrier is None else one.carrier * factor,
                )
                for one in self.hypotheses
            ),
            named=tuple(replace(one, mesh=one.mesh * factor) for one in self.named),
        )

    def fits(self, shaft: float, *, teeth: int | None, tolerance: float) -> bool:
        """Whether a reading with some weight has a shaft that turns so [turns/sample]."""
        return any(
            abs(one.mesh / one.teeth / shaft - 1.0) <= tolerance
            for one in self.gears
            if one.weight >= _PLAIN and teeth in (None, one.teeth)
        )

    @property
    def words(self) -> str:
        """Verdict and weights in words."""
        if self.named:
            return "decided: " + "; ".join(one.words for one in self.named)
        if self.verdict == "no gear found":
            return f"no gear found: {self.told[0].words} (weight {self.told[0].weight:.3f})"
        told = [f"{one.words} (weight {one.weight:.3f})" for one in self.told]
        told += [f"others (weight {self.rest:.3f})"] if self.rest >= _TOLD else []
        return f"teeth undecided: {'; '.join(told) or 'nothing carries weight'}"

    @property
    def verdict(self) -> str:
        """ "decided", "undecided" or "no gear found"."""
        if self.named:
            return "decided"
        if not self.hypotheses:
            return "undecided"
        without = sum(one.weight for one in self.hypotheses if one.kind == "no gear")
        return "no gear found" if without >= CLEAR else "undecided"


def weigh(peaks: Peaks, stated: Stated | None = None) -> Evidence:
    """Hypotheses on the teeth behind these lines, with weights.

    Of two meshes with decided gears the one with the teeth stated comes first, else the higher.
    """
    stated = stated or Stated()
    found = hypotheses(peaks, stated)
    logs = np.array([one.evidence for one in found])
    logs /= np.sqrt(1.0 + max(0.0, float(logs.max())) / _SURE_OF)
    weights = np.exp(logs - special.logsumexp(logs))
    weighed = [replace(one, weight=float(w)) for one, w in zip(found, weights, strict=True)]
    weighed.sort(key=lambda one: -one.weight)
    best = weighed[0].gears
    named = [_named(gears, weighed) for gears in best]
    for gears, one in zip(best, named, strict=True):
        for teeth in one.teeth:
            order = (gears, *(other for other in best if other is not gears))
            weighed = _or_free(weighed, gears.mesh, teeth, *whole(peaks, order, teeth, stated))
    meshes = sorted(best, key=lambda one: (stated.teeth in one.teeth, one.level))
    named = [_named(gears, weighed) for gears in reversed(meshes)]
    weighed.sort(key=lambda one: -one.weight)
    evidence = Evidence(
        hypotheses=tuple(weighed),
        named=tuple(one for one in named if one.teeth),
    )
    if evidence.named or any(one.weight >= _PLAIN for one in evidence.gears):
        return evidence
    return Evidence(hypotheses=_untold(weighed))


def _or_free(
    weighed: list[Hypothesis], mesh: float, teeth: int, share: float, distance: float
) -> list[Hypothesis]:
    """The hypotheses, where those with this gear keep ``share`` of their weight: the rest is that
    its sidebands have a distance of their own."""
    found: list[Hypothesis] = []
    for one in weighed:
        if not _has(one, mesh, teeth):
            found.append(one)
            continue
        gears = tuple(
            own.without(teeth, distance) if abs(own.mesh / mesh - 1.0) < _ALIKE else own
            for own in one.gears
        )
        found += [
            replace(one, weight=one.weight * share),
            replace(one, gears=gears, weight=one.weight * (1.0 - share)),
        ]
    return found


def _untold(weighed: list[Hypothesis]) -> tuple[Hypothesis, ...]:
    """The hypotheses where no tooth number has a tenth of the weight: numbers that the lines do not
    tell are put together as teeth that are not seen, any number."""
    found: list[tuple[Hashable, Hypothesis]] = []
    for one in weighed:
        gears = tuple(replace(own, teeth=(), sides=(), free=()) for own in one.gears)
        places = tuple(round(np.log(own.mesh) / _ALIKE) for own in gears)
        found.append((("" if gears else one.words, places), replace(one, gears=gears)))
    return tuple(_together(found))


def _together(parts: Iterable[tuple[Hashable, _Weighed]]) -> list[_Weighed]:
    """Of the parts with one key the first, with the weight of all, the heaviest first."""
    found: dict[Hashable, _Weighed] = {}
    for key, one in parts:
        before = found.get(key)
        more = one.weight if before is None else before.weight + one.weight
        found[key] = replace(before or one, weight=more)
    return sorted(found.values(), key=lambda one: -one.weight)


def _on(one: Hypothesis, mesh: float) -> bool:
    return any(abs(gears.mesh / mesh - 1.0) < _ALIKE for gears in one.gears)


def _named(gears: Gears, weighed: list[Hypothesis]) -> Named:
    """Of a mesh of the best hypothesis, the gears that carry nearly all the weight.

    A shaft's own lines do not say which mesh it has: only first sidebands do. A gear whose teeth
    divide the other's puts its lines where that one has its second, third, ...: it is not named.
    """
    teeth, sure = [], []
    for z, sides in zip(gears.teeth, gears.sides, strict=True):
        divides = any(other != z and other % z == 0 for other in gears.teeth)
        if divides or sides < np.log(CLEAR / (1.0 - CLEAR)):
            continue
        share = sum(one.weight for one in weighed if _has(one, gears.mesh, z))
        if share >= CLEAR:
            teeth.append(z)
            sure.append(float(share))
    return Named(mesh=gears.mesh, teeth=tuple(teeth), weights=tuple(sure))


def _has(one: Hypothesis, mesh: float, teeth: int) -> bool:
    """Whether a hypothesis has this gear on this mesh line."""
    return any(
        abs(gears.mesh / mesh - 1.0) < _ALIKE and teeth in gears.teeth for gears in one.gears
    )
