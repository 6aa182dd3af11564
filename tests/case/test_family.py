"""Gear words: the same lanes as the case's own motion, and words that are told apart."""

from dataclasses import replace

import numpy as np
import pytest

from own_pair import OWN_PAIR
from thermogear.base.errors import InputError
from thermogear.case.allowed import gear_parameter, read_shown
from thermogear.case.axes import parse_axis
from thermogear.case.case import gear_case, load_case, load_example
from thermogear.case.family import GearFamily, Tabulated, family
from thermogear.case.points import largest_fluctuation
from thermogear.dynamics.models import from_excitation
from thermogear.mesh.cycle import mesh_cycle
from thermogear.mesh.excite import excitation

RPM = np.pi / 30.0


@pytest.fixture(scope="module")
def rig():
    return load_example("rig")


def test_lanes_are_those_of_the_case(rig):
    family = GearFamily(rig, ("pinion_speed",))
    points = family(np.array(rig.speeds)[:, None])
    cycle = mesh_cycle(
        rig.pair,
        rig.operating,
        rig.models[0],
        deviations=rig.deviations,
        path_positions=rig.path_positions,
        mesh_positions=rig.mesh_positions,
    )
    own = from_excitation(
        excitation(
            cycle,
            rig.pair,
            damping_ratio=rig.damping_ratio,
            inertias=rig.inertias,
            transmission_error=rig.transmission_error,
            harmonics=rig.harmonics,
        )
    ).lanes()
    for name in ("period", "damping", "half_backlash", "stiffness", "force"):
        assert np.array_equal(getattr(points.flat, name), getattr(own, name)), name


def test_rows_one_by_one_and_together_agree(rig):
    family = GearFamily(rig, ("gear_temperature", "damping_ratio", "pinion_torque"))
    rows = np.array([[380.0, 0.05, 80.0], [420.0, 0.1, 120.0], [380.0, 0.07, 150.0]])
    whole = family(rows)
    for i, row in enumerate(rows):
        alone = family(row[None])
        for name in ("period", "damping", "half_backlash", "stiffness", "force"):
            one, many = getattr(alone.flat, name)[0], getattr(whole.flat, name)[i]
            assert np.allclose(one, many, rtol=1e-13, atol=0.0), name
        assert alone.force[0] == pytest.approx(whole.force[i], rel=1e-14)


def test_cold_backlash_scales_the_lane(rig):
    """Everything uniform: b' = b, so the dimensionless half backlash is 1 whatever b is."""
    family = GearFamily(rig, ("cold_half_backlash",), state="undeformed")
    points = family(np.array([[60e-6], [125e-6]]))
    assert points.flat.half_backlash == pytest.approx([1.0, 1.0], rel=1e-12)
    means = points.flat.force[:, 0].real
    assert means[0] / means[1] == pytest.approx(125.0 / 60.0, rel=1e-12)


def test_fields_of_the_case_file_can_be_swept(rig):
    family = GearFamily(rig, ("dynamics.damping_ratio", "pinion_speed"))
    points = family(np.array([[0.03, 100.0], [0.09, 200.0]]))
    assert points.flat.damping == pytest.approx([0.06, 0.18], rel=1e-14)
    assert points.mesh_frequency == pytest.approx([2500.0, 5000.0], rel=1e-14)


def test_jammed_points_are_a_status(rig):
    points = GearFamily(rig, ("cold_half_backlash",))(np.array([[2e-6], [125e-6]]))
    assert points.status.tolist() == [1, 0]
    both = GearFamily(rig, ("cold_half_backlash",))(np.array([[2e-6], [3e-6]]))
    assert both.status.tolist() == [1, 1]


def test_table_between_speeds_is_exact_where_nothing_depends_on_speed(rig):
    family = GearFamily(rig, ("pinion_speed",), state="undeformed")
    table = Tabulated.of(family, np.linspace(100.0, 1200.0, 5))
    at = np.array([[150.0], [555.5], [1200.0]])
    for name in ("period", "stiffness", "force", "half_backlash"):
        one, other = getattr(table(at).flat, name), getattr(family(at).flat, name)
        assert np.allclose(one, other, rtol=1e-12, atol=1e-18), name


