"""Which lines of a channel are looked for, and what is read there with its uncertainty."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import KW_ONLY, dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from thermogear.base.arrays import Floats
from thermogear.base.units import STANDARD_GRAVITY
from thermogear.measured.chain import Chain, reduced
from thermogear.measured.gate import turned_by
from thermogear.measured.gearing import Gearing, shaft_order, sides_of
from thermogear.measured.record import Channel, Record
from thermogear.measured.turns import MeshTurns, unfollowed
from thermogear.measured.units import kind_of
from thermogear.signals.interval import APART, REACH, Reading, read_line
from thermogear.signals.lines import LineSpectrum, line_spectrum
from thermogear.signals.strong import Strong, strong_lines

_NORMAL = 1.959964  # standard deviations of a normal law that hold 95 %
_OTHERS = 3  # prominent lines that no gear explains, of a channel
_PROMINENT = 0.1  # of the channel's strongest line
_FAR = 10  # sidebands of a mesh harmonic
_TOLD_APART = 1.2  # bins between two lines that a fit tells apart
_CLEARLY_OFF = 2.0  # half widths
_NEAR = 4.0  # bins within which a stronger line reaches into an asked one


@dataclass(frozen=True, kw_only=True)
class MeasuredLine:
    """One line of one channel. What the record does not allow is nan, never guessed.

    ``kind``: "mesh" (harmonic of the mesh line), "sideband", "shaft" (multiple of a known shaft's
    turns), "order" (asked for) or "line" (of which no more is known). ``order`` of the first shaft,
    ``position`` [cycles/sample], ``frequency`` [Hz]; ``reading`` peak amplitude in the file's unit,
    ``acceleration`` [m/s^2], ``displacement`` [m].

    What is measured: the amplitude over the stretch, root of the mean square of the line's own
    a(t) in Re[a(t) exp(i phase)], and the mean frequency, the line's turns over their time.
    ``uncertainty``: relative standard uncertainty u_D of the amplitude from
    noise, lines beside, what damage of the record may do (Student's t counted in) and the
    sensor; ``half_width`` = 1.96 u_D, the 95 % interval's; ``frequency_half_width`` [Hz],
    ``position_half_width`` [cycles/sample] and ``speed_half_width`` [rad/s] likewise. A rate from
    rounded time stamps adds its own half width to those in time (1/s), twice its share to
    amplitudes (displacement goes with 1/f^2), jitter of the samples what it may take from a line.
    ``bin_offset`` [bins]; ``prominence`` over the floor beside; ``withheld``: why numbers are.
    """

    channel: str
    kind: str
    name: str
    order: float
    position: float
    frequency: float
    reading: float
    acceleration: float
    displacement: float
    uncertainty: float
    bin_offset: float
    prominence: float
    shaft_speed: float
    half_width: float = float("nan")
    position_half_width: float = float("nan")
    frequency_half_width: float = float("nan")
    speed_half_width: float = float("nan")
    withheld: str = ""

    @property
    def is_reading(self) -> bool:
        """Whether the line was asked for, or is over the floor with an interval no wider than
        itself."""
        return self.kind == "order" or not (self.half_width > 1.0 or self.prominence < 1.0)

    @property
    def acceleration_g(self) -> float:
        """The acceleration in standard gravities."""
        return self.acceleration / STANDARD_GRAVITY


@dataclass(frozen=True, kw_only=True)
class Doubts:
    """What damage does to a channel's lines: ``extra`` relative half width of amplitudes, of which
    ``clipped`` counts in the channel's strongest line, why amplitudes are ``withheld``, why the
    ``rate`` is doubtful; whether the shaft's ``speed`` is."""

    extra: float = 0.0
    clipped: float = 0.0
    withheld: str = ""
    rate: str = ""
    speed: bool = False

    def shared(self, lines: Sequence[tuple[float, float]], amplitude: float) -> float:
        """Relative half width of a line of this ``amplitude`` beside ``lines`` (place, size)."""
        highest = max((size for _, size in lines), default=amplitude)
        more = max(highest / max(amplitude, 1e-300) - 1.0, 0.0)
        return self.extra + self.clipped * more if self.clipped else self.extra

    def applied(self, line: MeasuredLine) -> MeasuredLine:
        """The line without what is withheld."""
        nan = float("nan")
        if self.withheld:
            line = replace(
                line,
                reading=nan,
                acceleration=nan,
                displacement=nan,
                uncertainty=nan,
                half_width=nan,
            )
        if self.rate:
            line = replace(line, frequency=nan, frequency_half_width=nan, displacement=nan)
        if self.rate or self.speed:
            line = replace(line, shaft_speed=nan, speed_half_width=nan)
        return replace(line, withheld="; ".join(t for t in (self.withheld, self.rate) if t))


@dataclass(frozen=True)
class Wanted:
    """A line to look for, at ``position`` +- ``half_width`` [cycles/sample]; ``rank`` of a harmonic
    of the mesh line or of the clearest one, else 0."""

    kind: str
    name: str
    _: KW_ONLY
    position: float
    half_width: float
    rank: int = 0


def wanted_lines(
    gearing: Gearing | None,
    values: Floats,
    *,
    harmonics: int,
    sidebands: int,
    teeth: int | None = None,
) -> list[Wanted]:
    """Harmonics of the mesh line with the sidebands of ``teeth`` where these are given, below
    rate/2.56.

    Without a gearing the highest lines of ``values`` (sample,).
    """
    count = values.size
    bins = 3.0 / count
    if gearing is None:
        strong = strong_lines(line_spectrum(values, 1.0), harmonics)
        return [
            Wanted("line", f"line {k}", position=one.place / count, half_width=bins)
            for k, one in enumerate(strong, 1)
        ]
    mesh = gearing.mesh_frequency
    found: list[Wanted] = []
    for rank in range(1, harmonics + 1):
        if 2.56 * rank * mesh > 1.0:  # not above rate/2.56
            break
        # speed wander spreads a harmonic in proportion to its rank
        reach = max(bins, 2e-4 * rank * mesh)
        kind, name = gearing.kind(rank)
        found.append(Wanted(kind, name, position=rank * mesh, half_width=reach, rank=rank))
        for n in range(1, sidebands + 1 if teeth else 1):
            for sign in (-1, 1):
                place = rank * mesh + sign * n * mesh / (teeth or 1)
                label = f"{name} {'+' if sign > 0 else '-'} {n} shaft/{teeth}"
                found.append(Wanted("sideband", label, position=place, half_width=reach))
    if not found:
        kind, name = gearing.kind(1)
        reach = max(bins, 2e-4 * mesh)
        found.append(Wanted(kind, name, position=mesh, half_width=reach, rank=1))
    return [w for w in found if bins < w.position < 0.5 - bins]


def other_lines(
    strong: list[tuple[float, float]],
    gearing: Gearing,
    teeth: int | None,
    wanted: list[Wanted],
    *,
    width: float,
) -> list[Wanted]:
    """Prominent lines that neither stand among the ``wanted`` nor belong to a mesh: three at most.

    ``strong``: (position, amplitude) of a channel's strongest lines, ``width`` of a bin
    [cycles/sample]. To a mesh belong its harmonics and the sidebands of the ``teeth`` given
    up to the tenth. Such a line is an unbalance, a shaft beside, a bearing, a resonance: it says
    nothing of sidebands.
    """
    mesh = gearing.mesh_frequency
    shaft = gearing.shaft
    least = _PROMINENT * max((size for _, size in strong), default=0.0)

    def explained(place: float) -> bool:
        reach = max(3.0 * width, 2e-4 * place)
        if any(
            abs(place - want.position) < (width if want.kind == "order" else reach)
            for want in wanted
        ):
            return True
        if place <= 0.5 * mesh or gearing.teeth is None:
            return False
        away = abs(place - round(place / mesh) * mesh)
        if away < reach or not teeth:
            return away < reach
        rank = round(away * teeth / mesh)
        return rank <= _FAR and abs(away - rank * mesh / teeth) < reach

    found: list[Wanted] = []
    for place, size in sorted(strong, key=lambda one: -one[1]):
        if size < least or len(found) == _OTHERS:
            break
        if not explained(place) and 3.0 * width < place < 0.5 - 3.0 * width:
            order = shaft_order(place, shaft=shaft, width=width)
            name = f"line at {place / mesh:.4g} {'mesh' if gearing.teeth else 'times line x 1'}"
            name = name if shaft is None else f"order {place / shaft:.4g}"
            kind, name = ("shaft", f"shaft x {order}") if order else ("line", name)
            found.append(Wanted(kind, name, position=place, half_width=width))
    return found


def channel_lines(
    record: Record,
    channel: Channel,
    values: Floats,
    gearing: Gearing | None,
    teeth: int | None,
    chain: Chain,
    wanted: list[Wanted],
    sensor_tolerance: float | None,
    turns: MeshTurns | None,
    doubts: Doubts,
) -> list[MeasuredLine]:
    """The ``wanted`` lines of one channel, ``values`` (sample,) in the file's unit."""
    rate = record.rate or 1.0
    known = channel.unit is not None and not channel.needs_scale
    factor = channel.si_factor if known else 1.0
    accelerates = known and channel.unit is not None and kind_of(channel.unit) == "acceleration"
    moves = known and channel.unit is not None and kind_of(channel.unit) == "displacement"
    through = reduced(values * factor, rate, turns.turning if turns else None)
    strong = strong_lines(through.spectrum)
    bin_width = through.spectrum.bin_width * through.axis / rate
    peaks = [(one.place * bin_width, abs(one.amplitude)) for one in strong]
    if gearing is not None:
        others = other_lines(peaks, gearing, teeth, wanted, width=bin_width)
        wanted = [*wanted, *others]
    places = [want.position for want in wanted]
    found = []
    missed: dict[int, float] = {}  # of a mesh harmonic, beside it, of its power
    in_hertz = record.rate is not None
    shaft = (gearing.shaft if gearing else None) or float("nan")
    speed = 2 * np.pi * rate * shaft if in_hertz else float("nan")
    share = _speed_share(gearing, turns)
    for want in wanted:
        reach = want.half_width * rate
        line = through.read(want.position * rate, half_width=reach, window=chain.window)
        sides = _sides(gearing, teeth, want)
        beside = [p * rate / through.axis for p in [*places, *sides]]
        expected = want.position * rate / through.axis
        followed = turns.followed * rate / through.axis if turns else 0.0
        if want.kind in ("order", "sideband"):
            reading = _read_known(through.spectrum, expected, beside, strong, followed)
        else:
            near = line.frequency
            # as many bins that tell of the noise as where nothing was followed
            taken = min(int(followed / through.spectrum.bin_width), REACH)
            reading = read_line(
                through.spectrum,
                near,
                beside=beside,
                strong=strong,
                followed=followed,
                reach=REACH + taken,
            )
        position = reading.frequency * through.axis / rate
        rank = int(np.rint(position / gearing.mesh_frequency)) if gearing else 0
        if turns is not None and turns.unfollowed and want.rank:
            # among sidebands alone: other lines that are read may be its own
            own_sides = [p * rate / through.axis for p in sides]
            single = read_line(
                through.spectrum,
                line.frequency,
                beside=own_sides,
                strong=strong,
                followed=followed,
            )
            lacks, _ = unfollowed(through.spectrum, single, own_sides, strong)
            own_power = max(reading.amplitude, 1e-300) ** 2
            missed[rank] = single.amplitude**2 * (1.0 + lacks) / own_power - 1.0
        amplitude, relative = _amplitude(reading, position, turns)
        doubt = turns.doubt if turns else 0.0
        # with the power in doubt, or without; an angle that is another's smears all others
        itself = want.rank == 1
        alone = float(np.sqrt(1.0 - doubt)) if itself else 1.0
        relative += rank**2 * doubt if turns and turns.turning and not itself else 0.0
        # with what may be its own beside it, or without; a sideband shares its mesh line's
        gain = float(np.sqrt(1.0 + missed.get(rank, 0.0)))
        low, high = min(1.0, gain), max(1.0, gain)
        comes = 0.0 if want.rank else reading.changing**2 + reading.turning**2
        if comes > 1.0:  # more of it comes and goes than stays: it may be no line
            relative = max(relative, 1.0)
        else:  # a short event beside it, or its own
            low = min(low, 1.0 / float(np.sqrt(1.0 + comes)))
        if turns is not None and turns.turning is None:
            high = max(high, 1.0 / alone)
        else:
            low = min(low, alone)
        off = 0.0
        if want.kind == "sideband":
            place_error = turns.half_width / turns.frequency * expected if turns else 0.0
            other = _shared(reading, expected, place_error, through.spectrum.bin_width)
            relative += other
            off = abs(position - want.position) if other else 0.0  # its own place is known
        amplitude *= 0.5 * (low + high)
        relative += (high - low) / (high + low)
        displacement = amplitude if moves else float("nan")
        if accelerates and in_hertz:
            displacement = chain.displacement(amplitude, frequency=position * rate, rate=rate)
        own = reading.frequency_half_width * through.axis / rate + off
        if turns is not None:
            more = turns.spread if turns.turning is None else turns.half_width
            own = float(np.hypot(own, more / turns.frequency * position))
        if reading.hidden:  # a peak of noise: the line may be anywhere it was looked for
            own = max(own, want.half_width + abs(position - want.position))
        # damage is no random error: its share is added, not its square
        damage = doubts.shared(peaks, amplitude)
        own += turned_by(damage, samples=values.size)
        half_width = float(np.hypot(relative, _NORMAL * (sensor_tolerance or 0.0))) + damage
        half_width += 2.0 * record.rate_share + float(jittered(position, record.jitter))
        found.append(
            doubts.applied(
                MeasuredLine(
                    channel=channel.name,
                    kind=want.kind,
                    name=want.name,
                    order=position / shaft,
                    position=position,
                    frequency=position * rate if in_hertz else float("nan"),
                    reading=amplitude / factor,
                    acceleration=amplitude if accelerates else float("nan"),
                    displacement=displacement,
                    uncertainty=half_width / _NORMAL,
                    bin_offset=line.bin_offset,
                    prominence=line.prominence,
                    shaft_speed=speed,
                    half_width=half_width,
                    position_half_width=own,
                    frequency_half_width=own * rate + position * record.rate_half_width
                    if in_hertz
                    else float("nan"),
                    speed_half_width=(share + record.rate_share) * speed,
                )
            )
        )
    return found


def _speed_share(gearing: Gearing | None, turns: MeshTurns | None) -> float:
    """Relative half width of the shaft's speed: the mesh line's, and that of its own line."""
    if gearing is None or turns is None:
        return float("nan")
    own = gearing.turning_half_width / (gearing.turning or 1.0)
    return turns.half_width / turns.frequency + (own if gearing.teeth is None else 0.0)


def jittered(position: ArrayLike, jitter: float) -> Floats:
    """Share that samples off an even clock by ``jitter`` [rms, steps] take from a line at
    ``position`` [cycles/sample]: (2 pi position jitter)^2/2.

    >>> f"{jittered(0.1, 0.1):.5f}"
    '0.00197'
    """
    return np.asarray(0.5 * (2.0 * np.pi * jitter * np.asarray(position, dtype=float)) ** 2)


def _read_known(
    spectrum: LineSpectrum,
    expected: float,
    beside: Sequence[float],
    strong: Sequence[Strong],
    followed: float,
) -> Reading:
    """The line known to be at ``expected`` (unit of the rate).

    A line that is near and stronger draws the fit to itself: it is read from the expected place,
    and from the strong line there with the others near it as known ones. Which ends nearest to the
    expected place is the line.
    """
    width = spectrum.bin_width
    reading = read_line(spectrum, expected, beside=beside, strong=strong, followed=followed)
    away = np.array([one.place * width - expected for one in strong])
    near = away[np.abs(away) < _NEAR * width]
    if near.size == 0:
        return reading
    told = np.abs(near) >= _TOLD_APART * width
    start = expected + (0.0 if told.all() else min(near[~told], key=abs))
    others = [*beside, *(expected + near[told])]
    other = read_line(spectrum, start, beside=others, strong=strong, followed=followed)
    return min(reading, other, key=lambda one: abs(one.frequency - expected))


def _shared(reading: Reading, known: float, place_error: float, bin_width: float) -> float:
    """Share of a line that may be another's, with which it is read as one.

    A line clearly off the place where it is ``known`` to be holds another: the share of it times
    its distance makes the line's own way off. The distance is taken as half of that from which two
    are told apart.
    """
    if reading.hidden:
        return 0.0
    room = _CLEARLY_OFF * (reading.frequency_half_width + place_error)
    way = max(abs(reading.frequency - known) - room, 0.0) / bin_width
    return way / (0.5 * APART)


def _amplitude(reading: Reading, position: float, turns: MeshTurns | None) -> tuple[float, float]:
    """Amplitude of a line and the relative half width of its 95 % interval.

    Noise in the angle that a record was straightened by smears the line at rank k of the mesh by
    up to (k phase noise)^2/2.
    """
    relative = reading.half_width / max(reading.amplitude, 1e-300)
    if turns is not None and turns.turning is not None:
        relative += 0.5 * (position / turns.frequency * turns.phase_noise) ** 2
    return reading.amplitude, relative


def _sides(gearing: Gearing | None, teeth: int | None, want: Wanted) -> tuple[float, ...]:
    """Where the sidebands of the nearest mesh harmonic stand [cycles/sample]."""
    if gearing is None:
        return ()
    rank = max(1, int(np.rint(want.position / gearing.mesh_frequency)))
    return sides_of(teeth=teeth, rank=rank, mesh=gearing.mesh_frequency)
