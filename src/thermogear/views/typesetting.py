"""Symbols, axes and prose as a reader sees them, in pictures and on pages."""

from __future__ import annotations

import math
import re

import numpy as np
from markupsafe import Markup, escape
from numpy.typing import NDArray

from thermogear.base.arrays import Dataset
from thermogear.base.display import CELSIUS, celsius, display, exactly, raised
from thermogear.base.vocabulary import QUANTITIES, told_labels

FAR = 400.0
"""Jam temperatures [degC] above this are not told apart: no gear lives there."""


def shown(data: Dataset, name: str) -> NDArray[np.float64]:
    """The values of ``data[name]`` in display units."""
    variable = data[name]
    return display(name, str(variable.attrs.get("units", QUANTITIES[name].unit)))(variable.values)


def plain(text: object) -> str:
    """Stored text made safe for a picture: no mathematics, no line ends, not endless."""
    flat = " ".join(str(text).split()).replace("\\", "").replace("$", r"\$")
    return flat if len(flat) <= 60 else flat[:57] + "..."


def label_text(one: Dataset) -> str:
    """The label of one stored point, for chaos with how long and from how many starts."""
    return str(told_labels(one).item())


_BELOW = dict(zip("0123456789", "₀₁₂₃₄₅₆₇₈₉", strict=True))
_PIECE = re.compile(r"([^\W\d_]+|[^\s_]+?)_(\w+)")


def math_symbol(symbol: str) -> str:
    """A vocabulary symbol for a picture: ``T_f`` with its index set below."""
    return _PIECE.sub(lambda m: m[1] + _index(m[2]), symbol)


def _index(text: str) -> str:
    """Digits as characters of their own, which are quicker to set; letters as mathematics."""
    if all(letter in _BELOW for letter in text):
        return "".join(_BELOW[letter] for letter in text)
    return f"$_{{{text}}}$"


def html_symbol(symbol: str) -> Markup:
    """A vocabulary symbol for a page: ``T_f`` with its index set below."""
    return Markup(_PIECE.sub(lambda m: f"{m[1]}<sub>{m[2]}</sub>", str(escape(symbol))))


def axis_label(name: str, words: str | None = None, unit: str | None = None) -> str:
    """Words, symbol and [unit] of a quantity, for an axis."""
    quantity = QUANTITIES[name]
    shown_unit = display(name, unit).unit
    parts = [
        quantity.long_name if words is None else words,
        math_symbol(quantity.symbol),
        f"[{shown_unit}]",
    ]
    return " ".join(part for part in parts if part)


def jam_at(kelvin: float, *, without_heat: bool = False, known: bool = True) -> str:
    """A jam temperature; far beyond what gears bear it is only said to lie there.

    ``without_heat``: the undeformed pair is jammed already. ``known``: heat and contact settled.
    """
    if not known:
        return "–"
    if without_heat:
        return "without heat"
    if not math.isfinite(kelvin):
        return "never"
    return celsius(kelvin) if CELSIUS(kelvin) < FAR else f"> {FAR:.0f} °C"


_GREEK = {"omega": "ω", "lambda": "λ", "delta": "δ", "Delta ": "Δ", "theta": "θ", "eta": "η"}
_PRETTY = (
    (re.compile(r"\bum\b"), "µm"),
    (re.compile(r"\+-"), "±"),
    (re.compile(r"(?<=\d) ?(?:deg ?)?C\b"), " °C"),
    (
        re.compile(
            r"\b(omega|lambda)(?=_)|\b(delta)(?= -)|\b(Delta )(?=f\b)|\b(theta)(?=')|\b(eta)\b"
        ),
        lambda m: _GREEK[m[0]],
    ),
    (re.compile(r"\bsqrt\((\w+)\)"), "√\\1"),
    (re.compile(r"(?<![\w.)])-(?=\d)|(?<= )-(?= )"), "−"),
    (re.compile(r"\b([bB])'"), "\\1′"),
)
_NAMED = re.compile(r"(?<![\w.])([A-Za-zωεζδλ])_([A-Za-z0-9]{1,5})\b")
_POWER = re.compile(r"\b(\d(?:\.\d+)?)e([+-]\d+)\b")
_RAISED = (("^2", "²"), ("^3", "³"))
_UNIT = re.compile(r"(?<=\d) (?=(?:%|°C|K|µm|mm|rpm|N m|kHz|Hz|MPa|g)(?!\w))")


def prose(text: object) -> Markup:
    """Stored words for a page: escaped, with proper units, minus signs and indices."""
    plain_text = str(escape(str(text)))
    plain_text = _POWER.sub(_power, plain_text.replace("&#39;", "'"))
    for pattern, better in _PRETTY:
        plain_text = pattern.sub(better, plain_text)
    plain_text = _NAMED.sub(r"\1<sub>\2</sub>", plain_text)
    for plain_power, better in _RAISED:
        plain_text = plain_text.replace(plain_power, better)
    return Markup(_UNIT.sub("\u00a0", plain_text))


def _power(found: re.Match[str]) -> str:
    return "0" if float(found[0]) == 0.0 else f"{found[1]}·10{raised(int(found[2]))}"


def field_name(text: object) -> Markup:
    """A dotted name of a case file that may break after its dots and underscores."""
    return Markup(re.sub(r"([._])", r"\1<wbr/>", str(escape(str(text)))))


def operating_names(data: Dataset) -> list[str]:
    """One name per operating point: its speed, and its torque where torques differ."""
    speeds = display("pinion_speed")(data["pinion_speed"].values)
    torques = np.asarray(data["pinion_torque"].values, dtype=float)
    alike = np.ptp(torques) <= 1e-9 * np.max(np.abs(torques)) if torques.size else True
    names = [f"{exactly(float(speed))} rpm" for speed in speeds]
    if alike:
        return names
    return [f"{a}, {exactly(float(t))} N m" for a, t in zip(names, torques, strict=True)]


def jam_words(kelvin: float) -> str:
    """What to write where a point is jammed: with its temperature, if there is one."""
    if not math.isfinite(kelvin):
        return "jammed: the backlash is used up"
    return f"jammed: backlash used up at {celsius(kelvin)}"
