"""Both gears in mesh: whole to scale, and the mesh with gaps and growth enlarged."""

from __future__ import annotations

import numpy as np

from thermogear.base.display import PERCENT
from thermogear.base.vocabulary import UNDEFORMED
from thermogear.views.gears import PINION, WHEEL, GearDrawing, Points
from thermogear.views.picture import Axis, Panel, Picture
from thermogear.views.style import COLD, HOT, INK, QUIET, scale

SHARES = scale("viridis")[1:-1]
"""From no load to all of it; neither so dark nor so light that it is lost."""
MOST_TEETH = 160
"""Teeth of a gear that are drawn whole; of more, those that are nearest to the mesh."""
_CIRCLE = np.exp(1j * np.linspace(0.0, 2.0 * np.pi, 181))
_PITCH, _BASE = (8, 3, 2, 3), (2, 2)


def colour_of(share: float) -> str:
    """The colour of a contact point that carries this share of the load."""
    return SHARES[round(min(max(share, 0.0), 1.0) * (len(SHARES) - 1))]


def in_mesh(drawing: GearDrawing, phase: float = 0.25, show: str = "both") -> Picture:
    """The gears at the drawn mesh phase nearest to ``phase``, one or "both" states of heat."""
    place = drawing.nearest(phase)
    states = [one for one in drawing.states if show in ("both", one.name)] or drawing.states
    return Picture(
        [[_whole(drawing, place), _mesh(drawing, place, [one.name for one in states])]],
        size=(10.0, 4.6),
        legend=6,
    )


def _whole(drawing: GearDrawing, place: int) -> Panel:
    """Both gears with one scale on both axes."""
    panel = Panel(
        Axis("along the line of centres [mm]", grid=False),
        Axis("across [mm]", grid=False),
        "Both gears to scale, as drawn",
        equal=True,
    )
    cold = drawing.states[0]
    for gear in (PINION, WHEEL):
        centre = drawing.centre(cold, gear, factor=1.0)
        line = _silhouette(drawing, gear, place)
        panel.curve(line.real, line.imag, colour=INK, width=0.7)
        bore = centre + drawing.circles[gear]["bore"] * _CIRCLE
        panel.curve(bore.real, bore.imag, colour=INK, width=0.7)
        for radius, dash in _circles(drawing, gear):
            circle = centre + radius * _CIRCLE
            panel.curve(circle.real, circle.imag, colour=QUIET, width=0.6, dash=dash)
        panel.points([centre], [0.0], colour=QUIET, marker="plus", size=4.0)
    ends = np.array(drawing.line_of_action)
    panel.curve(ends.real, ends.imag, colour=_LINE, width=0.9)
    reach = _reach(drawing)
    x = drawing.pitch_point + reach.real * np.array([-1, 1, 1, -1, -1])
    panel.curve(x, reach.imag * np.array([-1, -1, 1, 1, -1]), colour=HOT, width=0.8, dash=(3, 2))
    return panel


_LINE = "#009E73"


def _silhouette(drawing: GearDrawing, gear: int, place: int) -> Points:
    """All teeth in few points, or of very many those near the mesh."""
    state, teeth = drawing.states[0], drawing.teeth[gear]
    pitch = drawing.shape(state, gear, factor=1.0)
    tip, fine = pitch.size // 2, 0.02 * drawing.module
    before, after = _corners(pitch[: tip + 1], fine), _corners(pitch[: tip - 1 : -1], fine)[::-1]
    kept = np.concatenate([before, after[1:]])
    axis, step = drawing.axis(state, gear, phase=place, factor=1.0), 2.0 * np.pi / teeth
    facing = 0.0 if gear == PINION else np.pi
    nearest = round((facing - axis) / step)
    half = min(teeth, MOST_TEETH) // 2 + 1
    around = np.arange(teeth + 1) if teeth <= MOST_TEETH else nearest + np.arange(-half, half)
    line = (np.exp(1j * (axis + step * around))[:, None] * kept[None, :-1]).ravel()
    line = line[: teeth * (kept.size - 1) + 1] if teeth <= MOST_TEETH else line
    return np.asarray(line + drawing.centre(state, gear, factor=1.0))


def _corners(points: Points, tolerance: float) -> Points:
    """The fewest of ``points`` from which none is further off than about ``tolerance`` [mm]."""
    chord = points[-1] - points[0]
    away = np.abs(((points - points[0]) * np.conj(chord)).imag) / max(abs(chord), 1e-12)
    worst = int(np.argmax(away))
    if away[worst] <= tolerance:
        return points[[0, -1]]
    first, second = (_corners(part, tolerance) for part in (points[: worst + 1], points[worst:]))
    return np.concatenate([first, second[1:]])


