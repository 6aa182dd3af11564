"""What a dial shows is what the commands store: gap, motion and run-up, bit for bit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats.mstats import hdquantiles

from own_pair import OWN_PAIR
from thermogear.base.errors import ThermogearError
from thermogear.base.plan import Stopped
from thermogear.base.units import RPM
from thermogear.base.vocabulary import STATUS
from thermogear.case.case import GearCase, gear_case, load_case
from thermogear.case.dials import dials, turned
from thermogear.case.family import GearFamily
from thermogear.case.one_point import of_case
from thermogear.study import live
from thermogear.study.orbit import orbit_results
from thermogear.study.run_up import run_up
from thermogear.study.series import series_parts

pytestmark = pytest.mark.filterwarnings("ignore::thermogear.base.errors.ValidityWarning")
RNG = np.random.default_rng(2041)


def case_of(source: str, *changes: str) -> GearCase:
    return gear_case(load_case(source, changes))


def again(case: GearCase, *changes: str) -> GearCase:
    """The same with more changes."""
    return case_of(case.text, *(f"{path}={text}" for path, text in case.overrides), *changes)


def drawn(rng: np.random.Generator) -> GearCase:
    """A pair of nobody's, shifted, with an error of several harmonics."""
    z, w = int(rng.integers(19, 30)), int(rng.integers(35, 60))
    shift = float(np.round(rng.uniform(0.0, 0.3), 3))
    error = ", ".join(
        f'{{ order = {k}, amplitude = "{a:.3g} um", phase = "{p:.3g} rad" }}'
        for k, a, p in zip((1, 2, 3), rng.uniform(1, 6, 3), rng.uniform(0, 3, 3), strict=True)
    )
    return case_of(
        OWN_PAIR, f"gears.pinion.teeth={z}", f"gears.wheel.teeth={w}",
        f"gears.pinion.profile_shift={shift}", f"transmission_error.harmonics=[{error}]",
        f"operating.torque={rng.uniform(40, 120):.4g} N m",
        "temperatures.wheel_addendum=90 degC",
        f"dynamics.damping_ratio={rng.uniform(0.07, 0.12):.3g}", "grid.mesh_positions=64",
    )  # fmt: skip


@pytest.fixture(scope="module")
def own() -> GearCase:
    return case_of(OWN_PAIR, "grid.mesh_positions=50", "operating.speed=3100 rpm")


def test_the_gap_is_the_backlash_at_each_temperature(own: GearCase) -> None:
    """Drawn temperatures alone; the drawing's own gives the cold gap; the jam leaves none."""
    data = live.gap(own)
    assert data is not None
    at, gap = data["gear_temperature"].values, data["half_backlash"].values
    family = GearFamily(own, ("gear_temperature",))
    for place in RNG.choice(at.size, 4, replace=False):
        alone = family.quasi_static(at[[place]][:, None], ("half_backlash",))["half_backlash"]
        assert alone[0] == pytest.approx(gap[place], rel=1e-12)
    cold = float(np.ravel(own.stated.half_backlash)[0])
    assert at[0] == own.stated.temperatures.reference
    drawn = family.quasi_static(at[:1, None], ("half_backlash_by_speed",))
    lost = float(drawn["half_backlash_by_speed"][0])
    # as drawn but for what the speed pulls the gears outward by, nearly alike over the mesh
    assert lost < 0.0
    assert gap[0] - lost == pytest.approx(cold, abs=0.3 * abs(lost))
    # both gears, bores too, so much hotter, the housing as it is: the least gap is gone
    rise = data.attrs["jam_temperature"] - data.attrs["hot_temperature"]
    bodies = {"pinion_addendum": 90.0, "wheel_addendum": 85.0, "pinion_bore": 75.0,
              "wheel_bore": 75.0}  # fmt: skip
    jammed = again(own, *(f"temperatures.{n}={t + rise!r} degC" for n, t in bodies.items()))
    least = GearFamily(jammed, ()).quasi_static(np.empty((1, 0)), ("least_half_backlash",))
    assert abs(least["least_half_backlash"][0]) < 1e-3 * cold