def test_a_table_of_one_state_hands_on_what_does_not_move_with_the_speed(rig):
    """Alone and beside others a speed has the same numbers, and what is alike is not copied."""
    table = Tabulated.of(
        GearFamily(rig, ("pinion_speed",), state="undeformed"), np.linspace(100.0, 1200.0, 5)
    )
    at = np.array([[150.0], [555.5], [1200.0]])
    together, alone = table(at), [table(one[None]) for one in at]
    assert all(one.error is alone[0].error for one in alone)
    assert all(one.flat.stiffness is alone[0].flat.stiffness for one in alone)
    for name in ("status", "length", "rate", "stiffness", "force", "error", "mesh_frequency"):
        rows = np.concatenate([getattr(one, name) for one in alone])
        assert np.array_equal(rows, getattr(together, name)), name
    for name in ("period", "damping", "half_backlash", "stiffness", "force"):
        rows = np.concatenate([getattr(one.flat, name) for one in alone])
        assert np.array_equal(rows, getattr(together.flat, name)), name


def test_words_and_units():
    assert gear_parameter("rpm").name == "pinion_speed"
    speed, heat, backlash = map(gear_parameter, ("pinion_speed", "temperature", "backlash"))
    assert read_shown(speed, "3000") == pytest.approx(100.0 * np.pi, rel=1e-15)
    assert read_shown(heat, "20") == 293.15
    assert read_shown(backlash, "125") == pytest.approx(125e-6, rel=1e-15)
    with pytest.raises(InputError, match=r"parameter: got 'torqe'; did you mean 'torque'\?"):
        gear_parameter("torqe")


def test_an_axis_of_lengths_is_the_case_with_that_length(rig):
    """A field of the file over its values gives, point by point, the case so written."""
    name, widths = parse_axis(rig, "gears.pinion.face_width=20 mm:30 mm:3")
    assert name == "gears.pinion.face_width"
    assert widths == pytest.approx([0.020, 0.025, 0.030], rel=1e-15)
    family = GearFamily(rig, (name,))
    assert family.units == ("m",)
    swept = family(widths[:, None])
    for place, text in enumerate(("20 mm", "25 mm", "30 mm")):
        written = load_example("rig", {name: text})
        one = GearFamily(written, ("pinion_speed",))(np.array([[written.speeds[0]]]))
        assert swept.rate[place] == pytest.approx(one.rate[0], rel=1e-12)
        assert swept.stiffness[place] == pytest.approx(one.stiffness[0], rel=1e-12)


@pytest.mark.parametrize(
    ("bare", "written"),
    [
        ("rpm=600:1200:3", "speed=10 turn/s:20 turn/s:3"),
        ("torque=50,100", "torque=50 N m,1e5 N mm"),
        ("temperature=20:140:4", "temperature=293.15 K:413.15 K:4"),
        ("backlash=100:200:2", "backlash=0.1 mm:0.2 mm:2"),
    ],
)
def test_a_unit_may_stand_at_every_value(rig, bare, written):
    one, other = parse_axis(rig, bare), parse_axis(rig, written)
    assert one[0] == other[0]
    assert one[1] == pytest.approx(other[1], rel=1e-14)


def test_standstill_is_refused(rig):
    with pytest.raises(InputError, match=r"operating\.speed: got 0 rpm; allowed > 0 rpm"):
        GearFamily(rig, ("pinion_speed",))(np.array([[0.0]]))


