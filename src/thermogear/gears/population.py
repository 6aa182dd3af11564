"""Whole gears of an accuracy class, drawn: eccentricity, pitch and the profile of every tooth.

A class bounds deviations and does not say how they lie, and no public numbers say how much of their
tolerances real gears use, or how much the teeth of one gear have in common. So the population is an
assumption of ours, with its parameters as arguments (:class:`Population`). What is not assumed is
the class: a drawn gear is measured as ISO 1328-1 measures, about its bore, and scaled so that it is
a gear of the class and not of a better one.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import KW_ONLY, dataclass, replace
from functools import lru_cache

import numpy as np

from thermogear.base import bounds
from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError, require_choice
from thermogear.gears.accuracy import FlankTolerances, flank_tolerances
from thermogear.gears.contact import mirror_position
from thermogear.gears.deviations import (
    FLANKS,
    GEARS,
    Contacts,
    Deviation,
    FlankShape,
    PitchError,
    active_profile,
)
from thermogear.gears.graded_flanks import trace_figures
from thermogear.gears.pair import GearPair
from thermogear.gears.tooth_damage import Damage
from thermogear.gears.turn import Eccentricity, ToothShapes

MEASURED_TEETH = 4
"""Teeth whose profiles are measured, evenly around the gear. Source: ISO 1328-1:2013, at least 3
or 4 are usual."""
Size = float | Floats
"""Of one tooth, or of several: a column (tooth, 1)."""
_POINTS = 65  # of a profile that is measured: 16 or more for each of four waves


@dataclass(frozen=True, kw_only=True)
class Population:
    """How the gears of a class differ; sizes are shares of the tolerances of the class.

    ``eccentricity``: mean of 2 e/cos(alpha) over F_pT, of random direction (both coordinates
    normal, e a Rayleigh variable). ``index``: standard deviation of each tooth's index over f_pT;
    ``orders``: with a wave of each order q around the gear, its amplitude a Rayleigh variable of
    mean ``order`` f_pT/q. ``slope``: standard deviation over f_HalphaT of the slope that all teeth
    have, ``slope_scatter`` of each tooth's own. ``barrel``: mean and standard deviation over
    f_falphaT of the height of a parabola over the profile, > 0 full in the middle; ``wave``: mean
    amplitude (Rayleigh) over f_falphaT of a sine with a number of waves evenly drawn from
    ``waves``: one tool makes them alike on all teeth, but for ``form_scatter`` of their heights
    and ``phase_scatter`` [rad]. ``least``: the worst of the gear's deviations over its tolerance is
    evenly drawn from there to 1; 1/sqrt(2) is where the next better class begins.

    >>> pair = GearPair(Gear(20, 3e-3), Gear(40, 3e-3))
    >>> centred, *_ = drawn_pair(pair, 6, seed=1, population=Population(eccentricity=0.0))
    >>> centred.differs
    False
    """

    eccentricity: float = 0.55
    index: float = 0.22
    orders: tuple[int, ...] = (2, 3)
    order: float = 0.15
    slope: float = 0.40
    slope_scatter: float = 0.08
    barrel: tuple[float, float] = (0.25, 0.125)
    wave: float = 0.25
    waves: tuple[float, float] = (1.5, 4.0)
    form_scatter: float = 0.12
    phase_scatter: float = math.radians(43.0)
    least: float = math.sqrt(0.5)

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if not (np.all(np.isfinite(value)) and np.all(np.asarray(value) >= 0.0)):
                raise InputError(f"population.{name}", value, allowed="finite, >= 0")
        if min(self.orders, default=1) < 1 or self.least > 1.0:
            got = f"orders {self.orders}, least {self.least:g}"
            raise InputError("population", got, allowed="orders from 1 on, least 0..1")
        waves = (self.order if self.orders else 0.0, self.wave, *self.barrel)
        if not any((*waves, self.eccentricity, self.index, self.slope, self.slope_scatter)):
            why = "what differs is scaled to the class"
            raise InputError("population", "all shares 0", allowed="one above 0", why=why)


@dataclass(frozen=True)
class ToothProfile(FlankShape):
    """The profile of one tooth: a slope, a barrel and a wave of one tool.

    S(x) = slope (x - 1/2) - barrel (2 x - 1)^2 + wave sin(2 pi waves x + phase), less its value at
    the pitch point, where the pitch is measured; x from 0 at the start of the active profile to 1
    at the tip along the line of action, constant beyond. ``slope``, ``barrel`` and ``wave`` [m],
    ``phase`` [rad]; > 0 is material outside at the tip, in the middle.
    """

    gear: str
    _: KW_ONLY
    slope: float
    barrel: float
    wave: float
    waves: float
    phase: float
    flank: str = "both"

    def __post_init__(self) -> None:
        require_choice("tooth_profile.gear", self.gear, GEARS)
        require_choice("tooth_profile.flank", self.flank, FLANKS)
        for name in ("slope", "barrel", "wave"):
            bounds.ADDED.require(f"tooth_profile.{name}", getattr(self, name))
        if not (math.isfinite(self.phase) and 0.0 <= self.waves <= 20.0):
            got = f"{self.waves:g} waves of phase {self.phase:g}"
            raise InputError("tooth_profile.waves", got, allowed="0..20, of finite phase")

    def taken_off(self, pair: GearPair, rho: Floats) -> Floats:
        """e = -S."""
        row = {name: getattr(self, name) for name in ("slope", "barrel", "wave", "waves", "phase")}
        return _taken_off(pair, self.gear, np.ravel(rho), **row).reshape(np.shape(rho))

    @classmethod
    def each(
        cls, shapes: Sequence[FlankShape], pair: GearPair, rho: Floats, *, weights: Floats
    ) -> Floats:
        """The means of :meth:`FlankShape.each`: of what one tool made from one set of waves."""
        rows = [s for s in shapes if isinstance(s, ToothProfile)]
        if len({row.waves for row in rows}) != 1 or len(rows) < len(shapes):
            return super().each(shapes, pair, rho, weights=weights)
        start, pitch, tip = active_profile(pair, rows[0].gear)
        slope, barrel, wave, phase = np.array(
            [(row.slope, row.barrel, row.wave, row.phase) for row in rows]
        ).T
        forms = []
        for at, mean in ((rho, weights), (np.array([[pitch]]), np.ones(1))):
            x = np.clip((at - start) / (tip - start), 0.0, 1.0)
            angle = 2.0 * math.pi * rows[0].waves * x
            parts = (x - 0.5, -((2.0 * x - 1.0) ** 2), np.sin(angle), np.cos(angle))
            forms.append(np.stack([form @ mean for form in parts]))
        sizes = np.stack([slope, barrel, wave * np.cos(phase), wave * np.sin(phase)], axis=1)
        return np.asarray(sizes @ forms[1] - sizes @ forms[0])

    def borders(self, pair: GearPair) -> Floats:
        """Ends of the active profile and every tenth of a wave in between."""
        start, _, tip = active_profile(pair, self.gear)
        return np.linspace(start, tip, math.ceil(10.0 * self.waves) + 1)


def _taken_off(
    pair: GearPair, name: str, rho: Floats, *, slope: Size, barrel: Size, wave: Size,
    waves: float, phase: Size,
) -> Floats:  # fmt: skip
    """e [m] at ``rho`` (n,) [m] of the named gear; sizes are numbers or columns (tooth, 1)."""
    start, pitch, tip = active_profile(pair, name)
    x = np.clip((np.append(rho, pitch) - start) / (tip - start), 0.0, 1.0)
    added = slope * (x - 0.5) - barrel * (2.0 * x - 1.0) ** 2
    added += wave * np.sin(2.0 * math.pi * waves * x + phase)
    return np.asarray(added[..., -1:] - added[..., :-1])


class GearFigures(FlankTolerances):
    """What ISO 1328-1 measures on one side of a gear, about its bore [m].

    single_pitch f_p and cumulative_pitch F_p of all teeth, arcs of the reference circle;
    profile_slope f_Halpha, profile_form f_falpha and profile_total F_alpha, the greatest of
    :data:`MEASURED_TEETH` teeth over the active profile.
    """

    def shares(self, tolerances: FlankTolerances) -> Floats:
        """Each over its tolerance, in the order of the fields."""
        return np.asarray(np.array(self) / np.array(tolerances))


@lru_cache(maxsize=16)
def _probe(pair: GearPair, name: str, flank: str) -> Contacts:
    """Where a machine touches a gear: all teeth at the pitch point, then profiles of some.

    On the base tangent, as the mate does: each point where it comes to the line of action.
    """
    gear = pair.pinion if name == "pinion" else pair.wheel
    start, pitch, tip = active_profile(pair, name)
    profile = np.linspace(start, tip, _POINTS)
    some = np.arange(MEASURED_TEETH) * gear.teeth // MEASURED_TEETH
    tooth = np.concatenate([np.arange(gear.teeth), np.repeat(some, _POINTS)])[:, None]
    rho = np.append(np.full(gear.teeth, pitch), np.tile(profile, MEASURED_TEETH))[:, None]
    s = rho if name == "pinion" else pair.line_of_action - rho
    travel = (s - pair.path.a) / pair.base_pitch
    if flank == "back":  # runs against the drive flanks and joins the wheel's next tooth
        mirror = (mirror_position(pair) - 2.0 * pair.path.a) / pair.base_pitch
        travel = mirror - float(name == "wheel") - travel
    phase = (tooth + travel)[:, 0]
    return Contacts(pair, s, s, pair.line_of_action - s, tooth, tooth, flank, phase)


def _figures(pair: GearPair, name: str, added: Floats) -> GearFigures:
    """The figures of what was read, ``added`` S [m], at the points of :func:`_probe`."""
    gear = pair.pinion if name == "pinion" else pair.wheel
    arc = added[: gear.teeth] / math.cos(gear.pressure_angle)
    traces = added[gear.teeth :].reshape(MEASURED_TEETH, _POINTS)
    share = np.arange(_POINTS) / (_POINTS - 1.0)
    slope, form, total = np.abs(trace_figures(share, traces=traces)).max(axis=0)
    steps = np.abs(np.diff(np.append(arc, arc[0])))
    return GearFigures(float(steps.max()), float(np.ptp(arc)), *map(float, (slope, form, total)))


def measured(
    pair: GearPair, name: str, deviations: Iterable[Deviation], flank: str = "drive"
) -> GearFigures:
    """The named gear of ``pair`` with its ``deviations``, measured about its bore on one side.

    Those of the mate, what belongs to no gear, and broken teeth are left aside.

    >>> pair = GearPair(Gear(20, 3e-3), Gear(40, 3e-3))
    >>> figures = measured(pair, "wheel", [Eccentricity("wheel", amount=10e-6, angle=0.0)])
    >>> f"{1e6 * figures.cumulative_pitch:.2f} um"
    '21.28 um'
    """
    at = _probe(pair, name, flank)
    mine = [
        one
        for one in deviations
        if getattr(one, "gear", None) == name and not isinstance(one, Damage)
    ]
    return _figures(pair, name, -sum((one.gap(at)[:, 0] for one in mine), np.zeros(at.s.size)))


def drawn_gear(
    pair: GearPair,
    name: str,
    grade: int,
    *,
    seed: np.random.SeedSequence,
    edition: str = "2013",
    population: Population = Population(),
) -> tuple[Eccentricity, PitchError, ToothShapes, ToothShapes]:
    """One gear of a class, drawn: its eccentricity, index, profiles of drive and back flanks.

    The index moves a whole tooth, so that both of its flanks have it; the profiles of the two sides
    are drawn by themselves. The worst of the deviations over its tolerance is drawn evenly from
    ``population.least`` to 1; the drive flank decides, where the back flank's profiles would be
    worse they are made smaller. So the class measured on both sides is ``grade``. A class two
    coarser with the same ``seed`` is the same gear, doubled. Tolerances are not rounded. Raises as
    :func:`~thermogear.gears.accuracy.flank_tolerances`.

    >>> pair = GearPair(Gear(20, 3e-3), Gear(40, 3e-3))
    >>> drawn = drawn_gear(pair, "pinion", 6, seed=np.random.SeedSequence(1))
    >>> limits = flank_tolerances(20, 3e-3, grade=6)
    >>> f"{max(measured(pair, 'pinion', drawn).shares(limits)):.2f} of its tolerance"
    '0.87 of its tolerance'
    """
    gear = pair.pinion if name == "pinion" else pair.wheel
    whole = flank_tolerances(gear.teeth, gear.module, grade=grade, edition=edition)
    # drawn a thousand times too small, so that no raw gear leaves the bounds of a deviation
    limits = FlankTolerances(*(1e-3 * one for one in whole))
    rng = np.random.default_rng(seed)
    cosine, p = math.cos(gear.pressure_angle), population
    amount = 0.5 * cosine * _rayleigh(rng, p.eccentricity) * limits.cumulative_pitch
    centre = Eccentricity(name, amount=amount, angle=rng.uniform(0.0, 2.0 * math.pi))
    around = 2.0 * math.pi * np.arange(gear.teeth) / gear.teeth
    index = p.index * rng.standard_normal(gear.teeth)
    for q in p.orders:
        index += _rayleigh(rng, p.order) / q * np.sin(q * around + rng.uniform(0.0, 2.0 * math.pi))
    pitch = PitchError(name, tuple(cosine * limits.single_pitch * (index - index.mean())))
    drawn = {flank: _side(rng, p, limits, gear.teeth) for flank in FLANKS[:2]}
    sides = {flank: columns for flank, (columns, _) in drawn.items()}
    waves = {flank: count for flank, (_, count) in drawn.items()}
    share = rng.uniform(p.least, 1.0)

    def shares(flank: str, profiles: float) -> Floats:
        at = _probe(pair, name, flank)
        added = -centre.gap(at)[:, 0] - pitch.gap(at)[:, 0]
        rho = at.string(name)[gear.teeth : gear.teeth + _POINTS, 0]
        some = at.tooth(name)[gear.teeth :: _POINTS]
        sizes = {size: np.asarray(column)[some] for size, column in sides[flank].items()}
        read = _taken_off(pair, name, rho, waves=waves[flank], **sizes)
        added[gear.teeth :] -= profiles * np.ravel(read)
        return _figures(pair, name, added).shares(limits)

    bare, full = shares("back", 0.0), shares("back", 1.0)
    worst = float(max(*shares("drive", 1.0), *bare))
    # each share is a norm of what is read, so convex in the size of the profiles
    over = full > worst
    back = float(np.min((worst - bare[over]) / (full[over] - bare[over]), initial=1.0))
    scale = 1e3 * share / worst
    return (
        replace(centre, amount=scale * centre.amount),
        replace(pitch, errors=tuple(scale * np.asarray(pitch.errors))),
        _shapes(name, "drive", sides["drive"], waves=waves["drive"], size=scale),
        _shapes(name, "back", sides["back"], waves=waves["back"], size=scale * back),
    )


def drawn_pair(
    pair: GearPair,
    grade: int,
    *,
    seed: int,
    place: int = 0,
    edition: str = "2013",
    population: Population = Population(),
) -> tuple[Deviation, ...]:
    """Both gears of the drawing number ``place``, sizes in [m]; the same whatever else is drawn.

    Drawing n has the n-th child of ``seed`` (:meth:`numpy.random.SeedSequence.spawn`), each gear a
    child of that, pinion first.

    >>> pair = GearPair(Gear(20, 3e-3), Gear(40, 3e-3))
    >>> len(drawn_pair(pair, 6, seed=1))
    8
    """
    return tuple(
        one
        for number, name in enumerate(GEARS)
        for one in drawn_gear(
            pair,
            name,
            grade,
            seed=np.random.SeedSequence(seed, spawn_key=(place, number)),
            edition=edition,
            population=population,
        )
    )


def _rayleigh(rng: np.random.Generator, mean: float) -> float:
    return float(rng.rayleigh(mean * math.sqrt(2.0 / math.pi)))


def _side(
    rng: np.random.Generator, p: Population, limits: FlankTolerances, teeth: int
) -> tuple[dict[str, Floats], float]:
    """Profiles of one side, tooth by tooth: what the tool makes, and the scatter; its waves."""
    slope = p.slope * rng.standard_normal() + p.slope_scatter * rng.standard_normal(teeth)
    barrel, wave = rng.normal(*p.barrel), _rayleigh(rng, p.wave)
    waves, phase = rng.uniform(*p.waves), rng.uniform(0.0, 2.0 * math.pi)
    heights = 1.0 + p.form_scatter * rng.standard_normal((2, teeth))
    return {
        "slope": slope * limits.profile_slope,
        "barrel": barrel * limits.profile_form * heights[0],
        "wave": wave * limits.profile_form * heights[1],
        "phase": phase + p.phase_scatter * rng.standard_normal(teeth),
    }, waves


def _shapes(
    name: str, flank: str, columns: dict[str, Floats], *, waves: float, size: float
) -> ToothShapes:
    """Profiles of every tooth, ``size`` times as large as their ``columns``."""
    factors = {"phase": 1.0}
    rows = zip(
        *((factors.get(of, size) * column).tolist() for of, column in columns.items()), strict=True
    )
    made = (dict(zip(columns, row, strict=True)) for row in rows)
    return ToothShapes(
        name, tuple(ToothProfile(name, waves=waves, flank=flank, **row) for row in made)
    )
