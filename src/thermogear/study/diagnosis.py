"""``diagnose``: what records say of gears and bearings, held against a baseline of one machine.

No indicator has a limit that holds for every machine. Without a baseline there are values and no
verdict; with one record of it the verdict stays open, since one assembly differs from the next.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from thermogear.base.arrays import Dataset, Floats, Whole
from thermogear.base.errors import InputError
from thermogear.base.limits import zone_of
from thermogear.base.progress import Progress, silent
from thermogear.base.vocabulary import label
from thermogear.measured.diagnosis import (
    PINION,
    SHAFTS,
    WHEEL,
    InAngle,
    ShaftAverage,
    raw_values,
    shaft_average,
)
from thermogear.measured.impacts import (
    BAND_SAMPLES,
    HEARD,
    BearingLine,
    BearingRates,
    Impacts,
    impacts,
)
from thermogear.results.result import Notice, Result, now
from thermogear.signals.indicators import (
    amplitude_half_width,
    demodulated_harmonics,
    gear_indicators,
    modulation_depths,
    moment_scatter,
    na4_of_moments,
    order_amplitudes,
    tooth_deviations,
)
from thermogear.signals.kurtogram import real_cepstrum
from thermogear.signals.synchronous import demodulated, separated, tooth_means

INDICATORS = (
    "fm0", "fm4", "energy_ratio", "sideband_ratio", "amplitude_depth", "phase_depth", "na4",
    "rms", "residual_rms", "m6a", "m8a", "energy_operator", "kurtosis", "crest", "sideband_index",
)  # fmt: skip
"""Of every shaft, in the order of the table."""
DECIDED = INDICATORS[:6]
"""Those that are held against limits: ratios, which a change of gain leaves as they are (NA4 over
the variance of healthy records grows with its fourth power). Those that say the same again, as M6A
beside FM4, would only widen the limits of all."""
LEVEL = 0.2
"""Share by which the rms of a record lies outside that of the baseline, from which nothing is
decided: load, gain or noise are others then (chosen)."""
ALARM = 0.05
"""Chance of any false alarm over all that is decided of one record: chosen, as usual."""
BY_CHANCE = 0.001
"""Chance that as many averages have their greatest residual at one tooth, up to which the tooth is
named (chosen)."""
CLEAR = 4.0
"""Robust standard deviations of the other teeth from which a tooth's amplitude or timing counts as
off (chosen)."""
ALIKE = 0.5
"""Relative difference of the delays of mesh harmonics up to which they are one delay (chosen)."""
UNLIKE = 0.02
"""Relative difference of speed, or of the mesh line's order, from which a record is not like the
baseline (chosen)."""
FIRST_HARMONIC = 0.1
"""Share of a mesh harmonic that the first one has at least, where they are one gear's (chosen)."""
MOST_DRAWN = 4096

EITHER = "pinion or wheel"

Key = tuple[str, str, str]
"""Channel, shaft and indicator."""


@dataclass(frozen=True, kw_only=True)
class Reduced:
    """A record's ``values`` of every average by channel, shaft and indicator; its ``shafts``, what
    else is heard (``impacts``), ``cepstrum`` (channel, quefrency in turns of the pinion x
    ``per_turn``), ``raw`` values by channel; the rest as in the record."""

    name: str
    channels: tuple[str, ...]
    values: dict[Key, Floats]
    shafts: tuple[ShaftAverage, ...]
    impacts: Impacts
    cepstrum: Floats
    per_turn: int
    raw: dict[str, Floats]
    speed: float
    mesh: float
    marked: bool
    origin: str
    noise: float
    notices: tuple[Notice, ...]
    unit: str


