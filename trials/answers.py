"""Random cases through answers and runs, every sentence held against the data beside it.

``make trial NAME=answers`` puts 300 case files (seed fixed before the first run) through the
answers
and 60 of them through a run, and writes trials/records/answers.md; ``python trials/answers.py 20
4`` prints a short one.

:func:`contradictions` reads a result as its reader does. Every number of a sentence is a figure of
its answer, or its value, as it would be rounded there; every verdict is that of the value and the
limit; what an answer states is what the result stores under another name; answers agree with each
other. A new sentence needs nothing here as long as its figures stand beside it.
"""

from __future__ import annotations

import math
import re
import sys
import time
import warnings
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from scipy.stats.mstats import hdquantiles

from thermogear import answers, load_case, run
from thermogear.base.arrays import Dataset
from thermogear.base.errors import InputError
from thermogear.base.limits import FINE, LOOK, OPEN, PARTING
from thermogear.base.materials import LUBRICANTS
from thermogear.base.units import RPM, ZERO_CELSIUS
from thermogear.results.answer import Answer
from thermogear.results.result import Result
from thermogear.views.write import page_of

SEED = 19_2026
PAGE = Path(__file__).parents[1] / "trials" / "records" / "answers.md"
GRID = "[grid]\npath_positions = 41\nmesh_positions = 48\nharmonics = 12\n"
"""Sentences do not know how fine a mesh is."""
NUMBER = re.compile(r"(?<![\w.^])[-−+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w.]*\d)")
NAMES = re.compile(
    r"ISO[/ A-Z]*\d+-\d+(?::\d+)?|L10|Bearing \S+|\[flanks\] seed = [\d, ]+|`[^`]*`|'[^']*'|"
    r"; allowed [^;]*|: got [^;]*"
)
"""Standards, names and what was refused: their numbers are no figures."""
UNSAID = re.compile(r"\b(nan|inf|none|-1)\b", re.IGNORECASE)
WHY_OPEN = re.compile(r"[Nn]ot decided|no [\w ]*known|has no tolerance|not steady by then")
SIGNS = ("backlash", "warm_up_backlash")
"""Answers whose limit is strict: a pair with no backlash left is no fine one."""
LOST = 1e-3
"""Share of time out of contact below which contact is kept."""


def contradictions(result: Result) -> Iterator[str]:
    """Every contradiction of a result with answers, in words; none where it holds."""
    answers = result.answers
    for one in answers:
        for why in (*_numbers(one), *_verdict(one), *_nothing_unsaid(one)):
            yield f"{one.name}{f' at {one.operating}' * bool(one.operating)}: {why}"
    for notice in result.notices:
        if UNSAID.search(NAMES.sub("", notice.text)):
            yield f"notice: {notice.text}"
    yield from _each_other(answers)
    if result.group("series") is not None:
        yield from _series(result)
    if result.group("speeds") is not None:
        yield from _speeds(result)
    if result.group("mesh") is not None:
        yield from _stored(result)


def with_figures(result: Result) -> int:
    """How many sentences of the answers have a figure."""
    return sum(bool(NUMBER.search(NAMES.sub("", one.sentence))) for one in result.answers)


def shown_as(text: str, value: float) -> bool:
    """Whether ``value`` may be written as ``text``: to its last place, or last figure but zeros."""
    number = float(text.replace("−", "-"))
    digits, _, power = text.lower().partition("e")
    places = len(digits.partition(".")[2])
    trailing = len(digits) - len(digits.rstrip("0")) if number and not places else 0
    # zeros at the end of a whole number may stand in for what was rounded away
    step = 10.0 ** (trailing - places + (int(power) if power else 0))
    step = min(step, 10.0 ** (math.floor(math.log10(abs(number))) - 1)) if trailing else step
    return abs(number - value) <= 0.5 * step * (1.0 + 1e-9) + 1e-12 * abs(value)


