"""What is not a number never counts as settled: the mesh cycle, the closed loop, the warm-up."""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest

from thermogear import GearPair, MeshModel, Operating, mesh_cycle
from thermogear.base.errors import ConvergenceError, InputError
from thermogear.base.materials import lubricant
from thermogear.base.vocabulary import STATUS
from thermogear.gears import mesh_system
from thermogear.gears.deviations import Contacts
from thermogear.mesh import balance
from thermogear.mesh.balance import Gearbox, heat_balance
from thermogear.mesh.warm_up import Duty, warm_up

OIL = lubricant("M100")
TEXTBOOK = MeshModel.consistent().override(stiffness="textbook-30-degree", sharing="equal")
NAN = float("nan")
DUTY = Duty.steady(100.0, 100.0, ambient=293.15)


@dataclass(frozen=True)
class Broken:
    """A deviation that gives no numbers."""

    def gap(self, at: Contacts) -> np.ndarray:
        return np.full(at.s.shape, NAN)


def test_a_deviation_without_numbers_is_refused(rig: GearPair, hot_rig: Operating) -> None:
    why = r"^deviations\[0\]\.gap: got nan; .*; Broken gives it$"
    with pytest.raises(InputError, match=why):
        mesh_cycle(rig, hot_rig, deviations=[Broken()])
    with pytest.raises(InputError, match=why):
        heat_balance(rig, 100.0, 100.0, OIL, 125e-6, deviations=[Broken()])
    with pytest.raises(InputError, match=why):
        warm_up(rig, DUTY, OIL, 125e-6, deviations=[Broken()])


@pytest.fixture
def soft(monkeypatch: pytest.MonkeyPatch) -> None:
    """Teeth whose compliance is no number: the loaded contact cannot settle."""
    known = mesh_system.as_drawn

    def broken(*given: object) -> mesh_system.Drawn:
        drawn = known(*given)  # type: ignore[arg-type]
        return drawn._replace(tooth=NAN * drawn.tooth)

    monkeypatch.setattr(mesh_system, "as_drawn", broken)


@pytest.mark.usefixtures("soft")
def test_a_contact_that_does_not_settle_is_never_ok(rig: GearPair, hot_rig: Operating) -> None:
    found = mesh_cycle(rig, hot_rig, TEXTBOOK, path_positions=11, mesh_positions=16)
    assert np.isnan(found["rim_stiffness"].values).all()
    assert np.all(found["status"].values == STATUS.index("not_converged"))
    loaded = mesh_cycle(rig, hot_rig, path_positions=11, mesh_positions=16)
    assert np.all(loaded["status"].values == STATUS.index("not_converged"))
    assert np.isnan(loaded["contact_temperature"].values).all()
    assert not heat_balance(rig, 100.0, 100.0, OIL, 125e-6).settled.any()
    lost = r"^loaded contact: \d+ of \d+ (positions|operating points) did not settle"
    with pytest.raises(ConvergenceError, match=lost):
        warm_up(rig, DUTY, OIL, 125e-6)


def test_one_lost_point_costs_the_others_nothing(
    rig: GearPair, hot_rig: Operating, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = mesh_cycle(rig, hot_rig, path_positions=11, mesh_positions=16)
    known = mesh_system.MeshSystem.solve

    def loses_the_second(self, loads):  # type: ignore[no-untyped-def]
        force, delta, stiffness, settled = known(self, loads)
        for values in (force, delta, stiffness):
            values[1] = NAN
        settled[1] = False
        return force, delta, stiffness, settled

    monkeypatch.setattr(mesh_system.MeshSystem, "solve", loses_the_second)
    found = mesh_cycle(rig, hot_rig, path_positions=11, mesh_positions=16)
    assert [STATUS[i] for i in found["status"].values] == ["ok", "not_converged", "ok"]
    for name in ("mesh_stiffness", "contact_temperature", "load_share"):
        assert np.isnan(found[name].values[1]).all()
        assert np.array_equal(found[name].values[[0, 2]], whole[name].values[[0, 2]])
    assert np.all(np.isfinite(found["half_backlash"].values))


def test_temperatures_that_are_no_numbers_are_not_settled(
    rig: GearPair, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The second of three operating points loses its network; the others do not notice."""
    known = balance.thermal_network

    def broken(*given: object) -> object:
        network = known(*given)  # type: ignore[arg-type]
        steady = network.steady()
        lost = np.asarray(given[2]) == 200.0
        values = {n: np.where(lost, NAN, t) for n, t in steady.temperatures.items()}
        return SimpleNamespace(
            steady=lambda: type(steady)(values, steady.heat_out, steady.residual)
        )

    whole = heat_balance(rig, [100.0, 200.0, 300.0], 100.0, OIL, 125e-6, TEXTBOOK)
    monkeypatch.setattr(balance, "thermal_network", broken)
    found = heat_balance(rig, [100.0, 200.0, 300.0], 100.0, OIL, 125e-6, TEXTBOOK)
    assert whole.settled.all()
    assert found.settled.tolist() == [True, False, True]
    for place in (0, 2):
        assert found.operating.oil_temperature[place] == whole.operating.oil_temperature[place]


def test_measured_temperatures_and_times_must_be_numbers(rig: GearPair, hot_rig: Operating) -> None:
    with pytest.raises(InputError) as caught:
        Gearbox(measured={"oil": [330.0, NAN]})
    assert str(caught.value) == "gearbox.measured.oil: got nan K; allowed -70..600 degC"
    with pytest.raises(InputError, match=r"^tolerance: got nan K; allowed > 0 K$"):
        heat_balance(rig, 100.0, 100.0, OIL, 125e-6, TEXTBOOK, tolerance=NAN)
    with pytest.raises(InputError, match=r"^duty\.time: got 2 times; allowed two or more, rising"):
        Duty(time=np.array([0.0, NAN]), speed=np.ones(1), torque=np.ones(1), ambient=np.ones(1))
    for name in ("speed", "torque", "ambient"):
        given = {"speed": 100.0, "torque": 50.0, "ambient": 293.15} | {name: NAN}
        with pytest.raises(InputError, match=rf"^duty\.{name}: got nan "):
            Duty.steady(given["speed"], given["torque"], ambient=given["ambient"])
