"""What a sweep says of a point is what the answers say of a case at that point."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import thermogear as tg
from coded import coded
from thermogear.analysis.maps import parameter_map
from thermogear.base.units import ZERO_CELSIUS
from thermogear.base.vocabulary import STATUS
from thermogear.case.case import GearCase, gear_case, load_case
from thermogear.case.family import GearFamily
from thermogear.mesh import elastic
from thermogear.study.answers import moving, steady
from thermogear.study.answers.asked import Asked, undecided
from thermogear.study.answers.points import NUMBERS, answer_numbers

pytestmark = pytest.mark.filterwarnings("ignore::thermogear.ValidityWarning")
SEED = 20261123
SCALE = {
    "oil_temperature": (1.0, ZERO_CELSIUS), "tooth_temperature": (1.0, ZERO_CELSIUS),
    "least_film_parameter": (1.0, 0.0), "scuffing_margin": (1.0, 0.0),
    "scuffing_safety": (1.0, 0.0), "backlash": (1e6, 0.0), "jam_margin": (1.0, 0.0),
    "static_error": (1e6, 0.0), "dynamic_factor": (1.0, 0.0),
}  # fmt: skip
"""Number of a sweep -> what makes it the answer's: times, less."""
ANSWER = {"least_film_parameter": "film", "static_error": "transmission_error"}
HEAT = """
[temperatures]
pinion_addendum = "{:.0f} degC"
wheel_addendum = "{:.0f} degC"
pinion_bore_below_addendum = "15 K"
wheel_bore_below_addendum = "10 K"
housing = "60 degC"
"""


def own(rng: np.random.Generator) -> str:
    """A pair that nobody chose: teeth, module, shift, load, speed, heat given or computed."""
    module = float(rng.choice([1.5, 2.0, 3.0, 4.5]))
    teeth = int(rng.integers(18, 32)), int(rng.integers(30, 90))
    text = f"""
[model]
bundle = "both"
[flanks]
accuracy = {int(rng.integers(5, 8))}
seed = 1
[gears]
module = "{module} mm"
[gears.pinion]
teeth = {teeth[0]}
profile_shift = {rng.uniform(0.0, 0.3):.2f}
face_width = "{10 * module:.1f} mm"
[gears.wheel]
teeth = {teeth[1]}
face_width = "{9 * module:.1f} mm"
[oil]
name = "ISO VG {int(rng.choice([100, 220, 320]))}"
[backlash]
value = "{rng.uniform(0.1, 0.3):.3f} mm"
direction = "normal"
extent = "total"
[operating]
speed = "{rng.uniform(500, 4000):.0f} rpm"
torque = "{rng.uniform(2.0, 6.0) * module**3:.1f} N m"
"""
    if rng.random() < 0.5:
        return text
    held = text.replace("[oil]\n", '[oil]\ntemperature = "80 degC"\n')
    return held + HEAT.format(*rng.uniform(85, 130, 2))


def drawn(count: int) -> list[GearCase]:
    rng = np.random.default_rng(SEED)
    return [gear_case(load_case(own(rng))) for _ in range(count)]


@pytest.mark.slow
def test_a_sweep_tells_what_the_answers_tell(monkeypatch: pytest.MonkeyPatch) -> None:
    """4 drawn pairs, both bundles, two corners of torque x speed x backlash each."""
    monkeypatch.setattr(Asked, "speeds", None)  # the survey over speed is of no point
    monkeypatch.setattr(moving, "relief", lambda asked: undecided("", "relief", "not asked"))
    # nor is the way there: a sweep has no number of it
    monkeypatch.setattr(
        steady,
        "_worst_moment",
        lambda asked: undecided("", "warm_up", "not asked", limit="backlash"),
    )
    worst = dict.fromkeys(SCALE, 0.0)
    factors = []
    for case in drawn(4):
        torque, speed, gap = case.torques[0], case.speeds[0], case.stated.half_backlash
        axes = {
            "torque": [0.6 * torque, torque],
            "speed": [0.8 * speed, speed],
            "backlash": [float(np.ravel(gap)[0]), 1.2 * float(np.ravel(gap)[0])],
        }
        for model in case.models:
            data = tg.sweep(case, axes, bundle=model.name).data
            for place in ((0, 1, 0), (1, 0, 1)):
                values = dict(zip(axes, (axes[n][i] for n, i in zip(axes, place, strict=True)),
                                  strict=True))  # fmt: skip
                alone = case.with_values(values, told=False)
                first = [m for m in alone.models if m.name == model.name]
                told = {
                    a.name: a.value
                    for a in tg.answers(_with_models(alone, first)).answers
                    if a.operating == ""
                }
                point = data.isel(dict(zip(data["label"].dims, place, strict=True)))
                for name, (times, less) in SCALE.items():
                    mine, other = times * (float(point[name]) - less), told[ANSWER.get(name, name)]
                    if other is None:
                        assert not np.isfinite(mine), name
                        continue
                    off = abs(mine - other) / max(abs(other), 1e-3)
                    if name == "dynamic_factor":
                        factors.append(off)
                    worst[name] = max(worst[name], off)
    print("worst, relative:", {name: f"{off:.1e}" for name, off in worst.items()})
    for name, off in worst.items():
        if name != "dynamic_factor":
            assert off < 1e-6, name
    assert np.median(factors) < 0.01