def test_a_motion_is_what_orbit_tells(own: GearCase) -> None:
    point = live.point_of(own)
    found, told = live.motion(point), orbit_results(live.point_of(own)).group("orbit")
    assert told is not None
    assert set(found.data.variables) == set(told.variables)
    for name in told.variables:
        one, other = found.data[name].values, told[name].values
        assert np.array_equal(one, other, equal_nan=one.dtype.kind == "f"), name
    assert found.words.startswith("period-1")


@pytest.mark.slow
def test_a_motion_that_does_not_close_is_a_cloud() -> None:
    """Rig without damping at 7000 rpm: chaotic; the section lies on the curve at phase 0."""
    case = case_of(
        "rig", "dynamics.damping_ratio=0", "operating.speed=7000 rpm", "grid.mesh_positions=64",
        "model.bundle=consistent", "simulation.most_discarded=400",
    )  # fmt: skip
    found = live.motion(live.point_of(case))
    assert found.orbit is None
    assert "chaotic" in found.words or "undecided" in found.words
    data = found.data
    assert data.sizes["sample"] == live.SHOWN * live.SAMPLES
    assert data.sizes["section"] == live.CLOUD
    for name in ("displacement", "velocity"):
        marks = data[name].values[:: live.SAMPLES]
        section = data[f"section_{name}"].values
        size = np.ptp(data[name].values)
        nearest = np.abs(section[:, None] - marks[None, :]).min(axis=0)
        assert nearest.max() < 1e-6 * size


@pytest.fixture(scope="module", params=["hot", "undeformed"])
def ran(request: pytest.FixtureRequest) -> tuple[GearCase, str, list[live.LiveRunUp], list[int]]:
    state = str(request.param)
    case = drawn(np.random.default_rng([77, len(state)]))
    rate = float(GearFamily(case, ())(np.empty((1, 0))).rate[0]) / case.pair.pinion.teeth
    speeds = np.linspace(0.68 * rate, 0.88 * rate, 4 * live.COARSE + 2)
    steps: list[live.LiveRunUp] = []
    done = []
    for one in live.run_ups(case, speeds, state):
        done.append(one.done)
        if not steps or steps[-1] is not one:
            steps.append(one)
    return case, state, steps, done


@pytest.mark.slow
def test_a_whole_run_up_is_that_of_the_command(ran) -> None:  # type: ignore[no-untyped-def]
    """Every array, to the last bit, of two drawn pairs, whatever the blocks; coarse before fine."""
    case, state, (coarse, fine), done = ran
    assert (coarse.preview, fine.preview) == (True, False)
    assert coarse.done == coarse.total < fine.done == fine.total
    assert done[-1] == fine.total
    whole = run_up(case, np.array(fine.plan.speeds), temperatures=[state], branch_period=0).data
    mine = fine.plan.finish(fine.data)
    assert set(fine.plan.variables()) <= set(whole.variables)
    for name in mine.variables:
        one, other = mine[name].values, whole[name].values
        assert one.dtype == other.dtype, name
        assert np.array_equal(one, other, equal_nan=one.dtype.kind == "f"), name
    assert np.isfinite(mine["dte_peak_to_peak"].values).all()


@pytest.mark.slow
def test_the_end_at_a_speed_is_a_state_of_its_motion(ran) -> None:  # type: ignore[no-untyped-def]
    """A motion begun there closes on the very section that the run-up stored."""
    case, state, (_, fine), _ = ran
    speeds = np.array(fine.plan.speeds)
    for place in (3, 17, 30):
        speed = speeds[place]
        ends = live.ends_at(fine, speed + 0.3 * (speeds[1] - speeds[0]))
        ways = ["running up", "running down"]
        assert list(ends) == ways
        here = again(case, f"operating.speed={float(speed / RPM)!r} rpm")
        for way, end in enumerate(ends.values()):
            data = live.motion(of_case(here, operating=1, state=state, start=end)).data
            section = data["section_displacement"].values / fine.length
            kept = fine.arrays["section_x"][0, way, place]
            apart = np.abs(kept[:, None] - section[None, :]).min(axis=1)
            assert section.size == fine.arrays["end_period"][0, way, place]
            assert apart.max() < 1e-6