def reduced(
    record: InAngle,
    name: str,
    *,
    teeth: tuple[int, int | None],
    held: tuple[int, ...] = (),
    bearings: Sequence[tuple[str, BearingRates]] = (),
    band: tuple[float, float] | None = None,
) -> Reduced:
    """A record in angle as its averages, their indicators and what is heard beside them.

    ``teeth`` of pinion and wheel; ``held`` turns of both shafts in the record that sets how long an
    average is, () where it is this one. The wheel is left out where it turns fewer than four times.
    """
    notices = list(record.notices)
    names = [PINION]
    if teeth[1] is not None:
        if record.length * teeth[0] >= 4 * teeth[1]:
            names.append(WHEEL)
        else:
            turns = record.length * teeth[0] / teeth[1]
            notices.append(Notice.of("few_turns_of_wheel", turns=turns))
    given = dict(zip(SHAFTS, held, strict=False))
    straight, per_turn = record.straightened
    shafts = [shaft_average(record, shaft, teeth=teeth, turns=given.get(shaft)) for shaft in names]
    values: dict[Key, Floats] = {}
    for shaft in shafts:
        rows = gear_indicators(
            shaft.blocks, mesh_order=shaft.teeth, highest=shaft.highest, step=shaft.step
        )
        for place, channel in enumerate(record.channels):
            lost = np.nan if channel in record.withheld else 1.0
            values |= {(channel, shaft.name, k): lost * row[place] for k, row in rows.items()}
    return Reduced(
        name=name,
        channels=record.channels,
        values=values,
        shafts=tuple(shafts),
        impacts=impacts(
            straight,
            angle=record.turns,
            channels=record.channels,
            ratios={PINION: 1.0, WHEEL: teeth[0] / (teeth[1] or teeth[0])},
            bearings=bearings,
            band=band,
        ),
        cepstrum=real_cepstrum(straight[:, :BAND_SAMPLES]),
        per_turn=per_turn,
        raw=raw_values(record),
        speed=record.speed,
        mesh=_mesh_order(record.mesh, shafts[0]),
        marked=record.marked,
        origin=record.origin,
        noise=record.noise,
        notices=tuple(notices),
        unit=record.record.channel(record.channels[0]).unit or "",
    )


def _mesh_order(found: float, pinion: ShaftAverage) -> float:
    """The order at which the mesh line was ``found``, or the teeth of the pinion where that is a
    harmonic of theirs, and the first one is there."""
    rank = round(found / pinion.teeth)
    lines = order_amplitudes(pinion.average).max(axis=0)
    harmonic = rank * pinion.teeth
    if rank < 2 or harmonic > pinion.highest or abs(found / harmonic - 1.0) > UNLIKE:
        return found
    return float(pinion.teeth) if lines[pinion.teeth] > FIRST_HARMONIC * lines[harmonic] else found


def with_na4(rows: Sequence[Reduced], healthy: int) -> list[Reduced]:
    """The records with NA4: over the variance of the first ``healthy`` of them, else over that of
    all averages up to each, in the order of the records."""
    values_of = [dict(row.values) for row in rows]
    for channel, shaft, name in rows[0].values:
        if name != "residual_fourth" or any((channel, shaft, name) not in row for row in values_of):
            continue
        variances = [row[channel, shaft, "residual_rms"] ** 2 for row in values_of]
        fourths = np.concatenate([row[channel, shaft, name] for row in values_of])
        mean = float(np.mean(np.concatenate(variances[:healthy]))) if healthy else None
        na4 = na4_of_moments(fourth=fourths, variance=np.concatenate(variances), healthy=mean)
        ends = np.cumsum([variance.size for variance in variances])[:-1]
        for row, part in zip(values_of, np.split(na4, ends), strict=True):
            row[channel, shaft, "na4"] = part
    return [replace(row, values=values) for row, values in zip(rows, values_of, strict=True)]


# --- limits --------------------------------------------------------------------------------------


@dataclass(frozen=True, kw_only=True)
class Healthy:
    """What a baseline says of one indicator: the ``least``, the ``median`` and the ``greatest`` of
    its averages, and the ``limit`` (infinite where one record tells no scatter between records)."""

    least: float
    median: float
    greatest: float
    limit: float


UNKNOWN = Healthy(least=np.nan, median=np.nan, greatest=np.nan, limit=np.nan)
"""Without a baseline."""


