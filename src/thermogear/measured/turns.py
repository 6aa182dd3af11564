"""The mesh line's mean frequency with its 95 % interval, and the angle where the speed wanders."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy import fft

from thermogear.base.arrays import Floats
from thermogear.measured.chain import Turning
from thermogear.measured.gearing import Gearing, sides_of
from thermogear.measured.record import Notice
from thermogear.signals.filters import thinned
from thermogear.signals.following import (
    Followed,
    band_power,
    filter_widths,
    follow_line,
    power_beyond,
)
from thermogear.signals.interval import APART, Reading, read_line
from thermogear.signals.lines import LineSpectrum, line_in, line_spectrum
from thermogear.signals.orders import samples_per_cycle
from thermogear.signals.strong import Strong, strong_lines, twins

_STEADY = 0.02  # cycles of wander at the highest line: 0.8 % of its amplitude
_KEPT = 0.8  # of the power near the mesh line that a steady line must explain
_MISSED = 0.002  # of the line's power: a tenth of a per cent of its amplitude
_BROUGHT = 0.75
_TOLD = 0.01  # of its power
_ALIKE = 1.5  # of the phase's noise
_EXPLAINED = 1.1  # times the power of lines beside a line, all that is there
_STILL = 0.1  # of a line, that no steady one explains
_FEW = 4.0  # turns of a shaft over the record
_AS_FAR = 3.0  # times the distance of the first sidebands, up to which is looked
_CLEAR = 3  # bins of a line's own lobe, Hann's window
_CLEARLY = 3.0  # times the power of Q
_THIN = 0.25  # cycles a sample, of the line while filters are tried
_HELD = 1.0  # of the filter's half width: there its phase has taken the noise away


@dataclass(frozen=True, kw_only=True)
class MeshTurns:
    """The mesh line over the stretch: its turns over the time they take.

    ``frequency`` +- ``half_width`` (95 %) [cycles/sample]; ``turning``: the angle to read lines in,
    None where the speed is steady enough; ``told`` how it was found; ``phase_noise`` [rad]: what
    noise brings to that angle and what of the turning it misses, in the mesh line's own phase;
    ``unfollowed``: power beside the line that its reading lacks and that may be its own, of its
    power; ``spread``: what of ``half_width`` comes of that; ``doubt``: share of the power near the
    line that may be its own or others'.
    """

    frequency: float
    half_width: float
    turning: Turning | None = None
    told: tuple[Notice, ...] = ()
    phase_noise: float = 0.0
    followed: float = 0.0
    power: float = 0.0
    unfollowed: float = 0.0
    spread: float = 0.0
    doubt: float = 0.0


def few_turns(gearing: Gearing, *, teeth: int | None, samples: int) -> list[Notice]:
    """Where the gear of these ``teeth`` turned so little in the ``samples`` that its sidebands are
    not told from a speed that wanders: they are not read."""
    turns = gearing.mesh_frequency * samples / teeth if teeth else np.inf
    return [Notice.of("few_turns", turns=turns, least=_FEW)] if turns < _FEW else []


def mesh_turns(
    table: Floats,
    gearing: Gearing,
    *,
    teeth: int | None,
    harmonics: int,
) -> MeshTurns:
    """The mesh line's mean frequency: as a steady line, or followed by its phase.

    ``table`` (channel, sample). A steady line is taken for
    one where its phase, noise taken away, wanders by less than a fiftieth of a turn at the
    highest of ``harmonics``, and where it explains the power near it.
    """
    values, spectrum = clearest(table, gearing.mesh_frequency)
    line = line_in(spectrum, near=gearing.mesh_frequency, half_width=_reach(spectrum, gearing))
    beside = sides_of(teeth=teeth, rank=1, mesh=line.frequency)
    strong = strong_lines(spectrum)
    reading = read_line(spectrum, line.frequency, beside=beside, strong=strong)
    least = _wandering(spectrum, reading, beside, strong, harmonics)
    turns: MeshTurns | None = None
    if least is not None:
        turns = _follow(values, spectrum, line.frequency, least=least, beside=beside)
    if turns is not None:
        return _or_steady(turns, spectrum, reading, beside, strong)
    best = reading.frequency, reading.frequency_half_width
    for rank in range(2, harmonics + 1):
        if 2.56 * rank * reading.frequency > 1.0:
            break
        other = read_line(
            spectrum,
            rank * reading.frequency,
            beside=sides_of(teeth=teeth, rank=rank, mesh=reading.frequency),
            strong=strong,
        )
        if other.frequency_half_width / rank < 0.5 * best[1]:  # not the luckier estimate: clearly
            best = other.frequency / rank, other.frequency_half_width / rank
    share, spread = unfollowed(spectrum, reading, beside, strong)
    return MeshTurns(
        frequency=best[0],
        half_width=float(np.hypot(best[1], spread)),
        told=_beside(reading, least, share),
        unfollowed=share,
        spread=spread,
    )


def unfollowed(
    spectrum: LineSpectrum, reading: Reading, beside: Sequence[float], strong: Sequence[Strong]
) -> tuple[float, float]:
    """Power beside a line that its reading lacks and that may be its own, over its own; and by how
    much its turns over time may differ from its place.

    A phase or an amplitude that oscillates makes lines at equal distances to both sides, which
    count up to three times the distance of the first sidebands of known shafts (``beside``).
    """
    nearest = min((abs(one - reading.frequency) for one in beside), default=0.0)
    share, turned = _pairs(spectrum, reading, beside, strong, _AS_FAR * nearest)
    # a phase that oscillates by sqrt(2 turned) [rad] may be at any place at both ends
    return share, float(np.sqrt(2.0 * turned)) / np.pi * spectrum.bin_width


def _pairs(
    spectrum: LineSpectrum,
    reading: Reading,
    beside: Sequence[float],
    strong: Sequence[Strong],
    reach: float,
) -> tuple[float, float]:
    """Power of lines at equal distances to both sides of one, up to ``reach``, that are no known
    sidebands, over its own; and what of it turns the line's phase (Q)."""
    width, own = spectrum.bin_width, reading.amplitude**2
    free = [
        one
        for one in strong
        if APART * width < abs(one.place * width - reading.frequency) < reach
        and not _is_side(one, beside, width)
    ]
    line = min(strong, key=lambda one: abs(one.place * width - reading.frequency), default=None)
    if line is None or own <= 0.0:
        return 0.0, 0.0
    phase = np.conj(line.amplitude) / abs(line.amplitude)
    power = turned = 0.0
    for above, below in twins(free, reading.frequency / width):
        one, two = above.amplitude * phase, np.conj(below.amplitude * phase)
        power += abs(one) ** 2 + abs(two) ** 2
        # the line's own phase is known to some hundredths: so much of I would pass for Q
        turned += abs(one - two) ** 2 / 2.0 if abs(one - two) > 0.1 * abs(one + two) else 0.0
    return max(power, reading.pairs) / own, float(turned) / own


