"""Answers of gears whose teeth differ: over the turn, of one assembly, beside the others."""

from dataclasses import replace

import numpy as np
import pytest

from thermogear.analysis.settle import UNDECIDED
from thermogear.base.limits import LOOK
from thermogear.base.progress import silent
from thermogear.case.case import GearCase, gear_case, load_case
from thermogear.case.family import family
from thermogear.case.thermal_state import HOT
from thermogear.results.answer import Answer
from thermogear.study.answers.asked import Asked
from thermogear.study.answers.moving import of_faults
from thermogear.study.answers.survey import answers
from thermogear.study.speeds import look

pytestmark = pytest.mark.filterwarnings("ignore::thermogear.base.errors.ValidityWarning")
CASE = """[gears]
module = "3 mm"
face_width = "30 mm"
[gears.pinion]
teeth = 20
pitch_errors = {pinion}
[gears.wheel]
teeth = 40
pitch_errors = {wheel}
[transmission_error]
harmonics = []
[oil]
name = "ISO VG 100"
[operating]
speed = "3000 rpm"
torque = "80 N m"
"""
PINION = np.round(3.0 * np.sin(2.3 * np.arange(20) ** 2), 3)
WHEEL = np.round(3.5 * np.cos(1.7 * np.arange(40) ** 2), 3)


def _case(pinion: int = 0, wheel: int = 0) -> GearCase:
    """Pitch errors of some micrometres, the teeth numbered from others."""
    lists = {
        name: str([f"{error} um" for error in np.roll(errors, first)])
        for name, errors, first in (("pinion", PINION, pinion), ("wheel", WHEEL, wheel))
    }
    small = ("grid.path_positions=41", "grid.mesh_positions=96", "grid.harmonics=12")
    return gear_case(load_case(CASE.format(**lists), small))


def _numbers(answer: Answer) -> np.ndarray:
    figures = (np.ravel(value) for value in answer.figures.values())
    return np.concatenate([[answer.value or 0.0], *(f for f in figures if f.dtype.kind in "if")])


@pytest.fixture(scope="module")
def told() -> dict[str, Answer]:
    return {answer.name: answer for answer in answers(_case()).answers}


def test_a_renumbered_assembly_has_the_same_answers(told: dict[str, Answer]) -> None:
    # gcd(20, 40) = 20 divides 3 - 23
    for answer in answers(_case(pinion=3, wheel=23)).answers:
        assert answer.sentence == told[answer.name].sentence
        np.testing.assert_allclose(
            _numbers(answer), _numbers(told[answer.name]), rtol=1e-9, atol=1e-12
        )


def test_the_limit_is_for_what_repeats_with_the_mesh(told: dict[str, Answer]) -> None:
    error = told["transmission_error"].figures
    assert error["turn"] == 40
    # teeth that are all alike have 2.3 um
    assert 10.0 < error["cold"] < 16.0
    assert told["transmission_error"].value == error["mesh"] < 5.0


def test_other_assemblies_are_told_beside_it(told: dict[str, Answer]) -> None:
    for name, of_its_own in (("transmission_error", "hot"), ("dynamic_factor", "own")):
        figures = told[name].figures
        assert (figures["assemblies"], figures["possible"]) == (8, 20)
        assert figures["smallest"] <= figures[of_its_own] <= figures["largest"]
        assert figures["largest"] > 1.05 * figures["smallest"]
    stated = gear_case(load_case(_case().text, ["gears.marks=[1, 1]"]))
    assert stated.assembly_count == 20
    assert "possible" not in {name for answer in answers(stated).answers for name in answer.figures}


def test_teeth_that_differ_lose_contact_where_their_mean_tooth_does_not(
    told: dict[str, Answer],
) -> None:
    mean = {answer.name: answer for answer in answers(_case().mean_tooth()).answers}
    assert told["dynamic_factor"].value > 1.3 * mean["dynamic_factor"].value
    first = told["contact_loss"].figures["ranges"][0][0]
    assert first < 0.8 * mean["contact_loss"].figures["ranges"][0][0]


def test_motions_that_never_meet_the_back_side_know_no_backlash(told: dict[str, Answer]) -> None:
    # so answers may take the least of the turn all along
    mesh = family(_case(), ["rpm"]).excitations(np.array([[300.0]]))
    looks = [
        look(
            replace(mesh, half_backlash=part * mesh.half_backlash), teeth=20, own=np.array([300.0])
        )
        for part in (1.0, 0.8)
    ]
    assert looks[0].column("mesh_force_min").min() >= 0.0
    assert looks[0].column("contact_loss_share").max() > 0.1
    for name in ("dynamic_factor", "contact_loss_share", "dte_peak_to_peak"):
        first, second = (np.asarray(found.column(name)) for found in looks)
        np.testing.assert_allclose(second, first, rtol=1e-3, atol=1e-3 * first.max())
    gap = told["back_contact"].figures["gap"]
    assert gap < 2e6 * float(mesh.half_backlash[0])