def _numbers(one: Answer) -> Iterator[str]:
    known = [] if one.value is None else [one.value, abs(one.value)]
    for figure in getattr(one, "figures", {}).values():
        known += [float(v) for v in np.ravel(figure)]
    for text in NUMBER.findall(NAMES.sub("", one.sentence)):
        if not any(shown_as(text, value) for value in known):
            yield f"{text} of '{one.sentence}' is no figure of it"


def _verdict(one: Answer) -> Iterator[str]:
    if one.verdict == OPEN:
        if not WHY_OPEN.search(one.sentence):
            yield f"not decided without a reason: '{one.sentence}'"
        return
    bound = re.search(r"at (least|most) ([-+.\de]+)", one.limit)
    if one.value is None or bound is None:
        if bound is None:
            yield f"{one.verdict} without a limit: {one.limit}"
        return
    limit, slack = float(bound[2]), 5e-4 * abs(float(bound[2]))  # four figures are shown
    side = one.value - limit if bound[1] == "least" else limit - one.value
    kept = side > 0.0 if one.name in SIGNS else side >= 0.0
    if abs(side) > slack and one.verdict != (FINE if kept else LOOK):
        yield f"{one.verdict} with {one.value:.6g} [{one.limit}]"


def _nothing_unsaid(one: Answer) -> Iterator[str]:
    if UNSAID.search(NAMES.sub("", one.sentence)):
        yield f"'{one.sentence}'"
    for name, figure in getattr(one, "figures", {}).items():
        # what a sentence leaves out, a figure may lack
        if not np.all(np.isfinite(np.ravel(figure))):
            yield f"figure {name} is {figure}"


def _each_other(answers: tuple[Answer, ...]) -> Iterator[str]:
    """What two answers, or two points of one, cannot both say."""
    by: dict[str, list[Answer]] = {}
    for one in answers:
        by.setdefault(one.name, []).append(one)
    factors = [one.value for one in by["dynamic_factor"] if one.value is not None]
    worst = max(factors, default=0.0)
    for name in ("dynamic_factor", "resonance"):
        if worst > PARTING and all(one.verdict == FINE for one in by[name]):
            yield f"{name} is fine beside a dynamic factor of {worst:.4g}"
    parted = by["contact_loss"][0]
    if worst > 1e3 and parted.verdict == FINE:
        yield f"contact is kept at a dynamic factor of {worst:.4g}"
    for gap, jam in zip(by["backlash"], by["jam_margin"], strict=True):
        left, margin = gap.value or 0.0, jam.value or 0.0
        beyond = {"jam", "borne"} <= jam.figures.keys()  # the teeth are hotter than they bear
        if abs(left) > 0.5 and abs(margin) > 0.5 and left * margin < 0.0 and not beyond:
            yield f"{left:.3g} um left beside a margin of {margin:.3g} K"


def _series(result: Result) -> Iterator[str]:
    """The answers of a series against what is stored of its parts."""
    data = result.group("series")
    assert data is not None
    for place in range(data.sizes["operating"]):
        yield from _series_at(result, data.isel(operating=place))


def _series_at(result: Result, data: Dataset) -> Iterator[str]:
    rpm, torque = float(data["own_speed"]) / RPM, float(data["pinion_torque"])
    at = ("", f"{rpm:.6g} rpm, {torque:.6g} N m")
    by = {one.name: one for one in result.answers if one.operating in at}
    onset = data["contact_loss_onset"].values[0] / RPM
    figures = by["contact_loss"].figures
    if "pairs" not in figures:
        return
    told = [figures["pairs"], figures.get("first", math.nan)]
    within = int((onset <= figures["top"] * (1.0 + 1e-9)).sum())
    stored = [within, float(np.nanmin(onset)) if np.isfinite(onset).any() else math.nan]
    if not np.allclose(told, stored, rtol=1e-9, equal_nan=True):
        yield f"contact_loss: {told} told, {stored} stored"
    error, factor = data["mesh_error"].values, data["own_dynamic_factor"].values[0]
    for name, prefix, values in (
        ("transmission_error", "mesh", 1e6 * error),
        ("dynamic_factor", "part", factor),
    ):
        figures, shares = by[name].figures, (0.05, 0.5, 0.95)
        names = [f"{prefix}_{which}" for which in ("low", "middle", "high")]
        stored = [float(value) for value in hdquantiles(values[np.isfinite(values)], shares)]
        if names[0] in figures and not np.allclose([figures[n] for n in names], stored):
            yield f"{name}: {[figures[n] for n in names]} told, {stored} stored"