def _or_steady(
    turns: MeshTurns,
    spectrum: LineSpectrum,
    reading: Reading,
    beside: Sequence[float],
    strong: Sequence[Strong],
) -> MeshTurns:
    """A line followed, in doubt where steady lines explain the same.

    A small oscillation of the speed is a pair of lines at equal distances to both sides, and so are
    the sidebands of a shaft that is not known. Where such pairs hold nearly all the power that the
    line itself does not, the line may be what is read between them.
    """
    own = reading.amplitude**2
    if max(reading.turning, reading.changing) > _STILL or own <= 0.0:
        return turns
    widths = filter_widths(spectrum, reading.frequency)
    share, _ = _pairs(spectrum, reading, beside, strong, max(widths))
    most = max(_missing(spectrum, reading, beside, one) for one in widths)
    if share < _MISSED or most > _EXPLAINED * share * own:
        return turns
    off = abs(turns.frequency - reading.frequency)
    return replace(
        turns,
        doubt=max(turns.doubt, share / (1.0 + share)),
        half_width=turns.half_width + off,
        told=_with_unknown(turns),
    )


def _with_unknown(turns: MeshTurns) -> tuple[Notice, ...]:
    """What is told, and once that lines beside may be sidebands of a shaft that is not known."""
    return tuple(dict.fromkeys((*turns.told, Notice.of("sidebands_or_swing"))))


def _beside(reading: Reading, least: float | None, share: float) -> tuple[Notice, ...]:
    """What is told of power near a line that is read as a steady one."""
    own = reading.amplitude**2
    near = 0.0 if not least or own <= 0.0 else (least / own - 1.0) / _BROUGHT
    share = max(share, near)
    return (Notice.of("power_beside_mesh_line", share=share),) if share >= _TOLD else ()


def _reach(spectrum: LineSpectrum, gearing: Gearing) -> float:
    return max(3.0 * spectrum.bin_width, 2e-4 * gearing.mesh_frequency)


