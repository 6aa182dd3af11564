"""Detection of faults: meshes, averages, limits and counts against other ways to them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from scipy import stats

from thermogear.base.errors import InputError
from thermogear.base.plan import empty_arrays, keep_going
from thermogear.case.case import GearCase, gear_case, load_case
from thermogear.front.cli import main
from thermogear.mesh.elastic import TURN_POSITIONS
from thermogear.mesh.series import changed_mesh, series_mesh
from thermogear.signals.synchronous import synchronous_averages
from thermogear.study import detection, faults
from thermogear.study.detection import DetectionPlan, against, detected, detection_plan
from thermogear.study.faults import fault_motions
from thermogear.views.pages import PAGES

TEXT = """
[gears]
module = "3 mm"
face_width = "20 mm"
[gears.pinion]
teeth = 14
profile_shift = 0.3
[gears.wheel]
teeth = 21
[flanks]
accuracy = 6
seed = 1
[oil]
temperature = "60 degC"
[operating]
speed = "1500 rpm"
torque = "80 N m"
[temperatures]
pinion_addendum = "70 degC"
wheel_addendum = "60 degC"
pinion_bore_below_addendum = "0 K"
wheel_bore_below_addendum = "0 K"
housing_below_addendum = "0 K"
"""
FAULTS = (
    'kind = "crack"\ngear = "pinion"\ntooth = 3\ndepth = "1 mm"\nangle = "60 deg"',
    'kind = "chip"\ngear = "wheel"\ntooth = 1\nheight = "1 mm"',
    'kind = "missing"\ngear = "wheel"\ntooth = 21',
    'kind = "spall"\ngear = "pinion"\ntooth = 14\nlength = "1.5 mm"\ndepth = "0.1 mm"',
    'kind = "pitch"\ngear = "wheel"\ntooth = 9\namount = "30 um"',
    'kind = "wear"\ngear = "pinion"\ntooth = 5\ndepth = "20 um"',
    'kind = "eccentricity"\ngear = "pinion"\namount = "10 um"',
)
HOT, COLD = 0, 1


def case_of(*faults: str, more: str = "") -> GearCase:
    return gear_case(load_case(TEXT + more + "".join(f"[[faults]]\n{one}\n" for one in faults)))


@pytest.fixture(scope="module")
def plan() -> DetectionPlan:
    return replace(detection_plan(case_of(*FAULTS), parts=8), healthy=10)


def test_a_fault_is_solved_where_it_acts_as_over_the_whole_turn(plan: DetectionPlan) -> None:
    hot, _ = plan._scenes[HOT, 0, 1]
    sound = series_mesh(hot, plan.series[0][:1], plan.turn, positions=32)
    for number, (fault, _) in enumerate(plan.variants[2:], start=1):
        assert fault is not None
        periods = plan._acting(fault)
        assert periods.size < plan.turn or fault.kind == "eccentricity"
        parts = plan.series[number][:1]
        whole = series_mesh(hot, parts, plan.turn, positions=32)
        some = changed_mesh(sound, hot, parts, periods)
        swing = np.ptp(whole.spring_error)
        off = some.spring_error - whole.spring_error
        # where one flank has corners contact is searched for in another way on all of them
        bound = 1e-3 if fault.kind in ("spall", "wear") else 1e-7
        assert np.ptp(off, axis=1).max() < bound * swing, fault.kind
        assert some.stiffness == pytest.approx(whole.stiffness, rel=bound)
        assert some.half_backlash == pytest.approx(whole.half_backlash, rel=bound)


def test_averages_are_those_of_both_motions_side_by_side(
    plan: DetectionPlan, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The door of one pair: every contact of the turn solved again for it alone.

    At the positions and with the harmonics of a series, which are those at every speed.
    """
    monkeypatch.setattr(faults, "MOST_DOUBLINGS", 0)
    hot, excited = plan._scenes[COLD, 0, 1]
    sound = series_mesh(hot, plan.series[0][1:2], plan.turn)
    for number in (3, 7, 15):
        fault, gear = plan.variants[number + 1]
        assert fault is not None
        mesh = changed_mesh(sound, hot, plan.series[number][1:2], plan._acting(fault))
        own = plan._averages(plan._motions(excited, mesh)[1], gear)[0]
        file = plan.case.file.model_copy(update={"faults": (fault,)})
        case = replace(plan.case, file=file, mesh_positions=TURN_POSITIONS)
        both = fault_motions(
            case, plan.speeds[0], plan.torques[1], part=1, state="undeformed", samples=64
        )[0]
        turn = 64 * plan.teeth[gear]
        count = both.faulty.acceleration.size // turn
        for place, name in enumerate(("acceleration", "mesh_force")):
            curve = getattr(both.faulty, name)
            mean = synchronous_averages(curve, samples_per_turn=turn, turns=count)[0]
            error = np.std(own[place] - mean) / np.std(mean)
            print(f"{fault.kind}, {name}: {error:.1e}")
            assert error < 1e-4