def healthy_limit(baseline: Sequence[Floats], *, family: int, alarm: float = ALARM) -> Healthy:
    """The limit of an indicator by the averages of each of B healthy records.

    ln L = mean y + t s sqrt(1 + 1/B), y = ln of each record's median, s their standard deviation,
    t Student's quantile of ``alarm``/``family`` with B - 1 degrees: the one-sided prediction limit
    of one more record, so that of a ``family`` of indicators any is beyond with a chance of at most
    ``alarm`` (Bonferroni) where logarithms scatter normally. L is never below the greatest average
    of the baseline. Range: B >= 2; one record knows nothing of the scatter, its limit is infinite.
    Source: Hahn and Meeker 1991, Statistical Intervals, section 4.8.

    >>> rows = [np.array([1.0, 1.1]), np.array([1.2, 1.0]), np.array([1.05, 1.15])]
    >>> f"{healthy_limit(rows, family=4).limit:.3f}"
    '1.313'
    """
    pooled = np.concatenate(baseline)
    pooled = pooled[np.isfinite(pooled)]
    known = [np.median(row[np.isfinite(row)]) for row in baseline if np.isfinite(row).any()]
    medians = np.array([median for median in known if median > 0.0])
    if not medians.size:
        return UNKNOWN
    limit = np.inf
    if medians.size > 1:
        from scipy import stats

        logs, count = np.log(medians), medians.size
        t = float(stats.t.isf(alarm / family, count - 1))
        limit = float(np.exp(logs.mean() + t * logs.std(ddof=1) * np.sqrt(1.0 + 1.0 / count)))
    least, middle, greatest = (float(np.quantile(pooled, share)) for share in (0.0, 0.5, 1.0))
    return Healthy(least=least, median=middle, greatest=greatest, limit=max(limit, greatest))


def trend_of(values: Sequence[float]) -> tuple[float, float]:
    """Relative change from record to record after Theil and Sen, and the chance of as clear a trend
    in records that do not change (Mann-Kendall: Kendall's tau with their order, two-sided, exact).

    >>> slope, chance = trend_of([1.0, 1.1, 1.25, 1.3, 1.4])
    >>> f"{slope:.2f}, {chance:.3f}"
    '0.08, 0.017'
    """
    from scipy import stats

    y = np.asarray(values, dtype=float)
    order = np.arange(float(y.size))
    slope = float(stats.theilslopes(y, order).slope) / float(np.median(y))
    return slope, float(stats.kendalltau(order, y).pvalue)


# --- where ---------------------------------------------------------------------------------------


MODULATION = (
    "amplitude", "delay", "depth", "timing", "amplitude_half_width", "delay_half_width",
)  # fmt: skip
"""What of a :class:`Place` is told of each mesh harmonic."""


@dataclass(frozen=True, kw_only=True)
class Place:
    """The tooth (from 1) of a ``shaft`` where the difference signal of a ``channel`` is greatest.

    ``agreeing`` of ``averages`` have it there, by chance as many with ``chance``; of each mesh
    harmonic the change of ``amplitude`` [-] and the ``delay`` [pitches] there against the other
    teeth (0 where it is less than 4 of their standard deviations), the ``depth`` [-] and the
    modulation of ``timing`` [pitches] over the turn, and the 95 % half widths of all by noise
    (:func:`~thermogear.signals.indicators.amplitude_half_width`): ``amplitude_half_width`` of
    amplitude and depth, ``delay_half_width`` of delay and timing. ``alike``: two harmonics or more
    have one delay.
    """

    channel: str
    shaft: str
    tooth: int
    agreeing: int
    averages: int
    chance: float
    amplitude: tuple[float, ...]
    delay: tuple[float, ...]
    depth: tuple[float, ...]
    timing: tuple[float, ...]
    amplitude_half_width: tuple[float, ...]
    delay_half_width: tuple[float, ...]
    alike: bool