def test_motions_that_do_not_settle_count_however_teeth_are_numbered() -> None:
    light = ["operating.torque=4 N m"]
    both = [
        answers(gear_case(load_case(_case(**first).text, light)))
        for first in ({}, {"pinion": 3, "wheel": 23})
    ]
    one, other = ({answer.name: answer for answer in found.answers} for found in both)
    speeds, renumbered = (found["speeds"] for found in both)
    unsettled = speeds["label_code"].values == UNDECIDED
    assert unsettled.sum() > 10
    for name in ("dynamic_factor", "contact_loss_share", "mesh_force_min"):
        values = speeds[name].values
        assert np.isfinite(values).all()
        np.testing.assert_allclose(renumbered[name].values, values, rtol=1e-9)
    # of the later half of what was followed: as much as beside it, where motions settle
    factor, speed = speeds["dynamic_factor"].values, speeds["pinion_speed"].values
    assert factor[unsettled].max() > 0.5 * factor[~unsettled].max()
    low, high = np.array(one["contact_loss"].figures["ranges"][0])
    rpm = speed[unsettled] * 30.0 / np.pi
    assert ((rpm >= 0.99 * low) & (rpm <= 1.01 * high)).any()
    assert one["contact_loss"].figures["followed"] == 4080
    for name, answer in one.items():
        assert other[name].sentence == answer.sentence


FAULTY = """
[temperatures]
pinion_addendum = "70 degC"
wheel_addendum = "60 degC"
pinion_bore_below_addendum = "0 K"
wheel_bore_below_addendum = "0 K"
housing_below_addendum = "0 K"
[grid]
path_positions = 41
[[faults]]
gear = "pinion"
"""


def _faulty(fault: str, teeth: str = "alike") -> GearCase:
    """A pair of teeth that are alike but for one."""
    plain = CASE.replace("pitch_errors = {pinion}\n", "").replace("pitch_errors = {wheel}\n", "")
    plain = plain.replace("[oil]", '[oil]\ntemperature = "60 degC"')
    flanks = f'[flanks]\naccuracy = 6\nseed = 1\nteeth = "{teeth}"'
    return gear_case(load_case(plain + FAULTY + fault + flanks))


def test_a_vanishing_fault_changes_no_answer() -> None:
    """The turn is at the positions and samples of the mesh period: fewer moved K_v by .5 to 1 %."""
    cases = [_faulty(f'kind = "crack"\ndepth = "{depth}"\n') for depth in ("0 mm", "1e-9 mm")]
    none, least = (
        {answer.name: answer.value for answer in answers(case).answers} for case in cases
    )
    assert [case.period.mesh_periods for case in cases] == [1, 20]
    # the look over speeds steps twice as far over a turn
    for name in none.keys() - {"resonance"}:
        off = abs(least[name] - none[name]) / max(abs(none[name]), 1e-12) if none[name] else 0.0
        print(f"{name}: {off:.1e}")
        assert least[name] == pytest.approx(none[name], rel=1e-4, abs=1e-9, nan_ok=True)
    sound, faulty = (
        HOT.quantities(case, case.models[0], ("mesh_stiffness",))["mesh_stiffness"][0]
        for case in cases
    )
    np.testing.assert_allclose(faulty, np.tile(sound, 20), rtol=1e-4)


def test_the_film_is_that_of_the_worst_tooth_pair() -> None:
    """Of a missing tooth the neighbours carry all: less film than the mean of all tooth pairs."""
    case = _faulty('kind = "missing"\n')
    told = {answer.name: answer for answer in answers(case).answers}
    names = (
        "film_parameter",
        "film_parameter_least_of_turn",
        "least_film_parameter",
        "flash_temperature_greatest_of_turn",
        "contact_temperature_greatest_of_turn",
    )
    found = {n: v[0] for n, v in HOT.quantities(case, case.models[0], names).items()}
    least = found["film_parameter_least_of_turn"]
    assert told["film"].value == found["least_film_parameter"] == least
    assert least < 0.99 * found["film_parameter"].min()
    words = Asked(case, case.models[0], {}, {}, silent).worst_pair
    for name in ("film", "tooth_temperature"):
        assert len(words) > 10
        assert words in told[name].sentence
    # what one tooth does is no part of the mean over the mesh periods, and is judged
    error = told["transmission_error"]
    assert error.figures["mesh"] < 10.0 < error.value == error.figures["faulty"]
    assert error.verdict == LOOK
    for name in ("scuffing_margin", "scuffing_safety"):
        assert "faults" in told[name].sentence
    assert "sound" in told["root_stress"].sentence
    flash = found["flash_temperature_greatest_of_turn"]
    assert told["tooth_temperature"].figures["flash"] == flash
    # teeth at 70 and 60 degC: the contact is that much hotter than between both
    assert 333.15 + flash < found["contact_temperature_greatest_of_turn"] <= 343.15 + flash


def test_what_faults_move_the_error_by() -> None:
    """Without load a tooth that is 15 um forward leads by that; e sin(theta) by 2 e sin(pi/z)."""

    def moved(fault: str) -> float:
        case = _faulty(fault)
        case = gear_case(load_case(case.text, {"operating.torque": "0.05 N m"}))
        found = of_faults(Asked(case, case.models[0], {}, {}, silent), 0)
        return found.get("faulty", 0.0)

    assert moved('kind = "pitch"\namount = "15 um"\n') == pytest.approx(15.0, rel=0.03)
    assert moved('kind = "crack"\ndepth = "0 mm"\n') == 0.0
    assert moved('kind = "crack"\ndepth = "1e-9 mm"\n') < 1e-6
    turned = moved('kind = "eccentricity"\namount = "15 um"\n')
    assert turned == pytest.approx(2 * 15.0 * np.sin(np.pi / 20), rel=0.03)