def test_a_run_up_stops_when_it_is_told_to(own: GearCase) -> None:
    asked = []

    def alive() -> None:
        asked.append(1)
        if len(asked) > 20:
            raise Stopped

    with pytest.raises(Stopped):
        list(live.run_ups(own, RPM * np.linspace(2000.0, 9000.0, 100), "hot", alive))
    assert len(asked) < 40


def test_a_run_up_hangs_on_what_its_key_holds(own: GearCase) -> None:
    """Every dial but speed changes the hot key, and that of the drawn gears where it is no heat.

    A run-up is of the mean tooth, which no eccentricity or crack changes.
    """
    idle = ("speed", "pinion_eccentricity", "wheel_eccentricity")
    speeds = RPM * np.linspace(2000.0, 9000.0, 5)
    hot, cold = (live.fingerprint(own, speeds, s) for s in ("hot", "undeformed"))
    assert hot
    assert cold
    assert live.fingerprint(own, speeds[:4], "hot") != hot
    for one in dials(own):
        text = dict(turned(own, {one.name: one.value + 3.0 * one.step}))
        other = case_of(OWN_PAIR, "grid.mesh_positions=50", "operating.speed=3100 rpm",
                        *(f"{k}={v}" for k, v in text.items()))  # fmt: skip
        assert (live.fingerprint(other, speeds, "hot") == hot) == (one.name in idle), one.name
        same = live.fingerprint(other, speeds, "undeformed") == cold
        assert same == (one.name in (*idle, "gears", "housing")), one.name
    start = replace(own, simulation=replace(own.simulation, initial_state=(0.5, 0.0)))
    assert live.fingerprint(start, speeds, "hot") != hot


def test_jammed_gears_are_told_and_do_not_move(own: GearCase) -> None:
    jammed = again(own, "temperatures.pinion_addendum=390 degC",
                   "temperatures.wheel_addendum=390 degC")  # fmt: skip
    found = live.mesh(jammed)
    assert [STATUS[int(one)] for one in found["status"].values] == ["ok", "jammed"]
    with pytest.raises(ThermogearError):
        live.motion(live.point_of(jammed))


CLASSED = """[gears]
module = "3 mm"
face_width = "20 mm"
[gears.pinion]
teeth = 18
[gears.wheel]
teeth = 18
[oil]
name = "ISO VG 100"
temperature = "80 degC"
[flanks]
accuracy = 6
parts = 20
[operating]
speed = "4000 rpm"
torque = "90 N m"
"""


def test_a_series_comes_some_parts_first_and_the_pair_of_the_dial_is_one_of_it() -> None:
    """Of 20 parts first 16; the band is theirs; the case turned to a drawing has the same band."""
    case = case_of(CLASSED, "grid.mesh_positions=48", "grid.harmonics=12")
    (dial,) = (one for one in dials(case) if one.name == "part")
    assert (dial.value, dial.low, dial.high, dial.step) == (-1.0, -1.0, 19.0, 1.0)
    speeds = RPM * np.linspace(2000.0, 6000.0, 5)
    first, whole = live.series(case, speeds)
    assert (first.sizes["part"], whole.sizes["part"], whole.attrs["parts"]) == (16, 20, 20)
    factor = whole["dynamic_factor"].values
    np.testing.assert_array_equal(factor[:16], first["dynamic_factor"].values)
    np.testing.assert_allclose(whole["band"].values, hdquantiles(factor, [0.05, 0.5, 0.95], axis=0))
    own = whole["own_dynamic_factor"].values
    place = int(np.argmin(np.abs(whole["pinion_speed"].values - whole.attrs["own_speed"])))
    np.testing.assert_array_equal(own, factor[:, place])
    with_part = again(case, *("=".join(change) for change in turned(case, {"part": 7.0})))
    assert (with_part.series, whole.attrs["shown"]) == (1, -1)
    assert with_part.deviations == series_parts(case, 8)[7]
    of_part = next(live.series(with_part, speeds))
    assert of_part.attrs["shown"] == 7
    # its own losses make other temperatures
    np.testing.assert_allclose(of_part["own_dynamic_factor"].values, own[:16], rtol=0.05)
    back = dict(turned(with_part, {"part": -1.0}))
    assert back == {"flanks.drawing": "", "flanks.teeth": "", "flanks.parts": "20"}