def loudest_teeth(
    averages: ArrayLike,
    *,
    teeth: int,
    highest: int,
    step: int | None = None,
    contact_ratio: float = 1.0,
) -> Whole:
    """The tooth, from 0, over whose contact each average's difference signal has most power, (...).

    ``averages`` over one turn of a gear (..., sample), ``highest`` and ``step`` as of
    :func:`~thermogear.signals.synchronous.separated`. Tooth n meshes in pitch n and, of a
    ``contact_ratio`` up to 2, as much beyond 1 of the next; 1 where it is not known.

    >>> angle = 2.0 * np.pi * np.arange(256) / 256
    >>> burst = np.cos(52 * angle) * (np.abs(angle - 0.9 * np.pi) < 0.1)
    >>> int(loudest_teeth(burst, teeth=20, highest=100))
    9
    """
    parts = separated(averages, mesh_order=teeth, highest=highest, step=step)
    power = tooth_means(parts.difference**2, teeth=teeth)
    late = min(contact_ratio - 1.0, 1.0) * np.roll(power, -1, axis=-1)
    return np.asarray(np.argmax(power + late, axis=-1))


def place_of(shaft: ShaftAverage, channel: int, name: str) -> Place:
    """Where on a shaft a channel's difference signal is greatest, with its evidence."""
    from scipy import stats

    teeth, average = shaft.teeth, shaft.average[channel]
    signals = [average, *shaft.blocks[channel]]
    tooth, *places = loudest_teeth(
        signals, teeth=teeth, highest=shaft.highest, step=shaft.step
    ).tolist()
    agreeing = places.count(tooth)
    near = [(tooth + off) % teeth for off in (-1, 0, 1)]
    rows = [
        _modulation(shaft, channel, k, near)
        for k in demodulated_harmonics(mesh_order=teeth, highest=shaft.highest)
    ]
    harmonics = {name: tuple(row[name] for row in rows) for name in MODULATION}
    seen = np.array([delay for delay in harmonics["delay"] if delay != 0.0])
    alike = seen.size >= 2 and bool(np.ptp(seen) <= ALIKE * np.abs(seen).max())
    return Place(
        channel=name,
        shaft=shaft.name,
        tooth=tooth + 1,
        agreeing=agreeing,
        averages=len(places),
        chance=float(stats.binom.sf(agreeing - 1, len(places), 1.0 / teeth)),
        alike=alike,
        **harmonics,
    )


def _modulation(
    shaft: ShaftAverage, channel: int, harmonic: int, near: Sequence[int]
) -> dict[str, float]:
    """What of a :class:`Place` counts for each mesh harmonic, by :data:`MODULATION`."""
    a, bands = (
        demodulated(signals[channel], mesh_order=shaft.teeth, harmonic=harmonic)
        for signals in (shaft.average, shaft.blocks)
    )
    size, pitch = np.abs(a), 2.0 * np.pi * harmonic
    phase = np.angle(a * np.conj(a.mean())) / pitch
    depth, turned = modulation_depths(a)
    wide = float(
        amplitude_half_width(bands, mesh_order=shaft.teeth, share=shaft.block_turns / shaft.turns)
    )
    values = (
        _beyond(tooth_means(size / np.median(size), teeth=shaft.teeth) - 1.0, near),
        _beyond(-tooth_means(phase, teeth=shaft.teeth), near),
        float(depth),
        float(turned) / pitch,
        2.0 * wide / max(float(size.max() + size.min()), 1e-300),
        wide / max(float(size.min()), 1e-300) / pitch,
    )
    return dict(zip(MODULATION, values, strict=True))


def _beyond(values: Floats, near: Sequence[int]) -> float:
    """The value, less the median of all, that is farthest off near a tooth; 0: none is clear."""
    deviation = np.abs(tooth_deviations(values))
    best = max(near, key=lambda place: float(deviation[place]))
    return float(values[best] - np.median(values)) if deviation[best] > CLEAR else 0.0


# --- the study -----------------------------------------------------------------------------------

Source = tuple[str, Callable[[], InAngle]]
"""The name of a record and what reads it into its angle."""
NO_BASELINE, ONE_BASELINE, CHANGED, OPEN, UNCHANGED = (
    "no baseline", "one baseline record", "changed", "undecided", "no change",
)  # fmt: skip
OTHER_LEVEL, OTHER_SPEED, OTHER_GEARS = "another level", "another speed", "other gears"
"""Of a record that is not like the baseline: nothing is decided."""


