"""A record whose speed changes: gearing and lines in angle, orders slice by slice over speed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError
from thermogear.measured.chain import Turning
from thermogear.measured.gate import Passed
from thermogear.measured.gearing import Gearing
from thermogear.measured.lines import MeasuredLine, Wanted, jittered, wanted_lines
from thermogear.measured.order_angle import MESHES, OrderAngle, order_angle
from thermogear.measured.over_speed import OrderMap, OrderSlices
from thermogear.measured.quantities import quantities
from thermogear.measured.record import Notice, Record
from thermogear.measured.shaft import VARIES, Shaft, locked, tracked_shaft, usable_shaft
from thermogear.measured.turns import MeshTurns
from thermogear.measured.units import kind_of
from thermogear.signals.filters import thinned
from thermogear.signals.lines import line_spectrum
from thermogear.signals.orders import resample_by_angle
from thermogear.signals.slices import order_slices
from thermogear.signals.strong import strong_lines
from thermogear.signals.tracking import samples_per_turn

_TURNS = 12  # of one row's window
_ROWS, _COLUMNS = 160, 480


def order_map(
    straight: list[Floats],
    *,
    turns: Floats,
    per_turn: int,
    rate: float,
    unit: float,
    highest: float,
) -> OrderMap:
    """The map of the first of the records in angle, up to 1.3 times the ``highest`` order.

    ``per_turn`` samples per turn; ``turns`` at each sample of the stretch, ``rate`` [samples/s];
    ``unit``: orders told in one order of ``turns``.
    """
    values = straight[0]
    while per_turn % 2 == 0 and per_turn / 2 >= 3.4 * 1.3 * highest:
        values = thinned(values, 2)
        per_turn //= 2
    whole = values.size // per_turn
    window_turns = max(2, min(_TURNS, whole // 4))
    count = window_turns * per_turn
    last = values.size - count
    starts = np.unique(np.linspace(0, max(0, last), min(_ROWS, max(1, whole))).astype(int))
    weight = np.hanning(count + 1)[:-1]
    rows = []
    for begin in starts:
        part = values[begin : begin + count]
        rows.append(np.abs(np.fft.rfft((part - part.mean()) * weight)) * 2.0 / weight.sum())
    table = np.stack(rows)
    top = min(table.shape[1], int(1.3 * highest * window_turns) + 1)
    run = max(1, -(-top // _COLUMNS))
    columns = top // run
    table = table[:, : columns * run].reshape(table.shape[0], columns, run).max(axis=-1)
    order = (np.arange(columns) * run + 0.5 * (run - 1)) / window_turns
    middle = np.ceil(turns[0]) + (starts + 0.5 * count) / per_turn
    grid = np.arange(turns.size)
    sample = np.interp(middle, turns, grid)
    ahead, back = (np.interp(middle + s, turns, grid) for s in (0.5, -0.5))
    return OrderMap(
        order=order * unit,
        speed=2.0 * np.pi * rate / np.maximum(ahead - back, 1e-9) / unit,
        time=sample / rate,
        amplitude=table,
        turns=window_turns,
    )


_NORMAL = 1.959964
_NEIGHBOUR = 0.35  # orders: nearer than this a line beside is the line itself, changing
_HIGHEST = 1.0 / 2.56


@dataclass(frozen=True, kw_only=True)
class Changing:
    """What was found in angle: ``slices`` and ``lines`` of a run whose speed changes; ``turns`` to
    read lines of the whole record by where it is nearly steady."""

    gearing: Gearing | None
    teeth: int | None
    notices: tuple[Notice, ...]
    turns: MeshTurns | None = None
    lines: tuple[MeasuredLine, ...] = ()
    slices: OrderSlices | None = None


def read_in_angle(
    record: Record,
    through: Passed,
    *,
    teeth: int | None,
    speed: float | None,
    harmonics: int,
    sidebands: int,
    orders: Sequence[float],
    pulses_per_turn: float | None,
    tacho: Record | None,
    sensor_tolerance: float | None,
) -> tuple[Changing | None, list[Notice]]:
    """The record in the angle that a tacho, a speed channel or a tracked line gives.

    ``through``: the channels as they came through the gate; ``speed`` [rad/s] as stated. None, and
    what should be known all the same, where neither is there and the speed is steady.
    """
    notices: list[Notice] = []
    table = through.table
    shaft = usable_shaft(
        record, through, pulses_per_turn=pulses_per_turn, tacho=tacho, notices=notices
    )
    if shaft is not None and shaft.by_speed:
        if shaft.span < VARIES:
            told = Notice.of("speed_steady", channel=shaft.channel, within=shaft.span - 1.0)
            return None, [*notices, told]
        shaft = locked(shaft, table, teeth)
    if shaft is None:
        shaft = tracked_shaft(table)
    if shaft is None:
        return None, notices
    notices += shaft.told
    angle = order_angle(shaft, table, teeth=teeth, speed=speed, rate=record.rate, notices=notices)
    if shaft.span < VARIES and angle.mesh is None:
        return None, notices
    if shaft.span < VARIES:
        return _steady(shaft, angle, notices), notices
    return _sliced(
        record, through, shaft, angle, harmonics, sidebands, orders, sensor_tolerance, notices
    ), notices


def _steady(shaft: Shaft, angle: OrderAngle, notices: list[Notice]) -> Changing:
    """The angle of a nearly steady shaft, for lines of the whole record."""
    assert angle.mesh is not None
    cycles = angle.mesh * angle.turns
    mean = float((cycles[-1] - cycles[0]) / (cycles.size - 1))
    turning = Turning(
        cycles=cycles, dropped=angle.first, per_cycle=int(2 ** np.ceil(np.log2(1.0 / mean)))
    )
    gearing = angle.gearing or Gearing(
        mesh_frequency=mean,
        harmonics=(),
        evidence=(f"the mesh line is put at {angle.teeth} times the tacho's shaft",),
        teeth=angle.teeth,
    )
    turns = MeshTurns(
        frequency=mean,
        half_width=mean / cycles.size,
        turning=turning,
        told=(Notice.of("read_in_angle", channel=shaft.channel),),
        phase_noise=2.0 * np.pi * angle.mesh * angle.noise,
    )
    return Changing(
        gearing=replace(gearing, mesh_frequency=mean, turning=mean / angle.mesh),
        teeth=angle.teeth,
        notices=tuple(notices),
        turns=turns,
    )


def _sliced(
    record: Record,
    through: Passed,
    shaft: Shaft,
    angle: OrderAngle,
    harmonics: int,
    sidebands: int,
    orders: Sequence[float],
    sensor_tolerance: float | None,
    notices: list[Notice],
) -> Changing:
    turns, rate = angle.turns, record.rate or 1.0
    chosen = through.channels
    inside = through.table[:, angle.first : angle.first + turns.size]
    per_turn = samples_per_turn(turns)
    mean = float((turns[-1] - turns[0]) / (turns.size - 1))
    gearing = (
        replace(
            angle.gearing,
            mesh_frequency=angle.mesh * mean,
            turning=None if angle.of_mesh else mean,
        )
        if angle.mesh is not None and angle.gearing is not None
        else None
    )
    slowest = float(np.percentile(np.diff(turns), 1.0))
    _require_seen(orders, angle, highest=min(0.43 * per_turn, _HIGHEST / slowest))
    if angle.mesh is not None:
        pace = angle.mesh * slowest if gearing is None else gearing.mesh_frequency
        notices += harmonics_told(pace, asked=harmonics, rate=record.rate)
    wanted = _wanted(gearing, angle, inside, per_turn, harmonics, sidebands, orders, mean)
    if not wanted:
        why = f"in the angle of {shaft.origin} no line is above the noise: does it mark the turns?"
        fix = "name the channel of pulses or of speed by --tacho, or leave it out"
        raise InputError("record", "no line", why=why, fix=fix)
    places = np.array([w.position / mean for w in wanted])
    read, maps = [], []
    for values in inside:
        straight = resample_by_angle(values, turns, samples_per_turn=per_turn)
        spectrum = line_spectrum(straight, float(per_turn))
        strong = [one.place * spectrum.bin_width for one in strong_lines(spectrum, 24)]
        beside = [o for o in strong if np.min(np.abs(o - places)) > _NEIGHBOUR]
        read.append(
            order_slices(
                straight,
                samples_per_turn=per_turn,
                first=float(np.ceil(turns[0])),
                orders=list(places),
                beside=_apart(beside),
                angle_noise=angle.noise,
            )
        )
        maps.append(straight)
    steps = read[0].turns
    sample = np.interp(steps, turns, np.arange(turns.size))
    speed = _rates(turns, steps)  # turns per sample
    frequency = places[:, None] * speed[None, :] * rate
    seen = np.where(frequency < _HIGHEST * rate, 1.0, np.nan)[None]
    kept = np.array([np.nan if c.name in through.withheld else 1.0 for c in chosen])
    seen = seen * kept[:, None, None]
    damage = np.array([through.extra.get(c.name, 0.0) for c in chosen])[:, None, None]
    damage = damage + 2.0 * record.rate_share + jittered(frequency / rate, record.jitter)
    amplitude = np.stack([s.amplitude for s in read])
    unit = 1.0 if not angle.of_mesh else 1.0 / MESHES
    known = [c.unit is not None and not c.needs_scale for c in chosen]
    shafts_speed = 2.0 * np.pi * rate * speed * (1.0 if not angle.of_mesh else MESHES)
    time = (sample + angle.first) / rate
    slices = OrderSlices(
        channels=tuple(c.name for c in chosen),
        names=tuple(w.name for w in wanted),
        orders=places * unit,
        of_mesh=angle.of_mesh,
        time=time,
        speed=shafts_speed,
        acceleration=np.gradient(shafts_speed, time) if time.size > 1 else np.zeros(1),
        frequency=frequency,
        reading=amplitude * seen,
        half_width=(
            np.hypot(
                np.stack([s.half_width for s in read]),
                _NORMAL * (sensor_tolerance or 0.0) * amplitude,
            )
            + damage * amplitude
        )
        * seen,
        phase=np.stack([s.phase for s in read]) * seen,
        block=np.stack([s.block for s in read]) * seen,
        si=np.array([c.si_factor if k else np.nan for c, k in zip(chosen, known, strict=True)]),
        kinds=tuple(
            kind_of(c.unit) if k and c.unit else "" for c, k in zip(chosen, known, strict=True)
        ),
        map=order_map(
            maps,
            turns=turns,
            per_turn=per_turn,
            rate=rate,
            unit=unit,
            highest=float(np.max(places)),
        ),
    )
    low, high = float(shafts_speed.min()), float(shafts_speed.max())
    notices.append(
        Notice.of(
            "mesh_speed_changes" if angle.of_mesh else "speed_changes",
            lowest=low if record.rate is not None else None,
            highest=high if record.rate is not None else None,
            ratio=high / low,
        )
    )
    lines = _lines(slices, wanted, angle, mean, rate, record.rate is not None)
    return Changing(
        gearing=gearing,
        teeth=angle.teeth,
        notices=tuple(notices),
        lines=lines,
        slices=slices,
    )


def _wanted(
    gearing: Gearing | None,
    angle: OrderAngle,
    inside: Floats,
    per_turn: int,
    harmonics: int,
    sidebands: int,
    orders: Sequence[float],
    mean: float,
) -> list[Wanted]:
    """The lines to read, their positions in cycles per sample at the mean speed."""
    found: list[Wanted] = []
    if gearing is not None:
        found = wanted_lines(gearing, inside[0], harmonics=harmonics, sidebands=sidebands)
    elif angle.mesh is not None:
        found = [
            Wanted("mesh", f"mesh x {k}", position=k * angle.mesh * mean, half_width=0.0, rank=k)
            for k in range(1, harmonics + 1)
        ]
    if angle.teeth and not any(w.kind == "sideband" for w in found):
        found += _sidebands(found, angle.teeth, sidebands, mean)
    if not found and not orders:
        found = _strongest(inside[0], angle, per_turn, 4 * harmonics, mean)
    if not angle.of_mesh:
        found += order_lines(orders, mean, found)
    kept: list[Wanted] = []
    for one in found:
        far = all(abs(one.position - k.position) > 0.05 * mean for k in kept)
        if far and one.position / mean < 0.43 * per_turn:
            kept.append(one)
    return kept


def _sidebands(meshes: Sequence[Wanted], teeth: int, count: int, shaft: float) -> list[Wanted]:
    """Sidebands of mesh lines at whole turns of the first ``shaft`` [cycles/sample]."""
    return [
        Wanted(
            "sideband",
            f"{one.name} {'+' if sign > 0 else '-'} {n} shaft/{teeth}",
            position=one.position + sign * n * shaft,
            half_width=0.0,
        )
        for one in meshes
        if one.rank
        for n in range(1, count + 1)
        for sign in (-1, 1)
    ]


def _strongest(
    values: Floats, angle: OrderAngle, per_turn: int, most: int, mean: float
) -> list[Wanted]:
    """The strongest orders, where no mesh line is known."""
    straight = resample_by_angle(values, angle.turns, samples_per_turn=per_turn)
    spectrum = line_spectrum(straight, float(per_turn))
    found: list[Wanted] = []
    for one in strong_lines(spectrum, most):
        place = one.place * spectrum.bin_width
        apart = all(abs(place - w.position / mean) > _NEIGHBOUR for w in found)
        if 0.4 < place < 0.2 * per_turn and apart:
            name = f"order {place:.4g}"
            found.append(Wanted("order", name, position=place * mean, half_width=0.0))
    return found


def order_lines(
    orders: Sequence[float], shaft: float, found: Sequence[Wanted] = ()
) -> list[Wanted]:
    """Asked ``orders`` of a shaft [cycles/sample] as lines, without those ``found`` already."""
    return [
        Wanted("order", f"order {o:g}", position=o * shaft, half_width=2e-4 * o * shaft)
        for o in orders
        if all(abs(o * shaft - w.position) > 1e-6 * shaft for w in found)
    ]


def _require_seen(orders: Sequence[float], angle: OrderAngle, highest: float) -> None:
    """Refuse ``orders`` where no shaft's angle is known, or that are seen in no slice."""
    if orders and angle.of_mesh:
        got = ", ".join(f"{o:g}" for o in orders)
        raise InputError("orders", got, why="no shaft's speed is known", fix="--speed or --tacho")
    limit = "the sampling rate/2.56 at the slowest speed"
    require_orders(orders, lowest=0.0, highest=highest, limit=limit)


