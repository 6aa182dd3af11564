"""What the app shows of the rig is what the commands compute, and what was known before.

The figures known before are those of prototypes, which called an earlier state of the package
with the consistent models: 128 mesh positions for the mesh and the orbit, 64 for the run-up, 24
harmonics. They are held to the digits that were written down, at these numbers; the default of 240
mesh positions gives 40.1 µm, 4932.6 and 4370.4 rpm. What a closed socket leaves is in
``test_security.py``.
"""

from __future__ import annotations

import asyncio
import json
import threading
import time
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

pytest.importorskip("uvicorn")
pytest.importorskip("websockets")
from local_app import trial
from websockets.sync.client import connect

from thermogear.base.units import RPM
from thermogear.case.case import GearCase, gear_case, load_case
from thermogear.front.app import guard, parts, server
from thermogear.front.app.desk import Desk
from thermogear.front.app.given import Given
from thermogear.front.app.wire import Show
from thermogear.study import live
from thermogear.study.run import run
from thermogear.study.run_up import run_up
from thermogear.views.plots.live import told_mesh

pytestmark = [
    pytest.mark.slow,
    pytest.mark.filterwarnings("ignore::thermogear.base.errors.ValidityWarning"),
]
CONSISTENT = "model.bundle=consistent"


def rig(*changes: str) -> GearCase:
    return gear_case(load_case("rig", (CONSISTENT, *changes)))


def told(case: GearCase, **more: Any) -> list[dict[str, Any]]:
    """All that a page is told of a state."""
    found: list[dict[str, Any]] = []
    desk = Desk(Given("rig", case), lambda name, message: found.append(message))
    for _ in desk.show(Show(kind="show", number=1, **more), lambda: None):
        pass
    return found


def test_mesh_hot_and_jam_are_those_of_run() -> None:
    """Every number shown, to the last bit; the speed lets the gears grow by 0.04 µm here."""
    case = rig("grid.mesh_positions=128", "operating.speed=1000 rpm", "temperatures.row=",
               "simulation.periods=32", "simulation.sample_periods=2",
               "simulation.discard=50", "simulation.most_discarded=50")  # fmt: skip
    data, stored = live.mesh(case), run(case).group("mesh")
    assert stored is not None
    for name in (*live.MESH, "status", "mesh_phase"):
        one, other = data[name].values, stored[name].values.reshape(data[name].shape)
        assert np.array_equal(one, other, equal_nan=one.dtype.kind == "f"), name
    assert f"{data['mean_stiffness'].values[1]:.2e}" == "4.63e+08"
    assert f"{1e6 * data['half_backlash'].values[1]:.1f}" == "93.0"
    assert f"{data['jam_temperature'].values[1] - 273.15:.0f}" == "235"
    words = [one["lines"] for one in told(case, parts=["mesh"]) if one["kind"] == "part"]
    assert words == [told_mesh(data)]
    for figure in ("4.634·10⁸", "93.04"):
        assert figure in words[0][1]
    assert "234.5 °C" in words[0][2]