@dataclass(frozen=True, kw_only=True)
class Judged:
    """A tested record beside the limits: its ``medians`` by key, those ``beyond`` their limit and
    those ``above`` and ``below`` every healthy average, the ``verdict``, where the change is
    (``places``). A fault adds to an average; one that lacks what it had is of other gears as
    likely: "changed" takes more indicators beyond their limit than below, "no change" none below;
    ``unlike``: what of it is not the baseline's, its own value and the baseline's: of its level
    rms over that of the nearest healthy record and 1, its speed [rad/s], its mesh line's order."""

    name: str
    medians: dict[Key, float]
    beyond: tuple[Key, ...]
    above: tuple[Key, ...]
    below: tuple[Key, ...]
    verdict: str
    places: tuple[Place, ...]
    unlike: tuple[float, float]


def diagnose(
    records: Sequence[Source],
    baseline: Sequence[Source] = (),
    *,
    teeth: tuple[int, int | None],
    bearings: Sequence[tuple[str, BearingRates]] = (),
    band: tuple[float, float] | None = None,
    machine: str | None = None,
    progress: Progress = silent,
) -> Result:
    """Averages, indicators and envelopes of ``records``, held against those of a ``baseline``.

    ``teeth`` of pinion and wheel (None: not known); ``bearings``: (shaft, rates); ``band`` [orders
    of the pinion] to demodulate; ``machine``: a class of
    :data:`~thermogear.base.limits.VIBRATION_ZONES` for the velocity's zone. A record that cannot be
    read is left out with a notice where others are left. Raises InputError where none is.
    """
    notices: list[Notice] = []
    rows: list[Reduced] = []
    counts = []
    for sources in (baseline, records):
        before, first = len(rows), None
        for name, read in sources:
            held = tuple(shaft.held for shaft in rows[0].shafts) if rows else ()
            try:
                rows.append(
                    reduced(read(), name, teeth=teeth, held=held, bearings=bearings, band=band)
                )
            except InputError as error:
                first = first or error
                notices.append(Notice.of("record_left_out", record=name, reason=str(error)))
            progress("records", len(rows), len(baseline) + len(records))
        counts.append(len(rows) - before)
        if first is not None and counts[-1] == 0:
            raise first
    healthy, tested = counts[0], with_na4(rows, counts[0])[counts[0] :]
    base = with_na4(rows, healthy)[:healthy]
    limits = _limits(base, tested)
    judged = [_judged(row, limits, base) for row in tested]
    notices += _notices(base, tested, teeth)
    return Result.of(
        "diagnosis",
        f"{len(tested)} record{'s' * (len(tested) > 1)}"
        + (f" against a baseline of {healthy}" if healthy else ""),
        _groups(tested, judged, limits),
        dict.fromkeys(notices),
        created=now(),
        unit=tested[-1].unit,
        figures=_figures(base, tested, judged, limits, machine),
    )


def _limits(base: Sequence[Reduced], tested: Sequence[Reduced]) -> dict[Key, Healthy]:
    """What the baseline says of every indicator that it and a tested record have."""
    keys = [key for key in tested[-1].values if key[2] in INDICATORS]
    shared = [key for key in keys if base and all(key in row.values for row in base)]
    if base and not shared:
        got = ", ".join(tested[-1].channels)
        known = ", ".join(base[0].channels)
        raise InputError("--baseline", f"channels {known}", why=f"the record has {got}")
    family = sum(key[2] in DECIDED for key in shared)
    return {key: healthy_limit([row.values[key] for row in base], family=family) for key in shared}


def _level(row: Reduced, base: Sequence[Reduced]) -> float:
    """Its rms over the nearest of the baseline's, of the channel that is farthest off; 1 within."""
    ratios = [1.0]
    for place, name in enumerate(row.channels):
        healthy = [b.raw["raw_rms"][b.channels.index(name)] for b in base if name in b.channels]
        if healthy:
            value = float(row.raw["raw_rms"][place])
            nearest = float(np.clip(value, min(healthy), max(healthy)))
            ratios.append(value / nearest if nearest > 0.0 else 1.0)
    return max(ratios, key=lambda ratio: abs(np.log(max(ratio, 1e-300))))