def require_orders(
    orders: Sequence[float],
    *,
    lowest: float,
    highest: float,
    limit: str = "half the sampling rate",
) -> None:
    """Refuse an order of a shaft that a record cannot hold.

    ``lowest``: the order that comes once in the record; ``highest``: ``limit``, in orders.

    >>> try:
    ...     require_orders([1.0, 300.0], lowest=0.01, highest=243.3)
    ... except InputError as error:
    ...     print(str(error).split("; ")[1:3])
    ['allowed 0.01..243.3', 'from 243.3 on it is above half the sampling rate']
    """
    for order in orders:
        if lowest <= order <= highest:
            continue
        why = f"from {highest:.4g} on it is above {limit}"
        fix = f"ask for less, as --orders {np.floor(highest):g}, or sample faster"
        if order < lowest:
            why = "it does not come once in the record"
            fix = f"ask for more, as --orders {np.ceil(lowest):g}, or record for longer"
        allowed = f"{lowest:.4g}..{highest:.4g}"
        raise InputError("orders", f"{order:g}", allowed=allowed, why=why, fix=fix)


def harmonics_told(line: float | None, *, asked: int, rate: float | None) -> list[Notice]:
    """How many of the ``asked`` mesh harmonics are below rate/2.56, where not all are.

    Mesh ``line`` [cycles/sample]; ``rate`` [samples/s].

    >>> [told.data["read"] for told in harmonics_told(0.0596, asked=20, rate=10_000.0)]
    [6]
    """
    fit = asked if line is None else max(int(_HIGHEST / line), 1)
    if fit >= asked:
        return []
    top = None if rate is None else _HIGHEST * rate
    return [Notice.of("harmonics_above_rate", read=fit, asked=asked, highest=top)]


