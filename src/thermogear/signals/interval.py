"""A line's amplitude and frequency over a stretch of record, with intervals that hold 95 %.

The flat top and the Hann window see the middle of a record and little of its ends. Here a line is
fitted by least squares over the whole stretch, and what is left beside it tells apart noise,
a changing amplitude and a changing phase:

    x(t) = Re[(a(t) exp(i theta(t))) exp(2 pi i f t)] + other lines + noise.

Left over at m bins beside the line, R_m and R_-m, turned by the line's own phase, make

    I_m = (R_m + conj R_-m)/sqrt 2,    Q_m = (R_m - conj R_-m)/sqrt 2;

a changing amplitude fills I, a changing phase Q, noise both alike. So the quieter is the noise.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy import special

from thermogear.base.arrays import Complexes, Floats
from thermogear.signals.lines import LineSpectrum
from thermogear.signals.strong import Strong, dirichlet, shown, twins

NEAR = 6
"""Bins on each side in which a neighbour is looked for."""

_CLEARLY = 2.5
_INNER = 6
"""Bins nearest to a line, in which a change stands out first."""
_ROUNDS = 8
_NOISE = 25.0


@dataclass(frozen=True, kw_only=True)
class Left:
    """What the fit leaves beside the line, m = 1.. bins off: powers of I and Q, of each side."""

    even: Floats
    odd: Floats
    shares: tuple[Floats, Floats]  # of noise of power 1 in a bin, what the fit leaves in I and Q
    noise: float  # power in one bin, typical of those beside
    here: float  # power in one bin at the line
    degrees: float  # of freedom behind ``here``
    crowded: bool  # by a much higher line, whose skirts fill I and Q alike
    others: float  # power of I and Q next to known lines, taken for what others have there
    places: Floats  # of the finer grid on which a neighbour is looked for [bins from the line]
    finer: Floats  # power there

    @property
    def near(self) -> float:
        """Power beyond noise within the bins in which a neighbour is looked for."""
        reach = min(NEAR, self.even.size)
        total = np.sum(self.even[:reach]) + np.sum(self.odd[:reach])
        own = sum(float(np.sum(share[:reach])) for share in self.shares)
        return float(max(total - own * self.noise, 0.0))

    @property
    def shared(self) -> float:
        """Power near the line that I and Q have in the same bins, as a further line's would be."""
        quiet = np.minimum(self.even, self.odd)[:NEAR] - 4.0 * self.noise
        return float(2.0 * np.sum(np.maximum(quiet, 0.0)))

    @property
    def change(self) -> float:
        """Power of I beyond noise, of either sign; of a crowded line beyond that of Q as well."""
        even, odd = self._beyond()
        return even - max(odd, 0.0) if self.crowded else even

    @property
    def changed(self) -> float:
        """Power of I beyond noise, 0 where it is within four of its standard deviations."""
        return self._clearly(self.change, self.even.size)

    @property
    def turned(self) -> float:
        """Power of Q beyond noise, 0 where it is within four of its standard deviations."""
        even, odd = self._beyond()
        return self._clearly(odd - max(even, 0.0) if self.crowded else odd, self.odd.size)

    def _beyond(self) -> tuple[float, float]:
        return (
            float(np.sum(self.even) - np.sum(self.shares[0]) * self.noise),
            float(np.sum(self.odd) - np.sum(self.shares[1]) * self.noise),
        )

    def _clearly(self, extra: float, size: int) -> float:
        return extra if extra > 4.0 * self.noise * np.sqrt(size) else 0.0