def _judged(row: Reduced, limits: dict[Key, Healthy], base: Sequence[Reduced]) -> Judged:
    known = sorted(
        (key for key in row.values if key[2] in INDICATORS),
        key=lambda key: (SHAFTS.index(key[1]), INDICATORS.index(key[2])),
    )
    values = {key: row.values[key][np.isfinite(row.values[key])] for key in known}
    medians = {key: float(np.median(v)) if v.size else np.nan for key, v in values.items()}
    decided = [key for key in limits if key[2] in DECIDED and key in medians]
    beyond = tuple(key for key in decided if medians[key] > limits[key].limit)
    above = tuple(key for key in decided if medians[key] > limits[key].greatest)
    below = tuple(key for key in decided if medians[key] < limits[key].least)
    verdict, unlike = UNCHANGED if base else NO_BASELINE, (_level(row, base), 1.0)
    if base and (above or below):
        verdict = CHANGED if len(beyond) > len(below) else OPEN
    if abs(np.log(unlike[0])) > np.log1p(LEVEL):
        verdict = OTHER_LEVEL
    if len(base) == 1:
        verdict = ONE_BASELINE
    for name, other in (("speed", OTHER_SPEED), ("mesh", OTHER_GEARS)) if base else ():
        value, healthy = getattr(row, name), float(np.median([getattr(b, name) for b in base]))
        if abs(value / healthy - 1.0) > UNLIKE:
            verdict, unlike = other, (value, healthy)
    places = []
    for shaft in row.shafts:
        keys = [key for key in medians if key[1] == shaft.name]
        ranks = {
            key: medians[key] / (limits[key].greatest if key in limits else 1.0)
            for key in keys
            if (key[2] in DECIDED if limits else key[2] == "fm4") and np.isfinite(medians[key])
        }
        channel = max(ranks, key=lambda key: ranks[key], default=(row.channels[0],))[0]
        places.append(place_of(shaft, row.channels.index(channel), channel))
    return Judged(
        name=row.name,
        medians=medians,
        beyond=beyond,
        above=above,
        below=below,
        verdict=verdict,
        places=tuple(places),
        unlike=unlike,
    )


def changed_shaft(
    judged: Judged, limits: dict[Key, Healthy], shafts: Sequence[ShaftAverage]
) -> str:
    """The shaft on which most changed, :data:`EITHER` where the teeth do not tell, "" for none.

    Of shafts of which any indicator is beyond its limit the one that is furthest beyond. Where all
    orders of a shaft, or every second, are its mate's, a change of one shows in both.
    """
    if judged.verdict != CHANGED:
        return ""
    if any(shaft.step is not None and shaft.step <= 2 for shaft in shafts):
        return EITHER
    excess: dict[str, float] = {}
    for key in judged.beyond:
        over = float(np.log(judged.medians[key] / limits[key].limit))
        excess[key[1]] = max(excess.get(key[1], 0.0), over)
    return max(excess, key=lambda name: excess[name], default="")


def _notices(
    base: Sequence[Reduced], tested: Sequence[Reduced], teeth: tuple[int, int | None]
) -> list[Notice]:
    """What must be known of the averages, and of the records themselves."""
    last = tested[-1]
    notices: list[Notice] = []
    if teeth[1] is None:
        notices.append(Notice.of("wheel_teeth_not_stated"))
    for shaft in last.shafts:
        if shaft.step is not None and shaft.step < shaft.teeth:
            notices.append(
                Notice.of(
                    "orders_of_both_shafts", shaft=shaft.name, step=shaft.step, twice=2 * shaft.step
                )
            )
        if shaft.leakage and shaft.leakage[1] > 1e-6:
            notices.append(
                Notice.of(
                    "mate_leaks",
                    shaft=shaft.name,
                    turns=shaft.block_turns,
                    share=shaft.leakage[1],
                )
            )
    if not last.marked:
        notices.append(Notice.of("tooth_one_arbitrary", origin=last.origin))
    named: dict[Notice, list[str]] = {}
    for row in (*base, *tested):
        for notice in row.notices:
            named.setdefault(notice, []).append(row.name)
    several = len(base) + len(tested) > 1
    return notices + [n.of_files(names) if several else n for n, names in named.items()]


