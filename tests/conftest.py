"""Shared fixtures: the rig of the thesis, and the notes of the validation page."""

from __future__ import annotations

import gc
import json
import os
import pickle
import platform
from collections import OrderedDict
from collections.abc import Callable, Generator
from functools import partial
from hashlib import sha256
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # as the command line does

import numpy as np
import pytest
from numpy.typing import ArrayLike, NDArray

from plain_numbers import told_as_text, told_in_csv
from thermogear import Gear, GearPair, Operating, Temperatures, __version__
from thermogear.base.materials import ZERO_CELSIUS, lubricant
from thermogear.results import files, tables

if TYPE_CHECKING:
    from thermogear.mesh.warm_up import WarmUp

COMPARED, AT_LENGTH = "compared", "at_length"
Compared = Callable[..., None]
AtLength = Callable[[int, int, str], int]


_as_json = files.json_text


def _plain(summary: dict[str, Any]) -> str:
    """What every command prints by --json and puts beside its pages: numbers are numbers."""
    assert not (found := list(told_as_text(summary))), found[:5]
    return _as_json(summary)


files.json_text = _plain


def _scanned(make: Callable[..., str]) -> Callable[..., str]:
    """A maker of CSV texts, all of which are looked through."""

    def made(*args: Any, **more: Any) -> str:
        text = make(*args, **more)
        assert not (found := list(told_in_csv(text))), found[:5]
        return text

    return made


tables.csv_text = _scanned(tables.csv_text)


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--validation",
        metavar="FILE",
        help="run the tests that compare with something known, and write what they saw to FILE",
    )
    parser.addoption(
        "--long",
        metavar="FILE",
        help="run the tests that are shortened, at length, and write what they took to FILE",
    )


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """No search for garbage among what collection makes: all of it stays to the end.

    The searches were a third of the processor time that collection took. Later ones went through
    all of it again, a tenth of all time.
    """
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.set_threshold(50_000, 20, 20)
        gc.enable()


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    for option, fixture in (("--validation", COMPARED), ("--long", AT_LENGTH)):
        if config.getoption(option):
            others = [item for item in items if fixture not in getattr(item, "fixturenames", ())]
            config.hook.pytest_deselected(items=others)
            items[:] = [item for item in items if item not in others]
    # one file is one worker's: the long ones first, so that no worker ends with one of them alone
    long = {item.path for item in items if item.get_closest_marker("slow")}
    items.sort(key=lambda item: item.path not in long)


class _Notes:
    """Gathers what the tests compared; in the process that holds the terminal alone."""

    def __init__(self, target: Path) -> None:
        self.target, self.entries = target, list[dict[str, Any]]()

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if report.when == "call" and report.passed:
            test = report.nodeid
            self.entries += [
                {"test": test, **note} for name, note in report.user_properties if name == COMPARED
            ]

    def pytest_sessionfinish(self, exitstatus: int) -> None:
        if exitstatus == 0:
            stored = {
                "thermogear": __version__,
                "python": platform.python_version(),
                **{name: version(name) for name in ("numpy", "scipy", "numba")},
                "entries": sorted(self.entries, key=lambda one: one["test"]),
            }
            text = json.dumps(stored, indent=1, ensure_ascii=False) + "\n"
            self.target.write_text(text, "utf-8")


class _Long:
    """The page of the tests that were run at length."""

    def __init__(self, target: Path) -> None:
        self.target, self.rows = target, list[str]()

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if report.when == "call" and report.passed:
            test = report.nodeid.removeprefix("tests/").replace("::", " ")
            for name, counts in report.user_properties:
                if name == AT_LENGTH:
                    usual, long, words = counts  # type: ignore[misc]
                    took = f"{report.duration:.0f}"
                    self.rows.append(f"| {words} | `{test}` | {usual} | {long} | {took} |")

    def pytest_sessionfinish(self, exitstatus: int) -> None:
        if exitstatus == 0:
            head = (
                "# Tests at length\n\n"
                "Made by `make trial NAME=long`: the same tests with the larger "
                "count, every claim and "
                "bound alike. All held.\n\n"
                "| of | test | count in `make test` | count here | took, s |\n"
                "|---|---|---:|---:|---:|\n"
            )
            self.target.write_text(head + "\n".join(sorted(self.rows)) + "\n", "utf-8")


def pytest_configure(config: pytest.Config) -> None:
    for option, notes in (("--validation", _Notes), ("--long", _Long)):
        target = config.getoption(option)
        if target and not hasattr(config, "workerinput"):
            config.pluginmanager.register(notes(Path(target)), f"notes of {option}")


@pytest.fixture
def compared(record_property: Callable[[str, object], None]) -> Compared:
    """``compared(what, against, differences, within, unit)``: assert, and note for the page.

    ``differences`` of any shape are taken by magnitude; the largest must stay ``within``. The
    unit is that of the difference, "1" for a relative or dimensionless one.
    """

    def compare(
        quantity: str, against: str, differences: ArrayLike, within: float, unit: str = "1"
    ) -> None:
        worst = float(np.max(np.abs(np.asarray(differences))))
        note = {"quantity": quantity, "against": against, "worst": worst}
        record_property(COMPARED, note | {"tolerance": float(within), "unit": unit})
        assert worst <= within, f"{quantity}: {worst:.3g} from {against}, allowed {within:.3g}"

    return compare