def test_noise_of_an_average_and_its_streams(plan: DetectionPlan) -> None:
    none = np.zeros((2, 2, 64 * 14))
    rows = plan._noisy(none, 0, range(3, 5), 400)
    scale = plan.level / np.sqrt(plan.averaged[0])
    assert rows.std(axis=(0, 1, 3)) == pytest.approx(scale, rel=0.01)
    assert np.array_equal(rows, plan._noisy(none, 0, range(3, 5), 400))
    assert np.array_equal(rows[1:], plan._noisy(none[1:], 0, range(4, 5), 400))
    assert not np.array_equal(rows[0], plan._noisy(none, 0, range(3, 5), 400, 1)[0])
    z1, z2 = plan.teeth
    assert plan.averaged[0] * z1 == plan.averaged[1] * z2
    assert plan.averaged[0] % (plan.turn // z1) == 0


def test_the_greatest_of_59_bounds_the_false_alarms() -> None:
    """Wilks: P(share beyond > 5 %) = .95^59 = 4.9 %, of a heavy tail and of a light one."""
    drawn = np.random.default_rng(31)
    for law in (stats.norm, stats.lognorm(1.5), stats.expon):
        healthy = law.rvs(size=(2000, 59), random_state=drawn)
        beyond, _ = against(np.full(2000, np.inf), healthy=healthy, axis=1)
        assert beyond.all()
        often = np.mean(law.sf(healthy.max(axis=1)) > 0.05)
        print(f"{often:.3f}")
        assert abs(often - 0.95**59) < 4.0 * np.sqrt(0.05 / 2000)
    values, healthy = np.array([[1.0, 4.0]]), np.array([[[0.0, 1.0], [2.0, np.nan], [1.0, 3.0]]])
    beyond, shift = against(values, healthy=healthy, axis=1)
    assert beyond.tolist() == [[0.0, 1.0]]
    assert shift.tolist() == [[0.0, pytest.approx(np.sqrt(2.0))]]


def test_counts_are_those_that_were_put_in(plan: DetectionPlan) -> None:
    """Every healthy value 0 to 1, so many faulty ones 2: shares and intervals as scipy has them."""
    small = replace(plan, families=plan.families[4:5])
    empty = empty_arrays(small)
    data = xr.Dataset({name: (one.dims, empty[name]) for name, one in small.variables().items()})
    drawn = np.random.default_rng(5)
    value = drawn.uniform(size=data["value"].shape)
    seen = (0, 0, 3, 6, 8)  # none in both gears' averages, and three sizes
    for variant, count in enumerate(seen):
        if variant > 1:
            value[:, :, :, :count, variant], value[:, :, :, count:, variant] = 2.0, 0.0
    loud = np.full(data["loudest"].shape, small.entry(plan.families[4][0]))
    loud[:, :, :, 5:] += 2
    loud[:, :, :, 4] -= 1
    loud[:, :, :, 3] = -1
    put = data.assign(
        value=(data["value"].dims, value), loudest=(data["loudest"].dims, loud),
        own_beyond=(data["own_beyond"].dims, value > 1.0), own_shift=(data["value"].dims, value),
    )  # fmt: skip
    found = detected(small, put)
    for variant, count in enumerate(seen[2:], start=2):
        for question in (0, 1):
            here = (question, 0, 0, 0, variant, 0)
            assert (found["detected"][here][:-1] == count).all()
            test = stats.binomtest(count, 8)
            interval = test.proportion_ci(0.95 if count < 8 else 0.90)
            assert found["detected_low"][here][0] == pytest.approx(interval.low)
            assert found["detected"][here][-1] == 4
            assert found["judged"][here][-1] == 7
    assert found["judged"][..., :2, :, -1].max() == 0
    # of healthy parts one is the greatest of all
    assert found["detected"][1, :, :, :, :2, :, :-2].max() == 1
    # any of them: as many parts as hold the greatest of an indicator, counted part by part
    healthy = value[0, 0, 0, :, 0, 0]
    holders = {int(part) for part in healthy.argmax(axis=0) if part < 8}
    assert found["detected"][1, 0, 0, 0, 0, 0, -2] == len(holders) > 1
    assert found["shift"][0, 0, 0, 0, 4, 0, 0] == 2.0


def test_a_pair_that_jams_has_a_status_and_no_share() -> None:
    tight = '[backlash]\nvalue = "2 um"\ndirection = "normal"\nextent = "total"\n'
    plan = replace(detection_plan(case_of(FAULTS[0], more=tight), parts=8), healthy=8)
    arrays = plan.compute((HOT, 0, 0, 0), None, keep_going)
    assert set(arrays["status"].ravel().tolist()) == {1}
    assert np.isnan(arrays["value"]).all()
    assert (arrays["loudest"] == -1).all()


def test_the_command_its_page_and_its_store(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(detection, "HEALTHY", 10)
    monkeypatch.setattr(DetectionPlan, "__init__", _few(DetectionPlan.__init__))
    file, out = tmp_path / "own.toml", tmp_path / "out"
    text = TEXT.replace('torque = "80 N m"', 'torque = ["60 N m", "80 N m"]')
    file.write_text(text + f"[[faults]]\n{FAULTS[4]}\n", encoding="utf-8")
    assert main(["detect", str(file), "-o", str(out), "--parts", "8"]) == 0
    told = capsys.readouterr().out
    assert "none" not in told.split("compared with")[0]
    assert " 15 " in told
    assert "faults =" not in (out / "report.html").read_text(encoding="utf-8").split("<h2")[0]
    assert (out / "detect_shares.svg").exists()
    assert list(out.glob("detect*.csv"))
    assert main(["detect", str(file), "-o", str(out), "--parts", "8", "--json"]) == 0
    assert '"smallest"' in capsys.readouterr().out
    assert "detect" in PAGES


def _few(init: object) -> object:
    """Ten healthy parts in place of sixty."""

    def made(self: DetectionPlan, **given: object) -> None:
        init(self, **{"healthy": 10, **given})  # type: ignore[operator]

    return made


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (["--parts", "3"], "parts: got 3; allowed 8..60"),
        (["--noise", "-1"], "noise: got -1.0; allowed 0.0..100.0"),
        (["--turns", "0"], "turns: got 0; allowed 1..100000"),
        (["--set", "model.stiffness=textbook-30-degree"], "model.stiffness: got textbook"),
        (["--set", "operating.speed=600 rpm"], "operating.speed: got 600 rpm; the natural freq"),
    ],
)
def test_what_cannot_be_asked_is_one_line(
    options: list[str], told: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "own.toml"
    file.write_text(TEXT, encoding="utf-8")
    assert main(["detect", str(file), "-o", str(tmp_path / "out"), *options]) == 2
    error = capsys.readouterr().err.strip().splitlines()
    assert told in error[-1]
    with pytest.raises(InputError):
        detection_plan(case_of(), parts=3)