def _groups(
    tested: Sequence[Reduced], judged: Sequence[Judged], limits: dict[Key, Healthy]
) -> dict[str, Dataset]:
    """Group ``indicators`` (record, row), and of the last record each shaft's turn, the envelope
    that is clearest, and the cepstra."""
    keys = list(judged[-1].medians)
    healthy = [limits.get(key, UNKNOWN) for key in keys]
    value = [[each.medians.get(key, np.nan) for key in keys] for each in judged]
    beyond = [[float(key in each.beyond) for key in keys] for each in judged]
    last = tested[-1]
    indicators = label(
        {
            "indicator_value": (("record", "row"), value, "", "median of the averages"),
            "indicator_beyond": (("record", "row"), beyond, "1", "beyond its limit"),
            **{
                f"healthy_{name}": (("row",), [getattr(h, name) for h in healthy], "", name)
                for name in ("least", "median", "greatest")
            },
            "indicator_limit": (
                ("row",),
                [
                    scatter.limit if key[2] in DECIDED else np.nan
                    for key, scatter in zip(keys, healthy, strict=True)
                ],
                "",
                "limit",
            ),
        }
    ).assign_coords(
        record=[row.name for row in tested],
        channel=("row", [key[0] for key in keys]),
        shaft=("row", [key[1] for key in keys]),
        indicator=("row", [key[2] for key in keys]),
    )
    groups = {"indicators": indicators}
    for shaft in last.shafts:
        groups[shaft.name] = _turn(shaft, last.channels)
    spectra = last.impacts.spectra
    clear = int(np.argmax([np.max(each.amplitude / each.floor) for each in spectra]))
    spectrum = spectra[clear]
    shown = spectrum.position <= _highest_shown(last.impacts)
    half = last.cepstrum.shape[-1] // 2
    count = min(half, MOST_DRAWN)
    groups["envelope"] = label(
        {
            "envelope_amplitude": (("line",), spectrum.amplitude[shown], "1", "over the mean"),
            "envelope_floor": (("line",), spectrum.floor[shown], "1", "of noise"),
            "envelope_order": (("line",), spectrum.position[shown], "1", "order of the pinion"),
        }
    ).assign_attrs(channel=last.channels[clear])
    quefrency = np.arange(1, count) / last.per_turn
    groups["cepstrum"] = label(
        {
            "cepstrum": (("channel", "quefrency"), last.cepstrum[:, 1:count], "1", "cepstrum"),
            "turns": (("quefrency",), quefrency, "1", "turns of the pinion"),
        }
    ).assign_coords(channel=list(last.channels))
    return groups


def _highest_shown(found: Impacts) -> float:
    """The order up to which an envelope is drawn: past the highest rate that was looked for."""
    return max([10.0, *(1.5 * line.order for line in found.lines if np.isfinite(line.order))])


def _turn(shaft: ShaftAverage, channels: Sequence[str]) -> Dataset:
    """One turn of a shaft: average, difference, and each mesh harmonic's amplitude and phase."""
    parts = separated(shaft.average, mesh_order=shaft.teeth, highest=shaft.highest, step=shaft.step)
    harmonics = demodulated_harmonics(mesh_order=shaft.teeth, highest=shaft.highest)
    bands = [demodulated(shaft.average, mesh_order=shaft.teeth, harmonic=k) for k in harmonics]
    count = shaft.average.shape[-1]
    a = np.array(bands).reshape(-1, len(channels), count)
    mean = a.mean(axis=-1, keepdims=True)
    axes = ("harmonic", "channel", "sample")
    return label(
        {
            "average": (axes[1:], shaft.average, "", "synchronous average"),
            "difference": (axes[1:], parts.difference, "", "difference signal"),
            "mesh_amplitude": (axes, np.abs(a), "", "amplitude of the mesh harmonic"),
            "mesh_phase_error": (axes, np.angle(a * np.conj(mean)), "rad", "its phase"),
            "teeth_turned": (("sample",), np.arange(count) * shaft.teeth / count, "1", "tooth"),
        }
    ).assign_coords(channel=list(channels), harmonic=list(harmonics))