@pytest.fixture
def at_length(
    request: pytest.FixtureRequest, record_property: Callable[[str, object], None]
) -> AtLength:
    """``at_length(usual, long, words)``: how many a test tries; ``long`` with ``--long``."""

    def chosen(usual: int, long: int, words: str) -> int:
        record_property(AT_LENGTH, (usual, long, words))
        return long if request.config.getoption("--long") else usual

    return chosen


_DRAWN: dict[tuple[str, ...], bytes] = {}
"""What :func:`drawn_once` has drawn, of one test and of those before it."""
_SHOWN: set[tuple[str, object]] = set()
"""The traits of the pictures that were drawn, not told."""


@pytest.fixture
def drawn_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Pages and files draw a picture of every kind, and tell the others by their texts.

    Drawn is what has a mark, or a choice of one, that none before it had; the same data are taken
    again. For a test that asks what a page says, or whether a page made again is the same: its
    texts, tables and data are made again. That the same data draw the same is asked in ``views``.
    """
    from in_words import told
    from thermogear.views import drawing, page, write
    from thermogear.views.picture import Picture
    from traits import traits

    draw = drawing.image

    def once(picture: Picture, kind: str, *, salt: str = "", **how: Any) -> bytes:
        said = picture.to_json()
        key = json.dumps(said), kind, salt, repr(how)
        if key not in _DRAWN:
            found = {(kind, one) for one in traits(said)}
            make = draw if found - _SHOWN else told
            _DRAWN[key] = make(picture, kind, salt=salt, **how)
            _SHOWN.update(found)
        return _DRAWN[key]

    def of_a_kind(make: Callable[..., Any]) -> Callable[..., Any]:
        def made(*given: Any, **how: Any) -> Any:
            with pytest.MonkeyPatch.context() as patch:
                patch.setattr(drawing, "image", once)
                return make(*given, **how)

        return made

    monkeypatch.setattr(page, "draw", of_a_kind(page.draw))
    monkeypatch.setattr(write, "put_picture", of_a_kind(write.put_picture))


COMMANDS_AND_STUDIES = {"checks", "docs", "front", "study", "thesis"}
"""Folders of tests that ask what pages say; those of ``views`` ask how they are drawn."""


@pytest.fixture(autouse=True)
def _one_of_a_kind(request: pytest.FixtureRequest) -> None:
    """Pages of commands and studies draw a picture of every kind once: :func:`drawn_once`."""
    if request.path.parent.name in COMMANDS_AND_STUDIES:
        request.getfixturevalue("drawn_once")


_WARMED: dict[bytes, WarmUp] = {}
"""What :func:`warmed_once` has computed, by all that it was asked with."""


@pytest.fixture
def warmed_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """The answers compute a pair's way from cold to steady once for the same numbers.

    For a test of what is said or shown of it: sentences and verdicts are made each time.
    """
    from thermogear.mesh.warm_up import warm_up
    from thermogear.study.answers import asked

    def once(*given: Any, **settings: Any) -> WarmUp:
        key = pickle.dumps((given, settings))
        if key not in _WARMED:
            _WARMED[key] = warm_up(*given, **settings)
        return _WARMED[key]

    monkeypatch.setattr(asked, "warm_up", once)


_LOOKED: OrderedDict[tuple[str, bytes], Any] = OrderedDict()
"""What :func:`looked_once` has found, by the function and the samples; the last 32."""


@pytest.fixture
def looked_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """A record's tracked line is looked for once for the same samples.

    For a test that measures one record with several options: it is a function of the samples alone.
    A test that calls it itself has it anew.
    """
    from thermogear.measured import changing

    def once(look: Callable[[NDArray[np.float64]], Any], table: NDArray[np.float64]) -> Any:
        key = look.__name__, sha256(f"{table.shape}".encode() + table.tobytes()).digest()
        if key not in _LOOKED:
            _LOOKED[key] = look(table)
        if len(_LOOKED) > 32:
            _LOOKED.popitem(last=False)
        return _LOOKED[key]

    monkeypatch.setattr(changing, "tracked_shaft", partial(once, changing.tracked_shaft))


@pytest.fixture(scope="session")
def rig() -> GearPair:
    """Module 5 mm, 25:75, face width 25 mm, bore radii 25/80 mm."""
    return GearPair(
        Gear(25, 5e-3, face_width=25e-3, bore_radius=25e-3),
        Gear(75, 5e-3, face_width=25e-3, bore_radius=80e-3),
    )


def celsius(value: float) -> float:
    """Kelvin."""
    return value + ZERO_CELSIUS


@pytest.fixture(scope="session")
def hot_rig() -> Operating:
    """1000, 2000, 3000 rpm at 100 N m; addenda 140 C, bores 120 C, housing 100 C, T0 20 C.

    Grown by heat alone, so that laws of heat hold to the last bit.
    """
    return Operating(
        speed=np.array([1000.0, 2000.0, 3000.0]) * np.pi / 30.0,
        torque=np.array(100.0),
        lubricant=lubricant("M100"),
        oil_temperature=celsius(100.0),
        temperatures=Temperatures(
            reference=celsius(20),
            pinion_addendum=celsius(140),
            pinion_bore=celsius(120),
            wheel_addendum=celsius(140),
            wheel_bore=celsius(120),
            housing=celsius(100),
        ),
        half_backlash=125e-6,
        pulled=0.0,
    )