def _with_models(case: GearCase, models: list[object]) -> GearCase:
    from dataclasses import replace

    return replace(case, models=tuple(models))  # type: ignore[arg-type]


def test_other_gears_are_rated_as_themselves() -> None:
    case = drawn(1)[0]
    names = ("gears.pinion.face_width", "gears.wheel.roughness", "pinion_torque")
    width = case.pair.pinion.face_width
    rows = np.array([[width, 0.3e-6, 20.0], [0.8 * width, 0.7e-6, 30.0], [width, 0.7e-6, 20.0]])
    whole = answer_numbers(tg.family(case, names), rows)  # type: ignore[arg-type]
    assert set(whole) == set(NUMBERS)
    for place, row in enumerate(rows):
        one = answer_numbers(tg.family(case, names), row[None])  # type: ignore[arg-type]
        for name in NUMBERS:
            assert whole[name][place] == pytest.approx(one[name][0], rel=1e-9), name


def test_a_point_without_a_case_is_nan_and_its_neighbours_do_not_notice() -> None:
    case = drawn(1)[0]
    names = ("gears.pinion.teeth", "pinion_torque")
    whole = answer_numbers(tg.family(case, names), np.array([[21, 20.0], [1.0, 20.0]]))  # type: ignore[arg-type]
    for name in NUMBERS:
        assert np.isfinite(whole[name][0]), name
        assert np.isnan(whole[name][1]), name


def test_a_row_without_an_oil_bath_says_so_and_keeps_its_numbers() -> None:
    """The oil's own bound, flash point or 150 degC, decides; the motion is that of a known oil."""
    torque = {"pinion_torque": np.array([20.0, 80.0])}
    axes = torque | {"pinion_speed": np.array([300.0, 400.0])}
    heat = ["oil.temperature=170 degC", "oil.temperature_below_addendum="]
    hot, known = (
        (tg.sweep(gear_case(load_case("rig", [*heat, *more])), torque),
         parameter_map(GearFamily(gear_case(load_case("rig", [*heat, *more])), tuple(axes)), axes))
        for more in ([], ["oil.flash_point=200 degC"])
    )  # fmt: skip
    for there, same in zip((hot[0].data, hot[1]), (known[0].data, known[1]), strict=True):
        assert (there["status"] == STATUS.index("no_oil_bath")).all()
        assert (same["status"] == 0).all()
        for name in set(there.data_vars) - {"status"}:
            np.testing.assert_array_equal(there[name].values, same[name].values)
    bath = {"hot": 2, "points": 2, "hottest": 423.15}
    assert coded(hot[0].notices)["no_oil_bath"] == [bath]
    assert "no_oil_bath" not in coded(known[0].notices)


def test_motion_and_answers_of_a_sweep_share_one_heat_balance(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Whichever of the two is asked first, the other solves no balance and tells the same."""
    rng = np.random.default_rng(SEED)
    case = next(
        made for made in iter(lambda: gear_case(load_case(own(rng))), None) if made.computed
    )
    rows = float(np.ravel(case.torques)[0]) * np.array([[0.8], [1.1]])
    solved: list[int] = []
    solve = GearCase.balance_of

    def counted(self: GearCase, *given: object, **how: object) -> object:
        solved.append(1)
        return solve(self, *given, **how)  # type: ignore[arg-type]

    monkeypatch.setattr(GearCase, "balance_of", counted)
    meshed: list[int] = []
    contact = elastic.solve_mesh

    def solved_mesh(pair: object, force: object, phase: Any, **how: Any) -> Any:
        meshed.append(np.size(phase))
        return contact(pair, force, phase, **how)

    monkeypatch.setattr(elastic, "solve_mesh", solved_mesh)
    want = ("oil_temperature", "mean_stiffness")
    both = GearFamily(case, ("pinion_torque",))
    moving_points = both(rows)
    meshed.clear()
    still_points = both.quasi_static(rows, want, path_positions=case.path_positions)
    # the mesh of the motion is the mesh of the answers
    assert not meshed
    assert len(solved) == 1
    alone = GearFamily(case, ("pinion_torque",)).quasi_static(rows, want)
    assert len(solved) == 2
    for name, values in alone.items():
        np.testing.assert_array_equal(still_points[name], values)
    again = GearFamily(case, ("pinion_torque",))(rows)
    np.testing.assert_array_equal(moving_points.stiffness, again.stiffness)
    both.quasi_static(1.01 * rows, want)
    assert len(solved) == 4