def clearest(table: Floats, mesh: float) -> tuple[Floats, LineSpectrum]:
    """The channel in which the mesh line is highest over all else, and its spectrum."""
    spectra = [line_spectrum(values, 1.0) for values in table]
    place = int(np.rint(mesh * table.shape[-1]))
    heights = [
        float(np.max(one.hann[max(1, place - 2) : place + 3], initial=0.0))
        / max(float(np.std(values)), 1e-300)
        for one, values in zip(spectra, table, strict=True)
    ]
    best = int(np.argmax(heights))
    return table[best], spectra[best]


def _wandering(
    spectrum: LineSpectrum,
    reading: Reading,
    beside: Sequence[float],
    strong: Sequence[Strong],
    harmonics: int,
) -> float | None:
    """The power that a followed line must hold to be believed; None: the line is steady.

    It wanders where its phase turns, or most of the power near it is no steady line's. Where steady
    neighbours explain that power, they may be its own: a line that wanders has a comb about it.
    Then the line followed must have three quarters of their power besides, and of what its own
    change and turning hold; of a neighbour it gets half, of two that swell and fade together
    nothing.

    The power is that within a filter that may hold a wandering line, less that of the sidebands at
    ``beside`` and four standard deviations of the noise there.
    """
    # noise that peaks beside the line changes amplitude and phase alike
    turns = reading.turning > min(1.5 * reading.changing, 0.5)
    if turns and reading.turning * harmonics > 2.0 * np.pi * _STEADY:
        return 0.0
    frequency, width = reading.frequency, spectrum.bin_width
    widths = filter_widths(spectrum, frequency)
    if not widths:
        return None
    own = reading.amplitude**2
    missing = _missing(spectrum, reading, beside, widths[0])
    sides = {one > frequency for one in reading.neighbours}
    still = max(reading.turning, reading.changing) < _STILL and reading.explained
    most = max(_missing(spectrum, reading, beside, one) for one in widths)
    if len(sides) == 1 and still and own + reading.beside > _KEPT * (own + most):
        return None  # lines to one side: amplitude and phase would oscillate alike
    others = [0.0]
    for one in [o.place * width for o in strong if not _is_side(o, beside, width)]:
        if 3.0 * width < abs(one - frequency) < widths[0]:
            other = read_line(spectrum, one, strong=strong)
            if max(other.turning, other.changing) < _STILL:
                others.append(other.amplitude**2)
    if own + reading.beside < _KEPT * (own + missing) - sum(others):
        return 0.0
    if most < _MISSED * own:
        return None
    steady = own / (1.0 + reading.changing**2 + reading.turning**2)
    return (1.0 - _BROUGHT) * max(steady, *others) + _BROUGHT * (own + most)


def _missing(
    spectrum: LineSpectrum, reading: Reading, beside: Sequence[float], half_width: float
) -> float:
    """Power within ``half_width`` of the line that neither it nor its sidebands have."""
    width, frequency = spectrum.bin_width, reading.frequency
    near = [one for one in beside if 3.0 * width < abs(one - frequency) < half_width]
    power = band_power(spectrum, frequency, half_width) - reading.amplitude**2
    power -= sum(band_power(spectrum, one, 2.0 * width) for one in near)
    noise = reading.noise**2
    if reading.hidden:  # what wanders far is noise to its own highest line
        noise = min(noise, power_beyond(spectrum, frequency, half_width))
    return power - 4.0 * noise * float(np.sqrt(4.0 * half_width / width))


def _is_side(one: Strong, beside: Sequence[float], width: float) -> bool:
    return any(abs(one.place * width - side) < 2.0 * width for side in beside)


def _follow(
    values: Floats,
    spectrum: LineSpectrum,
    frequency: float,
    *,
    least: float,
    beside: Sequence[float],
) -> MeshTurns | None:
    """The line followed by the narrowest filter that leaves hardly more of noise and of turning in
    its phase than any; None: then its power is less than ``least``, or it cannot be followed."""
    orders = [one / frequency for one in beside]
    tried: list[tuple[float, Followed, MeshTurns]] = []
    every = max(1, int(_THIN / frequency))
    thin = thinned(values, every)
    for half_width in filter_widths(spectrum, frequency, every=True):
        if spectrum.samples * half_width < 4.0 * spectrum.rate:
            continue
        one = follow_line(
            thin,
            1.0,
            frequency=every * frequency,
            half_width=every * half_width,
            beside=[every * place for place in beside],
            cut=False,
        )
        turns = _followed(one, thin, orders, trial=True)
        if turns is not None:
            tried.append((half_width, one, turns))
    held = [one for one in tried if one[1].whole] or tried
    if not held:
        return None
    bound = _ALIKE * min(turns.phase_noise for *_, turns in held)
    half_width, _, turns = next(one for one in held if one[2].phase_noise <= bound)
    if turns.power < least:
        return None
    whole = follow_line(
        values,
        spectrum.rate,
        frequency=frequency,
        half_width=half_width,
        beside=beside,
    )
    found = _followed(whole, values, orders)
    return found and _with_pairs(found, whole, values, middle=frequency, beside=beside)


