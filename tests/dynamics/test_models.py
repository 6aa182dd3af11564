"""The equations of motion: what they refuse, and the road from a gear pair in SI to X."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from thermogear.base.errors import InputError
from thermogear.base.excitation import Excitation, Periodic
from thermogear.dynamics.models import (
    DeadZoneModel,
    PairModel,
    TorsionalModel,
    dead_zone,
    from_excitation,
)
from thermogear.dynamics.tables import Pieces

GOOD = {
    "damping_ratio": 0.1,
    "frequency": 1.2,
    "stiffness_amplitude": 0.3,
    "mean_force": 0.1,
    "force_amplitude": 0.05,
}


def a_pair(**changes: object) -> Excitation:
    values: dict[str, object] = {
        "stiffness": Periodic(4e8, (6e7, 2e7j)),
        "error": Periodic(0.0, (2e-6, 1e-6j)),
        "half_backlash": 50e-6,
        "reference_half_backlash": 60e-6,
        "mean_force": 2000.0,
        "mesh_frequency": 9000.0,
        "inertias": (0.001, 0.02),
        "base_radii": (0.05, 0.15),
        "torques": (100.0, 300.0),
        "damping_ratio": 0.07,
    }
    return Excitation(**(values | changes))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"damping_ratio": -0.1}, "damping_ratio: got -0.1; allowed >= 0, finite"),
        ({"frequency": 0.0}, "frequency: got 0.0; allowed > 0, finite"),
        ({"frequency": [1.0, -2.0]}, "frequency: got -2.0; allowed > 0, finite"),
        ({"half_backlash": 0.0}, "half_backlash: got 0.0; allowed > 0, finite"),
        ({"mean_force": float("nan")}, "mean_force: got nan; allowed finite"),
        ({"force_amplitude": [0.0, np.inf]}, "force_amplitude: got inf; allowed finite"),
        (
            {"thermal_stiffness": -1.0},
            "thermal_stiffness: got -1.0; allowed > -1; "
            "the mean stiffness 1 + eps_T must stay positive",
        ),
    ],
)
def test_impossible_parameters_are_refused_in_one_line(change, message):
    with pytest.raises(InputError) as caught:
        TorsionalModel(**(GOOD | change))
    assert str(caught.value) == message


def test_shapes_that_do_not_broadcast_are_refused():
    with pytest.raises(InputError, match="shapes that broadcast"):
        TorsionalModel(**(GOOD | {"frequency": [1.0, 2.0], "damping_ratio": [0.1, 0.2, 0.3]}))


@given(
    x=st.floats(-10, 10),
    b=st.floats(0, 3),
)
def test_the_dead_zone_is_odd_continuous_and_zero_inside(x, b):
    value = float(dead_zone(x, half_backlash=b))
    assert value == -float(dead_zone(-x, half_backlash=b))
    assert value == (0.0 if abs(x) <= b else x - np.copysign(b, x))


@settings(max_examples=30)
@given(
    zeta=st.floats(0, 1),
    w=st.floats(0.1, 3),
    x=st.floats(-3, 3),
    v=st.floats(-3, 3),
    t=st.floats(0, 20),
)
def test_the_general_model_with_one_cosine_is_the_torsional_model(zeta, w, x, v, t):
    one = TorsionalModel(
        damping_ratio=zeta,
        frequency=w,
        stiffness_amplitude=0.3,
        mean_force=0.1,
        force_amplitude=-0.2,
        half_backlash=0.9,
        thermal_stiffness=0.02,
    )
    other = DeadZoneModel(
        damping_ratio=zeta,
        frequency=w,
        stiffness=Periodic(1.02, (0.3,)),
        force=Periodic(0.1, (-0.2,)),
        half_backlash=0.9,
    )
    assert one.derivative(t, [x, v]) == pytest.approx(other.derivative(t, [x, v]), abs=1e-13)


def test_lanes_follow_the_broadcast_order():
    model = TorsionalModel(**(GOOD | {"frequency": [[1.0], [2.0]], "damping_ratio": [0.1, 0.2]}))
    lanes = model.lanes()
    assert model.shape == (2, 2)
    assert lanes.period == pytest.approx(2 * np.pi / np.array([1.0, 1.0, 2.0, 2.0]))
    assert lanes.damping == pytest.approx([0.2, 0.4, 0.2, 0.4])


def test_dimensionless_force_of_a_cosine_error_is_its_ratio_times_frequency_squared():
    pair = a_pair(error=Periodic(0.0, (3e-6,)))
    model = from_excitation(pair)
    w = 9000.0 / pair.natural_frequency
    assert model.frequency == pytest.approx(w, rel=1e-14)
    assert model.force.harmonics[0] == pytest.approx(3e-6 / 60e-6 * w**2, rel=1e-13)
    assert model.force.mean == pytest.approx(2000.0 / (4e8 * 60e-6), rel=1e-14)
    assert model.half_backlash == pytest.approx(50 / 60, rel=1e-14)
    assert model.stiffness.harmonics[1] == pytest.approx(0.05j, rel=1e-14)


def test_several_excitations_are_lanes():
    model = from_excitation([a_pair(), a_pair(mesh_frequency=5000.0)])
    assert model.shape == (2,)
    assert model.lanes().take(1).period == from_excitation(a_pair(mesh_frequency=5000.0)).period


def test_mean_mesh_force_of_balanced_torques_is_the_tooth_force():
    pair = PairModel.from_excitation(a_pair())
    assert pair.mean_force == pytest.approx(100.0 / 0.05, rel=1e-14)


def test_start_of_the_pair_has_the_displacement_asked_for_and_no_momentum():
    pair = PairModel.from_excitation(a_pair())
    state = pair.start(x=7e-5, v=0.02)
    x, v = pair.displacement(0.0, state)
    assert float(x) == pytest.approx(7e-5, rel=1e-13)
    assert float(v) == pytest.approx(0.02, rel=1e-13)
    assert abs(float(pair.momentum(state))) < 1e-16


def test_pieces_hold_their_polynomials_and_their_mean():
    piece = Pieces(starts=(0.0, 0.25, 0.6), coefficients=((1.0,), (2.0, 4.0), (0.5, 0.0, 3.0)))
    assert piece([0.0, 0.1, 0.25, 0.5, 0.6, 0.9]) == pytest.approx([1, 1, 2, 3, 0.5, 0.77])
    phase = (np.arange(200_000) + 0.5) / 200_000
    assert piece.mean == pytest.approx(float(piece(phase).mean()), abs=1e-9)
    centre, half = 0.8, 0.05
    u = np.linspace(-1, 1, 7)
    series = np.polynomial.polynomial.polyval(u, piece.taylor(centre=centre, half=half, order=6))
    assert series == pytest.approx(piece(centre + half * u), abs=1e-15)


@pytest.mark.parametrize(
    ("starts", "rows"), [((0.1,), ((1.0,),)), ((0.0, 1.0), ((1.0,), (1.0,))), ((0.0,), ((),))]
)
def test_impossible_pieces_are_refused(starts, rows):
    with pytest.raises(InputError):
        Pieces(starts=starts, coefficients=rows)