def test_the_orbit_at_4500_rpm() -> None:
    """From (1, 0): period 1, 39.8 µm peak to peak at 64 samples; 39.9 at 256."""
    case = rig("grid.mesh_positions=128", "operating.speed=4500 rpm", "operating.torque=100 N m")
    found = live.motion(live.point_of(case, (1.0, 0.0)))
    assert found.words.startswith("period-1")
    x = found.data["displacement"].values
    fine = 1e6 * np.ptp(x)
    coarse = 1e6 * np.ptp(x[:: x.size // 64])
    assert x.size == 256
    assert f"{coarse:.1f}" == "39.8"
    assert f"{fine:.1f}" == "39.9"


def test_the_run_up_jumps_where_the_command_says() -> None:
    """Up at 4931 and down at 4371 rpm with 64 mesh positions and 24 harmonics."""
    case = rig("grid.mesh_positions=64", "operating.speed=4500 rpm")
    speeds = RPM * np.linspace(4340.0, 4960.0, 32)
    for one in live.run_ups(case, speeds, "hot"):
        last = one
    mine = last.plan.finish(last.data)
    whole = run_up(case, speeds, temperatures=["hot"], branch_period=0).data
    jumps = {}
    for data in (mine, whole):
        jumps = {
            int(way): float(fold) / RPM
            for way, fold in zip(data["jump_direction"].values, data["jump_fold"].values,
                                 strict=True)
        }  # fmt: skip
        assert set(jumps) == {1, -1}
        assert jumps[1] == pytest.approx(4931.0, abs=0.5)
        assert jumps[-1] == pytest.approx(4371.0, abs=0.5)
    assert np.array_equal(mine["jump_fold"].values, whole["jump_fold"].values)


def test_the_period_doubles_at_7437_rpm() -> None:
    """On the run-up: one period at 7435, two at 7439 rpm."""
    case = rig("grid.mesh_positions=64")
    speeds = RPM * np.array([7426.0, 7435.0, 7439.0, 7448.0])
    for one in live.run_ups(case, speeds, "hot"):
        last = one
    assert last.arrays["end_period"][0, 0].tolist() == [1, 1, 2, 2]


class Here:
    """The server in a thread of this process, whose kernels are there."""

    def __init__(self) -> None:
        self.token, listening = guard.new_token(), server.bound(None, usual=0)
        self.host = f"127.0.0.1:{listening.getsockname()[1]}"
        self.app = server.App(Given("rig", rig("grid.mesh_positions=64")), self.token)
        self.server = server.server_of(self.app)
        work = self.server.serve(sockets=[listening])
        self.thread = threading.Thread(target=lambda: asyncio.run(work))
        self.thread.start()

    def talk(self) -> Any:
        address = f"ws://{self.host}/talk?token={self.token}"
        return connect(address, origin=f"http://{self.host}", max_size=None)  # type: ignore[arg-type]

    def end(self) -> None:
        self.server.should_exit = True
        self.thread.join(20.0)
        self.app.worker.join(20.0)
        assert not self.thread.is_alive()
        assert not self.app.worker.is_alive()


@pytest.fixture(scope="module")
def app() -> Iterator[Here]:
    one = Here()
    yield one
    one.end()


def test_a_refused_backlash_leaves_the_page_as_it_was(app: Here) -> None:
    """The line of the package, under its field; the next good value works."""
    with app.talk() as page:
        trial.heard(page, "hello")
        page.send(trial.show(1, parts=["mesh"], state={"dials": {"backlash": -1.0}}))
        said = trial.heard(page, "refused", "part")
        assert said["number"] == 1
        assert [row["field"] for row in said["rows"]] == ["backlash.value"]
        words = said["rows"][0]["words"]
        assert words.startswith("backlash.value: got '-1 mm'; allowed 1e-5..50 mm; ")
        page.send(trial.show(2, parts=["mesh"], state={"dials": {"backlash": 0.2}}))
        now, part = trial.heard(page, "now"), trial.heard(page, "part")
        assert {d["name"]: d["value"] for d in now["dials"]}["backlash"] == 0.2
        assert (part["number"], part["name"]) == (2, "mesh")
        assert trial.heard(page, "done")["number"] == 2


def test_ten_moves_in_600_milliseconds(app: Here) -> None:
    """The last answer belongs to the tenth; 3 run-ups begun at most, 1 finished."""
    speeds = {"low": 2000.0, "high": 3500.0, "count": 40}
    with app.talk() as page:
        trial.heard(page, "hello")
        for move in range(1, 11):
            state = {"dials": {"torque": 90.0 + move}}
            page.send(trial.show(move, parts=["mesh", "run-up"], speeds=speeds, state=state))
            time.sleep(0.06)
        heard = []
        while True:
            heard.append(json.loads(page.recv(timeout=trial.PATIENCE)))
            if (heard[-1]["kind"], heard[-1]["number"]) == ("done", 10):
                break
        begun = {m["number"] for m in heard if m.get("name") == "run-up"}
        assert 10 in begun
        assert len(begun) <= 3
        assert [m["number"] for m in heard if m["kind"] == "done"] == [10]
        assert heard[-1]["number"] == 10
        # nothing of an older move comes after one of a newer
        numbers = [m["number"] for m in heard]
        assert numbers == sorted(numbers)
        page.send(trial.show(11, parts=["run-up"], speeds=speeds,
                             state={"dials": {"torque": 100.0}}))  # fmt: skip
        # what hangs on nothing that was turned is not made anew
        kinds = []
        while kinds[-1:] != ["done"]:
            kinds.append(json.loads(page.recv(timeout=trial.PATIENCE))["kind"])
        assert "progress" not in kinds


def test_every_part_of_the_page_is_made(app: Here) -> None:
    """One after the other; none of a plain pair says that it could not."""
    names = [name for name in parts.MAKERS if name != "series"]
    speeds = {"low": 2000.0, "high": 3000.0, "count": 8}
    with app.talk() as page:
        trial.heard(page, "hello")
        page.send(trial.show(1, parts=names, speeds=speeds, state={"dials": {"speed": 2500.0}}))
        shown: dict[str, Any] = {}
        while (message := json.loads(page.recv(timeout=trial.PATIENCE)))["kind"] != "done":
            if message["kind"] == "part":
                shown[message["name"]] = message
        assert set(shown) == set(names)
        assert all(shown[name]["picture"] for name in ("mesh", "gap", "orbit", "run-up"))
        assert shown["gears"]["gears"]
        assert shown["answers"]["rows"]
        fault = "not computed"
        assert not any(fault in line for one in shown.values() for line in one["lines"])