def _circles(drawing: GearDrawing, gear: int) -> list[tuple[float, tuple[int, ...]]]:
    """Operating pitch circle and base circle with their lines."""
    rolling = drawing.pitch_point
    if gear == WHEEL:
        rolling = drawing.centre_distance - rolling
    return [(rolling, _PITCH), (drawing.circles[gear]["base"], _BASE)]


def _reach(drawing: GearDrawing) -> complex:
    """Half width and half height of the window on the mesh [mm]."""
    ends = [drawing.path[name] - drawing.pitch_point for name in ("A", "E")]
    high = max(abs(one.imag) for one in ends) + 0.8 * drawing.module
    return complex(0.8 * high, high)


def _within(drawing: GearDrawing, points: Points, reach: complex) -> Points:
    """``points`` with those outside the window left out, so that a line is broken there."""
    away = points - drawing.pitch_point
    inside = (np.abs(away.real) <= reach.real) & (np.abs(away.imag) <= reach.imag)
    beside = inside.copy()
    beside[1:] |= inside[:-1]
    beside[:-1] |= inside[1:]
    return np.where(beside, points, complex(np.nan, np.nan))


def _mesh(drawing: GearDrawing, place: int, shown: list[str]) -> Panel:
    """The teeth about the pitch point, what is small enlarged."""
    reach, c = _reach(drawing), drawing.pitch_point
    times = f" × {drawing.factor:g}" if drawing.factor != 1.0 else " to scale"
    panel = Panel(
        Axis("along the line of centres [mm]", grid=False, margin=0.0),
        Axis("across [mm]", low=-reach.imag, high=reach.imag, grid=False),
        f"In mesh, phase {drawing.phase[place]:.3g}: gaps, growth, deviations{times}",
        equal=True,
    )
    looks = ((UNDEFORMED, COLD, "cold, as drawn", 2.2), ("hot", HOT, "hot", 1.2))
    for name, colour, words, width in looks:
        if name not in shown:
            continue
        state = drawing.state(name)
        label = words
        for gear in (PINION, WHEEL):
            for points in drawing.near(state, gear, phase=place, reach=reach):
                line = _within(drawing, points, reach)
                panel.curve(line.real, line.imag, colour=colour, width=width, label=label)
                label = ""
    _lines(panel, drawing, reach)
    # too small to be seen: it is there for its colour bar
    speck = 1e-9 * drawing.module * np.arange(3)
    panel.field(
        c + speck, speck[:2], [[0.0, 1.0]], colours=SHARES,
        low=0.0, high=1.0, words="share of the load on a contact point",
    )  # fmt: skip
    state = drawing.state(shown[-1])
    for point, share in zip(drawing.contact[place], state.share[place], strict=True):
        if np.isfinite(point) and share > 0.0:
            panel.points(
                [point.real], [point.imag], colour=colour_of(float(share)), size=9.0,
                edge=INK, edge_width=0.9, order=5.0,
            )  # fmt: skip
            panel.text(
                point.real, point.imag, f"{PERCENT(share):.0f} %", offset=(9.0, 0.0),
                across="left", size=8.5, box=True, order=6.0,
            )  # fmt: skip
    return panel


def _lines(panel: Panel, drawing: GearDrawing, reach: complex) -> None:
    """Line of action with A..E, pitch and base circles, within the window."""
    ends = np.array([drawing.path[name] for name in "AE"])
    panel.curve(ends.real, ends.imag, colour=_LINE, width=1.4, label="line of action A to E")
    panel.points(ends.real, ends.imag, colour=_LINE, marker="dot", size=6.0)
    for name, place, side, up in (("A", ends[0], -4.0, -7.0), ("E", ends[1], 4.0, 7.0)):
        panel.text(place.real, place.imag, name, offset=(side, up), colour=_LINE, bold=True)
    for words, number in (("operating pitch circles", 0), ("base circles", 1)):
        label = words
        for gear in (PINION, WHEEL):
            radius, dash = _circles(drawing, gear)[number]
            facing = 0.0 if gear == PINION else np.pi
            wide = min(1.5 * abs(reach) / radius, np.pi)
            arc = radius * np.exp(1j * (facing + np.linspace(-wide, wide, 61)))
            arc = arc + drawing.centre(drawing.states[0], gear, factor=1.0)
            arc = _within(drawing, arc, reach)
            if np.isfinite(arc).any():
                panel.curve(
                    arc.real, arc.imag, colour=QUIET, width=0.8, dash=dash,
                    label=label, order=1.5,
                )  # fmt: skip
                label = ""
    panel.points([drawing.pitch_point], [0.0], colour=QUIET, marker="plus", size=5.0)
