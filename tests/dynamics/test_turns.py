"""Motions over a turn by fixed steps, against linear theory and event-exact orbits."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from thermogear.analysis.orbits import periodic_orbit
from thermogear.base.excitation import Periodic
from thermogear.dynamics.models import DeadZoneModel
from thermogear.dynamics.turns import (
    PartTables,
    TurnLanes,
    TurnTables,
    follow_parts,
    follow_turns,
)

MESH_PERIODS = 12


def _tables(seed: int, size: float) -> TurnTables:
    """A stiffness of the mesh and an error of shaft and mesh orders, drawn."""
    draw = np.random.default_rng(seed)
    stiffness = np.zeros(3 * MESH_PERIODS + 1, complex)
    stiffness[0] = 1.0
    stiffness[MESH_PERIODS::MESH_PERIODS] = [0.1, 0.05, 0.02]
    error = np.zeros_like(stiffness)
    error[1:] = size * (draw.normal(size=(stiffness.size - 1, 2)) @ [1.0, 1j])
    error[1:] /= 1.0 + np.arange(1, error.size)
    return TurnTables(stiffness=stiffness, error=error, mesh_periods=MESH_PERIODS)


def _lanes(ratio: np.ndarray, force: float) -> TurnLanes:
    """Mesh over natural frequency ``ratio``, damping ratio 0.05."""
    ones = np.ones(ratio.size)
    return TurnLanes(
        mean=force * ones, damping=0.1 * ones, backlash=ones,
        period=MESH_PERIODS * 2.0 * np.pi / ratio,
    )  # fmt: skip


def test_a_pair_that_never_parts_moves_as_linear_theory_says(compared) -> None:
    # constant stiffness: every order of the error by itself
    tables = _tables(1, 0.01)
    tables.stiffness[1:] = 0.0
    lanes = _lanes(np.array([0.05, 0.3, 1.1]), 0.8)
    motions = follow_turns(tables, lanes, np.array([[1.8, 0.0]] * 3))
    assert (motions.period == 1).all()
    assert (motions.lost == 0.0).all()
    ranks = np.arange(tables.error.size)
    phase = np.arange(4096) / 4096
    for lane, period in enumerate(lanes.period):
        rate = 2.0 * np.pi * ranks / period
        answer = tables.error * rate**2 / (1.0 - rate**2 + 0.1j * rate)
        force = 0.8 + (np.exp(2j * np.pi * np.outer(phase, ranks)) @ answer).real
        worst = np.abs(motions.force[lane] - [force.max(), force.min()]).max()
        compared("force of a pair in contact", "linear theory", worst, 1e-4, "b_c")


@pytest.mark.parametrize("ratio", [0.85, 0.95])
def test_flanks_that_part_move_on_the_exact_orbit(compared, ratio: float) -> None:
    tables, lanes = _tables(2, 0.05), _lanes(np.array([ratio]), 0.1)
    motions = follow_turns(tables, lanes, np.array([[1.1, 0.0]]))
    rate = 2.0 * np.pi / lanes.period[0]
    bend = tables.error * (1j * rate * np.arange(tables.error.size)) ** 2
    model = DeadZoneModel(
        damping_ratio=0.05, frequency=rate,
        stiffness=Periodic(1.0, tuple(tables.stiffness[1:])), force=Periodic(0.1, tuple(-bend[1:])),
    )  # fmt: skip
    orbit = periodic_orbit(model, 1, motions.state[0])
    assert motions.period[0] == 1
    assert motions.lost[0] > 0.02
    apart = np.abs(orbit.state - motions.state[0]).max()
    compared("state at the turn's start", "event-exact orbit", apart, 2e-3, "b_c")
    factor = motions.force[0, 0] / 0.1 / orbit.dynamic_load_factor() - 1.0
    compared("greatest mesh force", "event-exact orbit", factor, 2e-3, "1")
    share = motions.lost[0] - (1.0 - orbit.time_share["drive"])
    compared("share of time out of contact", "event-exact orbit", share, 2e-3, "1")


def test_parts_that_never_part_move_as_linear_theory_says(compared) -> None:
    # three parts of errors of their own, at three speeds, k constant
    ranks, phase = np.arange(3 * MESH_PERIODS + 1), np.arange(96 * MESH_PERIODS)
    errors = np.stack([_tables(seed, 0.01).error for seed in (1, 2, 3)])
    samples = (errors @ np.exp(2j * np.pi * np.outer(ranks, phase) / phase.size)).real
    tables = PartTables.of(
        stiffness=np.ones_like(samples), error=samples, mesh_periods=MESH_PERIODS, harmonics=3
    )
    ratio, ones = np.array([0.15, 0.4, 1.1]), np.ones(3)
    motions = follow_parts(
        tables, rate=np.tile(2.0 * np.pi / ratio, (3, 1)), damping_ratio=0.05 * ones,
        backlash=ones, load=0.8 * ones,
    )  # fmt: skip
    assert motions.repeats.all()
    assert (motions.lost == 0.0).all()
    every = np.exp(2j * np.pi * np.outer(np.arange(8192) / 8192, ranks))
    for part, error in enumerate(errors):
        for speed, mesh in enumerate(ratio):
            rate = ranks * mesh / MESH_PERIODS
            answer = error * rate**2 / (1.0 - rate**2 + 0.1j * rate)
            force = 0.8 + (every @ answer).real
            ends = motions.greatest[part, speed], motions.least[part, speed]
            worst = np.abs(np.array(ends) - [force.max(), force.min()]).max()
            compared("force of a part in contact", "linear theory", worst, 2e-4, "b_c")


def test_a_stretch_that_goes_on_and_on_is_a_turn() -> None:
    """Mesh periods that are all alike: a stretch of them moves as one that comes again."""
    phase = np.arange(96) / 96
    stiffness = 1.0 + 0.1 * np.cos(2.0 * np.pi * phase)[None]
    error = 0.02 * np.sin(2.0 * np.pi * phase + 0.4)[None]
    given = {
        "rate": 2.0 * np.pi / np.array([[0.4, 0.9]]), "damping_ratio": np.array([0.07]),
        "backlash": np.ones(1), "load": np.array([0.05]),
    }  # fmt: skip
    turn = PartTables.of(stiffness=stiffness, error=error, mesh_periods=1, harmonics=24)
    many = {"stiffness": np.tile(stiffness, 60), "error": np.tile(error, 60)}
    stretch = PartTables.of(**many, mesh_periods=40, harmonics=24, ahead=20, periodic=False)
    one, other = follow_parts(turn, **given), follow_parts(stretch, **given)
    assert one.lost[0, 1] > 0.05
    assert (one.repeats & other.repeats).all()
    for name in ("greatest", "least", "lost"):
        assert getattr(other, name) == pytest.approx(getattr(one, name), abs=2e-4)


def test_starts_that_end_on_two_motions_are_told() -> None:
    """A loaded pair whose flanks part: two motions below its resonance, one beside them."""
    load, amplitude, damping = 0.05, 0.02, 0.05
    error = amplitude * np.sin(2.0 * np.pi * np.arange(96) / 96)[None]
    tables = PartTables.of(stiffness=np.ones_like(error), error=error, mesh_periods=1, harmonics=3)
    ratios = np.array([0.6, 0.825, 1.0])
    motions = follow_parts(
        tables, rate=2.0 * np.pi / ratios[None], damping_ratio=np.array([damping]),
        backlash=np.ones(1), load=np.array([load]),
    )  # fmt: skip
    assert motions.alike.tolist() == [[True, False, True]]
    assert motions.repeats.all()

    def greatest(ratio: float, throw: float) -> float:
        def slope(time: float, state: list[float]) -> list[float]:
            x, v = state
            gap = np.sign(x) * max(abs(x) - 1.0, 0.0)
            bend = -amplitude * ratio**2 * np.sin(ratio * time)
            return [v, load - bend - gap - 2.0 * damping * v]

        # at rest against flanks that move as the error does
        start, period = [1.0 + throw * load, 0.0], 2.0 * np.pi / ratio
        run = solve_ivp(slope, (0.0, 30 * period), start, max_step=period / 30)
        return float(np.abs(run.y[0, run.t > 27 * period]).max()) - 1.0

    for place, ratio in enumerate(ratios):
        ends = [greatest(ratio, throw) for throw in (1.0, 3.0)]
        assert motions.alike[0, place] == (abs(ends[0] - ends[1]) < 0.01 * max(ends))
        assert motions.greatest[0, place] == pytest.approx(max(ends), rel=5e-3)