def _with_pairs(
    turns: MeshTurns, found: Followed, values: Floats, *, middle: float, beside: Sequence[float]
) -> MeshTurns:
    """A line followed, once more with pairs of lines that turn with it taken away.

    In its angle lines within the filter at equal distances to both sides may be sidebands of a
    shaft that is not known. Its phase has taken what of them would turn it (Q), and left what
    would change its amplitude (I): then it is followed without them. Of an oscillation of the speed
    it would have left Q: where there is Q, the intervals hold both.
    """
    frequency = found.frequency
    straight = _straight(values, found)
    width, strong = straight.bin_width, strong_lines(straight)
    line = min(strong, key=lambda one: abs(one.place * width - frequency), default=None)
    sides = [one * found.frequency / middle for one in beside]
    free = [
        one
        for one in strong
        if _CLEAR * width < abs(one.place * width - frequency) < found.last
        and not _is_side(one, sides, width)
    ]
    both_sides = twins(free, frequency / width) if line else []
    if line is None or not both_sides:
        return turns
    pairs = [one for pair in both_sides for one in pair]
    known = [*sides, *(one.place * width for one in pairs)]
    again = follow_line(values, 1.0, frequency=frequency, half_width=found.half_width, beside=known)
    other = _followed(again, values, [one / frequency for one in known])
    if other is None:
        return turns
    shares = [
        (above.amplitude / line.amplitude, np.conj(below.amplitude / line.amplitude))
        for above, below in both_sides
    ]
    if all(abs(one + two) ** 2 > _CLEARLY * abs(one - two) ** 2 for one, two in shares):
        return other
    return replace(
        turns,
        doubt=max(0.0, 1.0 - other.power / max(turns.power, 1e-300)),
        half_width=turns.half_width + abs(other.frequency - turns.frequency),
        told=_with_unknown(turns),
    )


def _straight(values: Floats, found: Followed) -> LineSpectrum:
    """The spectrum about a line followed, its phase beyond that of an even turning taken away.

    Lines near it that turn with it keep of that phase what their distance is of its frequency.
    Farther than half of that off nothing is left.
    """
    even = found.frequency * np.arange(values.size)
    turned = (values - values.mean()) * np.exp(-2j * np.pi * (found.cycles - even))
    lines = fft.fft(turned)[: values.size // 2 + 1] * (2.0 / values.size)
    place = np.arange(lines.size) / values.size
    lines[np.abs(place - found.frequency) > 0.5 * found.frequency] = 0.0
    return LineSpectrum(1.0, values.size, lines)


def _followed(
    found: Followed,
    values: Floats,
    beside: Sequence[float],
    *,
    trial: bool = False,
) -> MeshTurns | None:
    """The turns of a line followed; ``beside``: its shafts' sidebands, over its frequency. What
    following misses is not looked for in a ``trial``."""
    cycles = found.cycles
    if np.any(np.diff(cycles) <= 0.0):
        return None
    wander = float(np.std(cycles - np.linspace(cycles[0], cycles[-1], cycles.size)))
    straight, sides = _straight(values, found), [one * found.frequency for one in beside]
    strong = () if trial else strong_lines(straight)
    reading = read_line(
        straight, found.frequency, beside=sides, strong=strong, followed=_HELD * found.last
    )
    share, spread = (0.0, 0.0) if trial else unfollowed(straight, reading, sides, strong)
    bins = 1.2 * found.last * values.size  # in the filter, its noise bandwidth
    # what the filter misses is seen beyond it; farther off it is taken to be as much again
    noise = reading.noise / max(reading.amplitude, 1e-300) * float(np.sqrt(0.5 * bins))
    hann = np.hanning(values.size)
    line = 2.0 * abs(np.sum(hann * values * np.exp(-2j * np.pi * cycles))) / np.sum(hann)
    return MeshTurns(
        frequency=found.frequency,
        half_width=float(np.hypot(found.frequency_half_width, spread)),
        unfollowed=share,
        turning=Turning(cycles=cycles, dropped=0, per_cycle=samples_per_cycle(found.frequency)),
        told=(Notice.of("phase_wanders", cycles=wander),),
        phase_noise=float(np.hypot(noise, reading.turning)),
        followed=_HELD * found.last,
        power=float(line**2) * max(0.0, 1.0 - 2.0 * noise**2),
    )