def _apart(beside: Sequence[float]) -> list[float]:
    kept: list[float] = []
    for one in beside:
        if all(abs(one - k) > _NEIGHBOUR for k in kept):
            kept.append(one)
    return kept


def _rates(turns: Floats, steps: Floats) -> Floats:
    """Turns per sample at the steps: over a turn on each side, where there is one."""
    grid = np.arange(turns.size)
    low, high = np.maximum(steps - 1.0, turns[0]), np.minimum(steps + 1.0, turns[-1])
    places = np.interp(low, turns, grid), np.interp(high, turns, grid)
    return np.asarray((high - low) / (places[1] - places[0]))


def _lines(
    slices: OrderSlices,
    wanted: Sequence[Wanted],
    angle: OrderAngle,
    mean: float,
    rate: float,
    in_hertz: bool,
) -> tuple[MeasuredLine, ...]:
    """The root mean square over the turns of every line of every channel."""
    found = []
    for c, channel in enumerate(slices.channels):
        for k, want in enumerate(wanted):
            a, h = slices.reading[c, k], slices.half_width[c, k]
            good = np.isfinite(a)
            if not good.any():
                continue
            size = float(np.sqrt(np.mean(a[good] ** 2)))
            # neighbours share their samples and their bias: no root of their number
            relative = float(np.sqrt(np.mean(h[good] ** 2))) / max(size, 1e-300)
            omega = 2.0 * np.pi * slices.frequency[k]
            own = quantities(a * slices.si[c], omega=omega, kind=slices.kinds[c])
            acc, disp = (float(np.sqrt(np.mean(q[good] ** 2))) for q in own)
            found.append(
                MeasuredLine(
                    channel=channel,
                    kind=want.kind,
                    name=want.name,
                    order=float(slices.orders[k]) if not angle.of_mesh else float("nan"),
                    position=want.position,
                    frequency=want.position * rate if in_hertz else float("nan"),
                    reading=size,
                    acceleration=acc,
                    displacement=disp if in_hertz or slices.kinds[c] == "displacement" else np.nan,
                    uncertainty=relative / _NORMAL,
                    bin_offset=float("nan"),
                    prominence=1.0 / max(relative, 1e-6),
                    shaft_speed=2.0 * np.pi * mean * rate
                    if in_hertz and not angle.of_mesh
                    else float("nan"),
                    half_width=relative,
                )
            )
    return tuple(found)