def _speeds(result: Result) -> Iterator[str]:
    """The answers of the look over speeds against its stored motions."""
    data = result.group("speeds")
    assert data is not None
    rpm = data["pinion_speed"].values / RPM
    by = {one.name: one for one in result.answers}
    grid, place = np.unique(rpm, return_inverse=True)
    count = np.bincount(place, np.isfinite(data["contact_loss_share"].values))
    flags = {
        "contact_loss": np.unique(rpm[data["contact_loss_share"].values > LOST]),
        "back_contact": np.unique(rpm[data["mesh_force_min"].values < 0.0]),
        "coexisting": grid[count > 1],
    }
    for name, there in flags.items():
        figures = getattr(by[name], "figures", {})
        if not figures:
            continue
        looked = figures["looked"]
        if not np.allclose(looked, (grid[0], grid[-1]), rtol=1e-12):
            yield f"{name}: looked at {looked}, stored {grid[0]:.6g} to {grid[-1]:.6g}"
        hit = np.zeros(grid.size, bool)
        for low, high in figures["ranges"]:
            hit |= (grid >= low * (1.0 - 1e-9)) & (grid <= high * (1.0 + 1e-9))
        wrong = hit & ~np.isin(grid, there)
        left_out = (np.isin(grid, there) & ~hit).any() and figures["more"] == 0
        if wrong.any() or left_out:
            yield f"{name}: {figures['ranges']} are not the stored ranges"
    most = 100.0 * float(data["contact_loss_share"].max())
    figures = by["contact_loss"].figures
    if "most" in figures and not math.isclose(figures["most"], most):
        yield f"contact_loss: the greatest share is {most:.6g} %"
    figures = getattr(by["resonance"], "figures", {})
    for top, there in zip(figures.get("top", ()), figures.get("there", ()), strict=True):
        here = np.isclose(rpm, there, rtol=1e-9)
        if not math.isclose(float(np.nanmax(data["dynamic_factor"].values[here])), top):
            yield f"resonance: {top:.6g} at {there:.6g} rpm is not stored there"


def _mesh(name: str, of: Callable[[Any], float], scale: float = 1.0, less: float = 0.0) -> Any:
    return lambda mesh, path: scale * (of((mesh if name in mesh else path)[name].values) - less)


STORED: Mapping[tuple[str, str], Callable[[Any, Any], float]] = {
    ("backlash", ""): _mesh("least_half_backlash", float, 2e6),
    ("film", ""): _mesh("film_parameter", np.nanmin),
    ("transmission_error", ""): _mesh("transmission_error", np.ptp, 1e6),
    ("transmission_error", "hot"): _mesh("transmission_error", np.ptp, 1e6),
    ("tooth_temperature", "flash"): _mesh("flash_temperature", np.nanmax),
}
"""(answer, figure, the value where empty) -> the same from the stored groups of the hot state."""