@pytest.mark.parametrize("state", ["hot", "undeformed"])
def test_speeds_that_share_heat_and_load_share_a_mesh_cycle(rig, state):
    """Row by row gives the same numbers; gears as drawn do not know the speed at all."""
    rows = np.array([[50.0, 80.0], [300.0, 120.0], [900.0, 80.0], [90.0, 120.0]])
    whole = GearFamily(rig, ("pinion_speed", "pinion_torque"), state=state)
    together = whole(rows)
    for place, row in enumerate(rows):
        alone = GearFamily(rig, ("pinion_speed", "pinion_torque"), state=state)(row[None])
        for name in ("period", "damping", "half_backlash", "stiffness", "force"):
            one, all_ = getattr(alone.flat, name), getattr(together.flat, name)
            assert np.array_equal(one[0], all_[place]), name
    assert len(whole._springs) == 1
    again = whole(rows[:, :] * [2.0, 1.0])
    same = np.array_equal(again.flat.stiffness, together.flat.stiffness)
    assert same == (state == "undeformed")
    assert again.mesh_frequency == pytest.approx(2.0 * together.mesh_frequency, rel=1e-15)


def test_one_door_for_gears_and_numbers(rig):
    table = load_example("table-4.2")
    lanes = family(table, ("zeta", "w"), numbers={"half_backlash": 0.9})
    points = lanes(np.array([[0.1, 1.2], [0.2, 1.3]]))
    assert points.flat.damping == pytest.approx([0.2, 0.4])
    assert points.flat.half_backlash.tolist() == [0.9, 0.9]
    assert points.length.tolist() == [1.0, 1.0]
    with pytest.raises(InputError, match=r"bundle: got 'thesis'; a dimensionless case has no gea"):
        family(table, ("zeta",), "thesis")
    with pytest.raises(InputError, match=r"state: got 'undeformed'; a dimensionless case has no"):
        family(table, ("zeta",), state="undeformed")
    with pytest.raises(InputError, match="half_backlash: got a number beside a gear case"):
        family(rig, ("rpm",), numbers={"half_backlash": 0.9})


def test_a_choice_of_the_bundle_can_be_varied(rig):
    """The bundle was looked up by its name, which changes with its choices: a traceback."""
    family = GearFamily(rig, ("model.friction.boundary",))
    points = family(np.array([[0.06], [0.08]]))
    assert points.status.tolist() == [0, 0]
    own = GearFamily(rig, ())(np.empty((1, 0)))
    # temperatures are given: friction moves neither springs nor backlash
    assert points.stiffness == pytest.approx([own.stiffness[0]] * 2, rel=1e-12)


def test_a_factor_scales_the_fluctuation_of_the_stiffness_and_nothing_else() -> None:
    """k = k_m (1 + s w): the mean stays, 1 changes no bit, and k reaches zero at s = -1/min w."""
    case = gear_case(
        load_case(
            OWN_PAIR, ["grid.path_positions=21", "grid.mesh_positions=32", "grid.harmonics=8"]
        )
    )
    plain = family(case)(np.empty((1, 0)))
    with_factor = family(case, ["fluctuation"])
    points = with_factor(np.array([[1.0], [0.0], [2.0]]))
    own_series = plain.flat.stiffness[0]
    assert np.array_equal(points.flat.stiffness[0], own_series)
    assert not points.flat.stiffness[1, 1:].any()
    assert np.array_equal(points.flat.stiffness[2, 1:], 2.0 * own_series[1:])
    for name in ("period", "damping", "half_backlash", "force"):
        values = getattr(points.flat, name)
        assert np.array_equal(values, np.broadcast_to(getattr(plain.flat, name), values.shape))
    (most,) = largest_fluctuation(plain)
    turns = np.exp(2j * np.pi * np.outer(np.arange(own_series.size), np.arange(4000) / 4000))
    waves = (own_series[1:] @ turns[1:]).real
    assert most == pytest.approx(own_series[0].real / -waves.min(), rel=2e-2)
    cosine = replace(plain, flat=replace(plain.flat, stiffness=np.array([[1.0, 0.4]], complex)))
    assert largest_fluctuation(cosine) == pytest.approx([2.5], rel=1e-15)
    with pytest.raises(InputError) as refused:
        with_factor(np.array([[1.5 * most]]))
    assert str(refused.value) == (
        f"stiffness_fluctuation: got {1.5 * most:g}; allowed below {most:.4g}; the mesh stiffness "
        "would reach zero"
    )
