"""A state, the command that is printed for it, and the file that is saved: the same case."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("uvicorn")

from thermogear.base.errors import InputError
from thermogear.case.case import GearCase, gear_case, load_case
from thermogear.case.examples import example_text
from thermogear.front.app.desk import Desk, hello
from thermogear.front.app.given import MOST, Given
from thermogear.front.app.wire import Export, State

pytestmark = pytest.mark.filterwarnings("ignore::thermogear.base.errors.ValidityWarning")
LONE = ("temperatures.pinion_addendum", "temperatures.wheel_addendum")
BELOW = tuple(
    f"temperatures.{one}_below_addendum" for one in ("pinion_bore", "wheel_bore", "housing")
)
COMPUTED = tuple((one, "") for one in (*LONE, *BELOW, "oil.temperature_below_addendum"))
STATES: dict[str, dict[str, Any]] = {
    "nothing turned": {},
    "a dial": {"dials": {"speed": 4321.987654321}},
    "all dials": {"dials": {"speed": 4500.0, "torque": 81.5, "gears": 133.25, "housing": 31.5,
                            "backlash": 0.2113, "damping": 0.0512, "error": 3.75}},
    "fields": {"changes": (("title", "it's \"mine\" $HOME; rm -rf `x`"), ("gears.module", "4 mm"),
                           ("gears.pinion.tip_diameter", ""), ("gears.wheel.tip_diameter", ""),
                           ("gears.wheel.bore_radius", "70 mm"),
                           ("operating.speed", '["900 rpm", "4000 rpm"]'))},
    "fields and dials": {"changes": (("dynamics.damping_ratio", "0.09"),
                                     ("oil.name", "ISO VG 220")), "dials": {"error": 1.0}},
    "heat on": {"heat": True, "dials": {"speed": 2500.0, "torque": 150.0}},
    "computed, then held": {"changes": COMPUTED, "heat": False, "dials": {"gears": 95.0}},
}  # fmt: skip


def same(one: GearCase, other: GearCase) -> bool:
    """What they compute with, to the last bit, and what they say of themselves."""
    assert one.data == other.data
    for name in ("speeds", "torques", "title", "simulation", "damping_ratio", "computed"):
        assert getattr(one, name) == getattr(other, name), name
    bodies = ("pinion_addendum", "wheel_addendum", "pinion_bore", "wheel_bore", "housing")
    temperatures = [case.operating_of(case.models[0]).temperatures for case in (one, other)]
    for body in bodies:
        assert np.array_equal(*(np.asarray(getattr(t, body)) for t in temperatures)), body
    return True


def read(command: str) -> GearCase:
    """The case of a printed command, as a shell and ``thermogear run`` would read it."""
    words = shlex.split(command)
    assert words[:2] == ["thermogear", "run"]
    assert words[-2:] == ["-o", "results"]
    said = words[3:-2]
    assert said[::2] == ["--set"] * (len(said) // 2)
    return gear_case(load_case(Path(words[2]), said[1::2]))


FILES = ("rig", "a file of one's own, with --set")


@pytest.fixture(params=FILES)
def given(request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Given:
    monkeypatch.chdir(tmp_path)
    if request.param == "rig":
        return Given("rig", gear_case(load_case("rig")))
    text = example_text("rig").replace("damping_ratio = 0.07", "damping_ratio = 0.06")
    Path("my gears.toml").write_text(text, "utf-8")
    changes = ("gears.pinion.face_width=23 mm", "grid.mesh_positions=128", "draw=")
    return Given("my gears.toml", gear_case(load_case(Path("my gears.toml"), changes)))


# a heat balance is long, and the same for every file: of the rig's alone
@pytest.mark.parametrize(
    ("given", "words"),
    [(f, w) for f in FILES for w in STATES if f == "rig" or "heat" not in STATES[w]],
    indirect=["given"],
)
def test_command_and_saved_file_give_the_same_case(given: Given, words: str) -> None:
    state = State(**STATES[words])
    case = given.at(state)
    assert same(read(given.command(case)), case)
    if words == "nothing turned":
        assert case is given.case
    if "speed" in state.dials:
        assert case.speeds[0] == pytest.approx(state.dials["speed"] * np.pi / 30.0, rel=1e-12)
    desk = Desk(given, lambda name, message: None)
    export = Export(kind="export", number=1, what="case", state=state)
    told = desk.export(export, lambda: None)
    Path(str(told["name"])).write_text(str(told["text"]), "utf-8")
    assert same(gear_case(load_case(Path(str(told["name"])))), case)
    command = desk.export(export.model_copy(update={"what": "command"}), lambda: None)
    assert command["text"] == given.command(case) + "\n"


def test_what_only_the_page_put_in_can_be_left_out_again() -> None:
    """The command names no field to leave out that the file does not hold."""
    given = Given("rig", gear_case(load_case("rig", ["dynamics.damping_ratio=0.05"])))
    none = State(changes=(("model.bore", ""), ("dynamics.damping_ratio", "0.05")))
    assert given.at(none).overrides == given.case.overrides
    own = State(changes=(("temperatures.housing", "60 degC"), (BELOW[2], "")), heat=True)
    case = given.at(own)
    assert ("temperatures.housing", "") not in case.overrides
    assert case.computed
    assert same(read(given.command(case)), case)


def test_what_the_command_line_left_out_can_be_put_back() -> None:
    given = Given("rig", gear_case(load_case("rig", ["draw="])))
    assert "draw" not in given.case.data
    back = given.at(State(changes=(("draw.pictures", '["path"]'),)))
    assert back.data["draw"] == {"pictures": ["path"]}


@pytest.mark.parametrize("path", MOST)
def test_more_work_than_an_app_may_do_is_refused(path: str) -> None:
    """But never what the file itself asks for."""
    given = Given("rig", gear_case(load_case("rig")))
    most = MOST[path]
    more = [(path, str(most + 1))]
    if path == "grid.harmonics":
        more.append(("grid.mesh_positions", "1024"))
    if path == "simulation.discard":
        more.append(("simulation.most_discarded", str(most + 1)))
    if path == "simulation.periods":
        more.append(("simulation.samples", "8"))
    with pytest.raises(InputError) as caught:
        given.at(State(changes=tuple(more)))
    assert caught.value.field in dict(more)
    assert f"..{most} in the app" in str(caught.value)
    own = Given("rig", gear_case(load_case("rig", [f"{p}={t}" for p, t in more])))
    assert own.at(State(dials={"speed": 3000.0})).speeds[0] == pytest.approx(100.0 * np.pi)


def test_memory_beyond_reason_is_refused() -> None:
    given = Given("rig", gear_case(load_case("rig")))
    with pytest.raises(InputError, match="GiB in the app"):
        given.at(State(changes=(("simulation.periods", "65536"), ("simulation.samples", "4096"))))


def test_a_page_opens_no_files(tmp_path: Path) -> None:
    there = tmp_path / "chart.csv"
    there.write_text("secret", "utf-8")
    given = Given("rig", gear_case(load_case("rig")))
    for text in (str(there), f'["{there}"]', "/dev/zero", "../chart.csv"):
        with pytest.raises(InputError) as caught:
            given.at(State(changes=(("flanks.pinion", text),)))
        assert caught.value.field == "flanks.pinion"
        assert "a page opens no files" in str(caught.value)
        assert "secret" not in str(caught.value)


@pytest.mark.parametrize(
    "name", ["rig", "fzg-a", "nasa-spur", "bgu-17-38", "loaded-27-35", "pom-steel", "motor-train"]
)
def test_a_page_opens_on_every_ready_made_pair(name: str) -> None:
    """Its range of speeds holds the case's own and the resonance."""
    case = gear_case(load_case(name))
    told = hello(Given(name, case))
    speeds = told["speeds"]
    assert isinstance(speeds, dict)
    assert 0.1 <= speeds["low"] <= min(case.speeds) * 30.0 / np.pi
    assert max(case.speeds) * 30.0 / np.pi <= speeds["high"] <= 500_000.0


def test_a_page_opens_on_jammed_gears() -> None:
    hot = [f"{one}=300 degC" for one in LONE]
    assert hello(Given("rig", gear_case(load_case("rig", hot))))["kind"] == "hello"