def _stored(result: Result) -> Iterator[str]:
    """The answers of a run against its other groups, by its first bundle, hot."""
    groups = result.groups
    mesh, path = (groups[n].isel(bundle=0).sel(state="hot") for n in ("mesh", "path"))
    points = {
        f"{float(mesh['pinion_speed'].values[k]) / RPM:.6g} rpm, "
        f"{float(mesh['pinion_torque'].values[k]):.6g} N m": k
        for k in range(mesh.sizes["operating"])
    }
    for one in result.answers:
        place = points.get(one.operating, 0)
        here, along = mesh.isel(operating=place), path.isel(operating=place)
        for (name, figure), of in STORED.items():
            # a run stores one part beside the answers of a series
            if name != one.name or one.value is None or "parts" in one.figures:
                continue
            told = one.value if not figure else getattr(one, "figures", {}).get(figure)
            if told is not None and not math.isclose(told, of(here, along), rel_tol=1e-9):
                yield f"{name} {figure}: {told:.9g} told, {of(here, along):.9g} stored"
        if one.name == "jam_margin" and one.value is not None:
            jam = getattr(one, "figures", {}).get("jam")
            stored = float(here["jam_temperature"]) - ZERO_CELSIUS
            if jam is not None and not math.isclose(jam, stored, rel_tol=1e-9):
                yield f"jam_margin: {jam:.9g} told, {stored:.9g} stored"
    for name in ("least_half_backlash", "transmission_error", "mesh_stiffness"):
        fine = mesh["status"].values == 0
        if not np.isfinite(mesh[name].values[fine]).all():
            yield f"NaN in {name} of a point that is ok"


@dataclass
class Found:
    """What one case showed: counts, and its contradictions in words."""

    counts: Counter[str] = field(default_factory=Counter)
    notes: list[str] = field(default_factory=list)
    seconds: float = 0.0


def drawn_text(number: int, seed: int = SEED) -> str:
    """Case file ``number`` of the seed: what people state, and what they leave out."""
    rng = np.random.default_rng([seed, number])

    def spread(low: float, high: float) -> float:
        return float(np.exp(rng.uniform(np.log(low), np.log(high))))

    module, load, pace = spread(0.5, 20.0), spread(0.03, 15.0), spread(0.3, 60.0)
    teeth, shifts = rng.integers(12, 121, 2), rng.uniform(-0.3, 0.7, 2)
    width = module * float(rng.uniform(4.0, 15.0))
    torque = load * width * module * 0.5e-3 * module * float(teeth[0])
    rpm = pace / (0.5e-3 * module * float(teeth[0])) / RPM
    speeds = [rpm] if rng.random() < 0.8 else [rpm, rpm * float(rng.uniform(1.2, 3.0))]
    text = (
        f'[gears]\nmodule = "{module!r} mm"\nface_width = "{width!r} mm"\n'
        f'pressure_angle = "{float(rng.choice([20.0, 20.0, 17.5, 22.5, 25.0]))} deg"\n'
    )
    for name, z, x in zip(("pinion", "wheel"), teeth, shifts, strict=True):
        text += f"[gears.{name}]\nteeth = {z}\nprofile_shift = {float(x)!r}\n"
        if rng.random() < 0.2:
            text += (
                f'tip_relief = {{ amount = "{module * float(rng.uniform(0.5, 8.0))!r} um", '
                f'length = "{module * float(rng.uniform(0.1, 0.6))!r} mm" }}\n'
            )
        if rng.random() < 0.1:
            text += 'material = "POM"\n'
    if rng.random() < 0.7:
        text += f"[flanks]\naccuracy = {rng.integers(3, 11)}\nseed = {rng.integers(1, 100)}\n"
        text += "parts = 16\n" * (number % 4 == 0)
        text += 'edition = "1995"\n' * (rng.random() < 0.3)
    heat = float(rng.uniform(30.0, 130.0))
    text += f'[oil]\nname = "{sorted(LUBRICANTS)[int(rng.integers(len(LUBRICANTS)))]}"\n'
    given = rng.random()
    if given < 0.5:
        text += f'temperature = "{heat!r} degC"\n'
    if given < 0.2:
        bodies = heat + rng.uniform(-20.0, 40.0, 4)
        places = ("pinion_addendum", "pinion_bore", "wheel_addendum", "wheel_bore")
        text += "[temperatures]\n" + "".join(
            f'{place} = "{float(t)!r} degC"\n' for place, t in zip(places, bodies, strict=True)
        )
        text += f'housing = "{heat - 15.0!r} degC"\n'
    if rng.random() < 0.4:
        text += (
            f'[backlash]\nvalue = "{module * float(rng.uniform(0.01, 0.1))!r} mm"\n'
            'direction = "normal"\nextent = "total"\n'
        )
    if rng.random() < 0.5:
        text += f"[dynamics]\ndamping_ratio = {spread(0.01, 0.1)!r}\n"
    shown = ", ".join(f'"{speed!r} rpm"' for speed in speeds)
    return f'{text}[operating]\nspeed = [{shown}]\ntorque = "{torque!r} N m"\n{GRID}'