def _figures(
    base: Sequence[Reduced],
    tested: Sequence[Reduced],
    judged: Sequence[Judged],
    limits: dict[Key, Healthy],
    machine: str | None,
) -> dict[str, Any]:
    """Plain figures: verdicts, where, bearings, trends, severity, and how averages were made."""
    last = tested[-1]
    known = {line.bearing + line.shaft + line.part for row in base for line in row.impacts.lines
             if line.chance <= HEARD}  # fmt: skip
    family = [key for key in limits if key[2] in DECIDED]
    before = {
        (place.shaft, place.tooth)
        for row in base
        if row.marked
        for place in _judged(row, limits, base).places
        if place.chance <= BY_CHANCE
    }
    return {
        "verdicts": [
            {
                "record": each.name,
                "verdict": each.verdict,
                "shaft": changed_shaft(each, limits, row.shafts),
                "unlike": list(each.unlike),
                "beyond": len(each.beyond),
                "above": len(each.above),
                "below": len(each.below),
                "indicators": len(family),
            }
            for each, row in zip(judged, tested, strict=True)
        ],
        "baseline": [row.name for row in base],
        "alarm": ALARM,
        "places": [
            {
                "record": each.name,
                **{name: getattr(place, name) for name in Place.__dataclass_fields__},
                "named": place.chance <= BY_CHANCE
                and not (row.marked and (place.shaft, place.tooth) in before),
                "marked": row.marked,
            }
            for each, row in zip(judged, tested, strict=True)
            for place in each.places
        ],
        "bearings": [
            {
                "record": row.name,
                **{name: getattr(line, name) for name in BearingLine.__dataclass_fields__},
                "words": line.words,
                "in_baseline": line.bearing + line.shaft + line.part in known,
            }
            for row in tested
            for line in row.impacts.lines
            if line.chance <= HEARD
        ],
        "bands": [
            {
                "channel": channel,
                "low": band.low,
                "high": band.high,
                "kurtosis": band.kurtosis,
                "chosen": chosen,
            }
            for channel, band, chosen in zip(
                last.channels, last.impacts.bands, last.impacts.chosen, strict=True
            )
        ],
        "raw": [
            {
                "record": row.name,
                "channel": channel,
                **{name: float(values[place]) for name, values in row.raw.items()},
                "zone": zone_of(row.raw["velocity_rms"][place], machine) if machine else "",
            }
            for row in tested
            for place, channel in enumerate(row.channels)
        ],
        "shafts": [_about(shaft) for shaft in last.shafts],
        "trends": _trends(judged),
        "speed": last.speed if np.isfinite(last.speed) else None,
        "angle": last.origin,
        "angle_noise": last.noise,
        "machine": machine or "",
    }


def _about(shaft: ShaftAverage) -> dict[str, Any]:
    """How a shaft's averages were made, and what was taken out of its residual."""
    parts = separated(shaft.average, mesh_order=shaft.teeth, highest=shaft.highest, step=shaft.step)
    return {
        "shaft": shaft.name,
        "teeth": shaft.teeth,
        "turns": shaft.turns,
        "block_turns": shaft.block_turns,
        "blocks": int(shaft.blocks.shape[1]),
        "highest": shaft.highest,
        "leakage": shaft.leakage[1] if shaft.leakage else None,
        "removed": list(parts.removed),
        "removed_sidebands": list(parts.removed_sidebands),
        "scatter": moment_scatter(4, count=max(1, 2 * parts.kept)),
        "hunting": shaft.step == shaft.teeth,
    }


def _trends(judged: Sequence[Judged]) -> list[dict[str, Any]]:
    """Of three records or more what rises or falls, with its chance times what was looked at."""
    if len(judged) < 3:
        return []
    keys = [key for key in judged[-1].medians if key[2] in DECIDED]
    trends: list[dict[str, Any]] = []
    for key in keys:
        values = [each.medians.get(key, np.nan) for each in judged]
        if np.all(np.isfinite(values)) and np.median(values) > 0.0:
            slope, chance = trend_of(values)
            row = dict(zip(("channel", "shaft", "indicator"), key, strict=True))
            trends.append({**row, "trend": slope, "chance": min(1.0, chance * len(keys))})
    return [row for row in trends if row["chance"] <= ALARM]