def without_others(powers: Floats, known: NDArray[np.bool_], noise: float) -> tuple[Floats, float]:
    """``powers`` of I or Q without what rises next to ``known`` lines, and how much that is.

    A change has as much there as in the bins about; another line next to a known one shows there
    alone. It counts where in all it is above 25 times the ``noise`` of a bin, hardly by chance.

    >>> powers, known = np.ones(9), np.zeros(9, dtype=bool)
    >>> powers[3:6], known[3:6] = (5.0, 60.0, 5.0), True
    >>> level, others = without_others(powers, known, 1.0)
    >>> level.tolist() == [1.0] * 9, others
    (True, 67.0)
    """
    if known.all() or not known.any():
        return powers, 0.0
    place = np.arange(powers.size)
    about = np.interp(place, place[~known], powers[~known])
    level = np.where(known, np.minimum(powers, np.maximum(about, noise)), powers)
    others = float(np.sum(powers - level))
    return (level, others) if others > _NOISE * noise else (powers, 0.0)


def noise_beside(
    powers: tuple[Floats, Floats], *, shares: tuple[Floats, Floats], followed: float
) -> tuple[float, float, float]:
    """Power of noise in one bin beside a line, in one at the line, and the latter's degrees of
    freedom, from ``powers`` of I and Q.

    Each is divided by the share of noise that the fit leaves there; where that is less than half
    it is left aside. Medians over bins, so that single lines count little: ln 2 of the
    mean where it is noise. Q of bins nearer than ``followed`` has been taken away with the phase.
    Both together, unless one is 2.5 times the other: then the quieter, because a change fills one
    alone; likewise the outer half of its bins, because a change fills the inner ones first. What
    shows in the inner bins alone are skirts: the record's ends cut a change, which leaves power
    that falls with the square of the distance. They are fitted and taken away.

    Noise of a resonance is not level. I and Q hold both sides alike, so a slope cancels and
    a + c m^2 is left: of the inner and the outer half of the bins, mean m^2 (r/2)^2/3 and 7 times
    that, the median powers p and q give a = (7 p - q)/6.

    >>> quiet, whole = np.full(40, np.log(2.0)), np.ones(40)
    >>> level, at_line, degrees = noise_beside((quiet, quiet), shares=(whole, whole), followed=0.0)
    >>> round(level, 9), round(at_line, 9), round(degrees)
    (1.0, 1.0, 27)
    """
    first = 1 if powers[0].size > 3 else 0  # a slow change is in the first
    starts = first, max(first, int(np.ceil(followed)))
    (one, steps), (two, others) = (
        _whole(power, share, start)
        for power, share, start in zip(powers, shares, starts, strict=True)
    )
    if two.size < 4:
        return _level(_outer(one))
    count = one.size + two.size
    one, two = _without_skirts(one, steps, two), _without_skirts(two, others, one)
    if max(_median(one), _median(two)) > _CLEARLY * min(_median(one), _median(two)):
        return _level(min(_outer(one), _outer(two)))
    joined = np.concatenate([one, two])
    fitted = count - joined.size
    far = np.concatenate([one[one.size // 2 :], two[two.size // 2 :]])
    if far.size >= 16 and _median(joined) > 2.0 * _median(far):
        return _level((_median(far), float(far.size)))
    if far.size < 16:
        return _level((_median(joined), float(joined.size)))
    near = np.concatenate([one[: one.size // 2], two[: two.size // 2]])
    here = (7.0 * _median(near) - _median(far)) / 6.0
    # skirts fitted to some bins scatter as if twice as many were lost (seen in drawn noise)
    degrees = 36.0 / (49.0 / max(near.size - 2 * fitted, 1) + 1.0 / far.size)
    return _median(joined), max(here, 0.5 * _median(joined)), degrees


def _level(found: tuple[float, float]) -> tuple[float, float, float]:
    noise, degrees = found
    return noise, noise, degrees


def _whole(powers: Floats, shares: Floats, start: int) -> tuple[Floats, Floats]:
    """Powers of noise that the fit leaves whole, from bin ``start`` on, and their distances."""
    kept = shares[start:] >= 0.5
    if np.count_nonzero(kept) < min(4, kept.size):
        kept[:] = True
    distances = np.arange(1.0, powers.size + 1.0)[start:][kept]
    return powers[start:][kept] / np.maximum(shares[start:][kept], 0.1), distances


def _without_skirts(powers: Floats, distances: Floats, other: Floats) -> Floats:
    """``powers`` of I or Q, noise n alone, where a change has skirts a/m^2 in the inner bins.

    That is where the inner bins have 2.5 times the power of the ``other``'s. In turn a, by which
    the inner ones would be p/(1/m^2 + n/a), and n, by the outer half p/(1 + a/(n m^2)) and
    the other; the inner ones, which tell of the skirts, are left out.
    """
    if min(powers.size, other.size) < 2 * _INNER:
        return powers
    inner = powers[:_INNER]
    if _median(inner) <= _CLEARLY * _median(other[:_INNER]):
        return powers
    square = distances**2
    noise = _median(np.concatenate([other, powers[powers.size // 2 :]]))
    skirts = _median(inner * square[:_INNER])
    for _ in range(_ROUNDS):
        skirts = _median(inner / (1.0 / square[:_INNER] + noise / skirts))
        level = powers / (1.0 + skirts / (noise * square))
        noise = _median(np.concatenate([other, level]))
    return level[_INNER:]


def _outer(powers: Floats) -> tuple[float, float]:
    """Noise from all bins or, where it is clearly less, from the outer half; degrees of freedom."""
    outer = powers[powers.size // 2 :]
    if outer.size >= 8 and _median(powers) > _CLEARLY * _median(outer):
        return _median(outer), float(outer.size)
    return _median(powers), float(powers.size)


def _median(powers: Floats) -> float:
    return float(max(np.median(powers) / np.log(2.0), 1e-300)) if powers.size else 1e-300


REACH = 40
"""Bins on each side of a line from which its noise is judged."""

APART = 0.75
"""Bins: two lines nearer than this are one that changes."""
SIDE = 2.0
"""Bins: a strong line nearer than this to where one is known is that line."""
_HIDDEN = 12.0  # times the power of noise in a bin
_TOUCH = 4  # bins about a strong line that its own changes fill
_BESIDE = SIDE + 0.5
_HIGHER = 1.5
_MUCH_HIGHER = 4.0
_LEAST_REACH = 4  # bins

LEAK = 0.22
"""Largest |sin(pi u)/(pi u)| beyond the first zero: what a hidden neighbour brings."""


@dataclass(frozen=True, kw_only=True)
class Reading:
    """One line over the whole stretch.

    ``amplitude``: root of the mean square of a(t), the peak amplitude of a steady line of the same
    power; ``frequency`` (unit of the rate): where the line is, the mean of a steady phase;
    ``amplitude_error`` and ``frequency_error``: standard; ``degrees`` of freedom behind them;
    ``half_width`` and ``frequency_half_width``: of the 95 % interval, Student's t. ``changing`` and
    ``turning``: rms of the amplitude's change (relative) and of the phase's [rad] beyond noise;
    ``neighbours``: frequencies of lines fitted beside it; ``beside``: what they, and ``pairs``:
    what further lines at equal distances to both sides, up to REACH bins, and what is next to
    known lines, add to its mean square as its parts, what they share over the record included;
    ``noise``: rms amplitude that noise brings to one bin; ``explained`` is False where more is left
    over than noise and a changing amplitude or phase can be.
    """

    amplitude: float
    frequency: float
    amplitude_error: float
    frequency_error: float
    degrees: float
    changing: float
    turning: float
    neighbours: tuple[float, ...]
    beside: float
    pairs: float
    noise: float
    explained: bool

    @property
    def hidden(self) -> bool:
        """Whether a peak of noise may be as high: 3.5 times the noise of a bin."""
        return self.amplitude**2 <= _HIDDEN * self.noise**2

    @property
    def half_width(self) -> float:
        """Half width of the amplitude's 95 % interval, in the amplitude's unit."""
        return student(self.degrees) * self.amplitude_error

    @property
    def frequency_half_width(self) -> float:
        """Half width of the frequency's 95 % interval, in the frequency's unit."""
        return student(self.degrees) * self.frequency_error


def student(degrees: float) -> float:
    """Student's t that bounds 95 % on both sides.

    >>> f"{student(10.0):.3f}"
    '2.228'
    """
    return float(special.stdtrit(max(degrees, 1.0), 0.975))


def read_line(
    spectrum: LineSpectrum,
    frequency: float,
    *,
    beside: Sequence[float] = (),
    strong: Sequence[Strong] = (),
    followed: float = 0.0,
    reach: int = REACH,
) -> Reading:
    """The line near ``frequency`` over the whole stretch, with errors.

    ``frequency`` (unit of the rate) good to half a bin; ``beside``: frequencies at which other
    lines are known to stand; ``strong``: ``strong_lines`` of the same spectrum, whose leakage is
    taken away; ``followed``: half width (unit of the rate) within which the record has been
    straightened by this line's own phase, so that the phase tells nothing of the noise there;
    ``reach``: bins on each side from which noise is judged.

    Amplitude, frequency and known neighbours are fitted together (Gauss-Newton) to ``reach`` bins
    on each side, the line's image below 0 Hz included. A further line is fitted where it takes
    three quarters of what is left with it: a changing amplitude or phase is even about the line
    and is not taken for one. Errors: the fit's covariance with the noise of I or Q, the quieter;
    what is in both and no line explains comes on top, as the largest leakage it can have.

    Range: the interval of the frequency holds for the mean phase slope of a phase that wanders
    less than a radian. Amplitude: noise with no line of its own in the bins beside.

    >>> from thermogear.signals.lines import line_spectrum
    >>> x = 2.0 * np.cos(2 * np.pi * 0.1 * np.arange(2000))
    >>> found = read_line(line_spectrum(x, 1.0), 0.1)
    >>> round(found.amplitude, 6), round(found.frequency, 6)
    (2.0, 0.1)
    """
    fit = _Fit.of(spectrum, frequency, beside, strong, reach)
    fit = fit.refined()
    left = fit.left(followed)
    for _ in range(3):
        longer = fit.with_neighbour(left)
        if longer is None:
            break
        tried = longer.left(followed)
        if tried.near > 0.25 * left.near + 11.0 * tried.noise:
            break
        fit, left = longer, tried
    return fit.reading(left)


@dataclass(frozen=True)
class _Fit:
    """Lines at ``places`` [bins], the first the one that is read; ``free`` may move.

    ``data`` and ``amplitudes`` count in ``unit``, so that no result depends on the record's own.
    ``taken``: strong lines taken away before.
    """

    spectrum: LineSpectrum
    bins: Floats
    data: Complexes
    places: Floats
    free: NDArray[np.bool_]
    amplitudes: Complexes
    unit: float
    taken: tuple[Strong, ...]

    @classmethod
    def of(
        cls,
        spectrum: LineSpectrum,
        frequency: float,
        beside: Sequence[float],
        strong: Sequence[Strong],
        reach: int,
    ) -> _Fit:
        count, width = spectrum.samples, spectrum.bin_width
        place = frequency / width
        centre = int(np.rint(place))
        low, high = max(1, centre - reach), min((count - 1) // 2, centre + reach)
        bins = np.arange(low, high + 1, dtype=float)
        known: list[float] = []  # each once: two columns of one line would share its height
        for at in sorted(one / width for one in beside):
            if 1.2 < abs(at - place) < reach and at > 1 and (not known or at - known[-1] > APART):
                known.append(at)
        data = spectrum.lines[low : high + 1].copy()
        taken: list[Strong] = []
        away: list[Strong] = []
        for one in strong:
            if abs(one.place - place) < APART or any(abs(one.place - k) < SIDE for k in known):
                continue
            if abs(one.place - place) < 4.0:
                continue  # too near to be told apart by the Hann window
            if low - _TOUCH < one.place < high + _TOUCH:
                taken.append(one)
            away.append(one)
        others = np.array([one.place for one in away])
        sizes = np.array([one.amplitude for one in away], dtype=complex)
        data -= shown(others, bins=bins, samples=count) @ sizes
        data -= shown(-others, bins=bins, samples=count) @ np.conj(sizes)
        places = np.array([place, *known])
        free = np.zeros(places.size, dtype=bool)
        free[0] = True
        unit = _near(float(np.max(np.abs(data), initial=0.0)))
        blank = np.zeros(places.size, complex)
        return cls(spectrum, bins, data / unit, places, free, blank, unit, tuple(taken))._solved()

    def _columns(self, places: Floats) -> tuple[Complexes, Complexes]:
        """Of each place the bins of its cosine and of its sine: (bin, place)."""
        up = shown(places, bins=self.bins, samples=self.spectrum.samples)
        down = shown(-places, bins=self.bins, samples=self.spectrum.samples)
        return up + down, 1j * (up - down)

    def _slopes(self, places: Floats, amplitudes: Complexes) -> Complexes:
        """What the bins change by where each place moves by a bin: (bin, place)."""
        step = 1e-4
        above, below = self._columns(places + step), self._columns(places - step)
        moved = (above[0] - below[0]) * amplitudes.real + (above[1] - below[1]) * amplitudes.imag
        return np.asarray(moved / (2.0 * step))

    def _matrix(self, slopes: bool) -> Floats:
        """Real matrix of the linear problem: cosines, sines, and slopes of the free places."""
        columns = [*self._columns(self.places)]
        if slopes:
            columns.append(self._slopes(self.places[self.free], self.amplitudes[self.free]))
        return _real(np.concatenate(columns, axis=1))

    def _shares(self, above: Complexes, below: Complexes) -> tuple[Floats, Floats]:
        """What is left in I and Q of white noise of power 1 in a bin: (step,) each.

        ``above`` and ``below``: rows by which bins are turned into R_m and R_-m. Noise loses what
        lies in the space of the fitted lines and of those taken away, U its orthonormal base:
        |L|^2 - |L U|^2 of each row L.
        """
        places = np.array([one.place for one in self.taken])
        sizes = np.array([one.amplitude for one in self.taken], dtype=complex)
        others = [*self._columns(places), self._slopes(places, sizes)]
        fitted = np.concatenate([self._matrix(True), _real(np.concatenate(others, axis=1))], axis=1)
        lengths = np.linalg.norm(fitted, axis=0)
        base, size, _ = np.linalg.svd(fitted / np.where(lengths > 0.0, lengths, 1.0), False)
        base = base[:, size > 1e-6 * size[0]]
        up = np.concatenate([above, 1j * above], axis=1)
        down = np.concatenate([below.conj(), -1j * below.conj()], axis=1)
        rows = (up + down) / np.sqrt(2.0), (up - down) / np.sqrt(2.0)
        even, odd = (
            0.5 * (np.sum(np.abs(r) ** 2, axis=1) - np.sum(np.abs(r @ base) ** 2, axis=1))
            for r in rows
        )
        return np.maximum(even, 0.0), np.maximum(odd, 0.0)

    def _model(self) -> Complexes:
        even, odd = self._columns(self.places)
        return np.asarray(even @ self.amplitudes.real + odd @ self.amplitudes.imag)

    def _solved(self) -> _Fit:
        matrix = self._matrix(False)
        found = np.linalg.lstsq(matrix, np.concatenate([self.data.real, self.data.imag]))[0]
        count = self.places.size
        return replace(self, amplitudes=found[:count] + 1j * found[count : 2 * count])

    def refined(self) -> _Fit:
        """Amplitudes and free places by Gauss-Newton."""
        fit = self
        for _ in range(12):
            error = fit.data - fit._model()
            found = np.linalg.lstsq(
                fit._matrix(True), np.concatenate([error.real, error.imag]), rcond=1e-9
            )[0]
            move = np.clip(found[2 * fit.places.size :], -0.3, 0.3)
            places = fit.places.copy()
            places[fit.free] += move
            fit = replace(fit, places=places)._solved()
            if np.max(np.abs(move)) < 1e-7:
                break
        return fit

    def left(self, followed: float) -> Left:
        """What is left beside the line, turned by its phase."""
        error = self.data - self._model()
        place, phase = float(self.places[0]), np.exp(-1j * np.angle(self.amplitudes[0]))
        reach = int(max(1, min(place - self.bins[0], self.bins[-1] - place, self._own_reach())))
        steps = np.arange(1, reach + 1, dtype=float)

        def rows(at: Floats) -> Complexes:
            shapes = shown(place + at, bins=self.bins, samples=self.spectrum.samples).T
            return np.asarray(np.conj(shapes) * phase)

        up, down = rows(steps), rows(-steps)
        shares = self._shares(up, down)
        above, below = up @ error, np.conj(down @ error)
        even, odd = np.abs(above + below) ** 2 / 2.0, np.abs(above - below) ** 2 / 2.0
        noise, here, degrees = noise_beside(
            (even, odd), shares=shares, followed=followed / self.spectrum.bin_width
        )
        known = np.abs(self.places[~self.free] - place)
        known = known[known > NEAR]  # nearer it is not told from the line's own change
        beside = np.any(np.abs(steps[:, None] - known) < _BESIDE, axis=-1)
        even, more = without_others(even, beside, noise)
        odd, most = without_others(odd, beside, noise)
        fine = np.arange(-NEAR, NEAR + 0.01, 0.125)
        fine = fine[np.abs(fine) >= APART]
        fine = fine[(place + fine > self.bins[0]) & (place + fine < self.bins[-1])]
        return Left(
            even=even,
            odd=odd,
            shares=shares,
            noise=noise,
            here=here,
            degrees=degrees,
            crowded=self._own_reach() < REACH,
            others=more + most,
            places=fine,
            finer=np.abs(rows(fine) @ error) ** 2,
        )

    def _own_reach(self) -> float:
        """Half way to the next higher line, whose own changes fill the bins about it; four bins at
        least. A line that is not known must be four times as high: one that wanders has pieces."""
        size, known = abs(self.amplitudes[0]), ~self.free
        higher = [
            *self.places[known][np.abs(self.amplitudes[known]) > _HIGHER * size],
            *(o.place for o in self.taken if abs(o.amplitude) > _MUCH_HIGHER * size * self.unit),
        ]
        nearest = np.min(np.abs(np.asarray(higher) - self.places[0]), initial=np.inf)
        return float(max(0.5 * nearest, _LEAST_REACH))

    def _neighbours(self) -> list[Strong]:
        """Further lines fitted, but for those that were known."""
        pairs = zip(self.places[self.free], self.amplitudes[self.free], strict=True)
        return [Strong(float(place), complex(value)) for place, value in pairs][1:]

    def _pairs(self) -> list[Strong]:
        """Lines at equal distances to both sides, fitted or taken away before."""
        middle = float(self.places[0])
        others = [
            Strong(one.place, one.amplitude / self.unit)
            for one in self.taken
            if abs(one.place - middle) < REACH
        ]
        found = twins([*others, *self._neighbours()], middle)
        return [one for pair in found for one in pair]

    def _added(self, others: Sequence[Strong]) -> float:
        """What ``others`` add to the mean square of a(t), as its part.

        |sum_i c_i exp(2 pi i u_i t/T)|^2 over the record, with them less without.
        """
        at = np.array([self.places[0], *(one.place for one in others)])
        c = np.array([self.amplitudes[0], *(one.amplitude for one in others)])
        shared = dirichlet(at[None, :] - at[:, None], self.spectrum.samples)
        return float(np.real(np.conj(c) @ shared @ c) - abs(c[0]) ** 2)

    def with_neighbour(self, left: Left) -> _Fit | None:
        """The fit with a further line at the highest of what is left, where that is no noise.

        None also where the lines of the fit run into each other.
        """
        if left.places.size == 0:
            return None
        top = int(np.argmax(left.finer))
        if left.finer[top] < 12.0 * left.noise:
            return None
        fit = replace(
            self,
            places=np.append(self.places, self.places[0] + left.places[top]),
            free=np.append(self.free, True),
            amplitudes=np.append(self.amplitudes, 0.0),
        )
        fit = fit._solved().refined()
        apart = np.abs(fit.places[1:] - fit.places[0])
        moved = abs(fit.places[0] - self.places[0])
        if np.any(apart < APART) or np.any(apart > REACH) or moved > 0.5:
            return None
        return fit

    def reading(self, left: Left) -> Reading:
        """Amplitude and frequency with their errors."""
        matrix, width = self._matrix(True), self.spectrum.bin_width
        count = self.places.size
        spread = _inverse(matrix) * (0.5 * left.here)
        own = self.amplitudes[0]
        size = abs(own)
        way = np.zeros(matrix.shape[1])
        if size > 0.0:
            way[0], way[count] = own.real / size, own.imag / size
        changed, turned = left.changed, left.turned
        # mean square of a(t): that of the mean, of the change, less what noise brings to both
        square = size**2 - float(spread[0, 0] + spread[count, count]) + turned
        square += left.change
        amplitude = float(np.sqrt(square)) if square > left.noise else size
        hidden_power = left.shared if changed and turned else 0.0
        both = LEAK**2 * hidden_power
        variance = float(way @ spread @ way) * max(1.0, (size / amplitude) ** 2) + both
        # noise in the bins of the change
        variance += 0.25 * left.even.size * left.noise**2 / max(amplitude, 1e-150) ** 2
        if size**2 <= _HIDDEN * left.noise:  # a peak of noise may be as high
            variance += left.noise
        phase = turned / max(size, 1e-150) ** 2
        wander = 0.25 * phase + both / max(size, 1e-150) ** 2
        neighbours = self._neighbours()
        return Reading(
            amplitude=amplitude * self.unit,
            frequency=float(self.places[0]) * width,
            amplitude_error=float(np.sqrt(variance)) * self.unit,
            frequency_error=float(np.sqrt(spread[2 * count, 2 * count] + wander)) * width,
            degrees=left.degrees,
            changing=float(np.sqrt(changed) / max(size, 1e-300)),
            turning=float(np.sqrt(phase)),
            neighbours=tuple(one.place * width for one in neighbours),
            beside=self._added(neighbours) * self.unit**2,
            pairs=(self._added(self._pairs()) + left.others) * self.unit**2,
            noise=float(np.sqrt(left.noise)) * self.unit,
            explained=hidden_power == 0.0,
        )


def _near(size: float) -> float:
    """The power of two next to ``size``: numbers divided by it keep their digits.

    1 for sizes whose inverse is no number.
    """
    return float(2.0 ** np.rint(np.log2(size))) if size > 1e-290 else 1.0


def _inverse(matrix: Floats) -> Floats:
    """The inverse of matrix^T matrix, of columns as large as one another; a column that the others
    hold is left out."""
    sizes = np.linalg.norm(matrix, axis=0)
    sizes[sizes == 0.0] = 1.0
    scaled = matrix / sizes
    found = np.linalg.pinv(scaled.T @ scaled, rcond=1e-12, hermitian=True)
    return np.asarray(found / np.outer(sizes, sizes))


def _real(columns: Complexes) -> Floats:
    return np.concatenate([columns.real, columns.imag])