def answered(number: int, whole: bool = False, seed: int = SEED) -> Found:
    """One case through the answers, or the ``whole`` run: what its sentences contradict."""
    found = Found()
    began = time.perf_counter()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            result = (run if whole else answers)(load_case(drawn_text(number, seed)))
            page_of(result).lines()
            found.notes += contradictions(result)
        except InputError:
            found.counts["refused"] += 1
            return found
        except Exception as error:  # the trial counts every kind
            found.counts["exceptions"] += 1
            found.notes.append(f"{type(error).__name__}: {error}")
        else:
            found.counts["sentences"] += len(result.answers)
            found.counts["sentences with a figure"] += with_figures(result)
            found.counts.update(one.verdict for one in result.answers)
    found.counts["cases"] += 1
    found.counts["contradictions"] += len(found.notes)
    found.seconds = time.perf_counter() - began
    return found


HEAD = f"""# Trial of the answers


Made by `make trial NAME=answers` (seed {SEED}, fixed before the first run), which takes 300 cases
and
60 runs; the table says how many it holds. They are case files of 12 to 120 teeth, modules of 0.5 to
20 mm, profile shifts of -0.3 to 0.7, four pressure angles, classes 3 to 10 by both editions or
none, 0.03 to 15 N per mm of width and mm of module, 0.3 to 60 m/s, heat given, half given or
computed, backlash, damping, relief and plastics.

Each goes through the answers, some through a whole run. Counted as a contradiction: a number of
a sentence that is no figure beside it, a verdict against its limit, a figure that the stored
groups have otherwise, two answers that cannot both hold, a number that is none, any exception.
"""


def table(name: str, found: Sequence[Found]) -> list[str]:
    """The rows of the page for one command."""
    counts = sum((one.counts for one in found), Counter[str]())
    what = ("cases", "refused", "sentences", "sentences with a figure", FINE, LOOK, OPEN,
            "contradictions", "exceptions")  # fmt: skip
    return [f"| {name}: {one} | {counts[one]} |" for one in what]


def trial(whole: bool, wanted: int) -> Iterator[Found]:
    """So many cases that are not refused, in order."""
    number = left = 0
    while left < wanted:
        one = answered(number, whole)
        for note in one.notes:
            print(f"{'run' if whole else 'answers'} {number}: {note}", flush=True)
        yield one
        number, left = number + 1, left + one.counts["cases"]


def page(rows: Sequence[str]) -> str:
    """The text of trials/records/answers.md."""
    return "\n".join([HEAD, "| what | times |", "|---|---:|", *rows, ""])


def main(words: Sequence[str]) -> int:
    count, runs = (int(word) for word in words) if words else (300, 60)
    rows = []
    for name, whole, wanted in (("answers", False, count), ("run", True, runs)):
        rows += table(name, list(trial(whole, wanted)))
    print(page(rows))
    if not words:
        PAGE.write_text(page(rows), "utf-8")
    return int(any("contradictions | 0" not in row for row in rows if "contradictions" in row))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
