"""What a gear that is not known makes of a line's phase: drawn phases, true waves and none."""

import numpy as np
import pytest

from thermogear.measured.mate import Wave, wave_of_mate

TEETH = 30


def drawn(number: int, wave: float, walk: float) -> tuple[Wave, float, float]:
    """A speed that walks by ``walk`` cycles in the record and a mate whose ``wave`` [rad] turns
    the phase: what is found, the variance of that wave and the mate's turns."""
    random = np.random.default_rng([58_2026, number])
    nearest, ratio = random.uniform(14.0, 150.0), random.uniform(1.3, 2.9)
    turn = np.linspace(0.0, nearest, int(nearest * TEETH * 4))
    path = np.cumsum(random.standard_normal(turn.size)) / np.sqrt(turn.size)
    # a path of the speed: once more summed, it is that of the phase
    path = walk * np.cumsum(path - path.mean()) / turn.size
    phase = wave * np.cos(2.0 * np.pi * turn / ratio + random.uniform(0.0, 2.0 * np.pi))
    noise = 1e-4 * random.standard_normal(turn.size)
    cycles = TEETH * turn + path + phase / (2.0 * np.pi) + noise
    return wave_of_mate(cycles, nearest), 0.5 * wave**2, nearest / ratio


@pytest.mark.parametrize("walk", [0.0, 1.0, 10.0])
def test_a_wave_is_found_beside_a_speed_that_walks(walk: float) -> None:
    found = [one for one in (drawn(number, 0.2, walk) for number in range(40)) if one[0].sharp]
    assert len(found) == 40
    more = 0.6 if walk > 5.0 else 0.1  # what the speed holds there counts, too
    assert all(-0.1 < wave.power / true - 1.0 < more for wave, true, _ in found)
    assert max(abs(wave.turns - turns) for wave, _, turns in found) <= 0.25


@pytest.mark.parametrize("walk", [0.0, 1.0, 10.0])
def test_a_speed_that_walks_makes_no_wave_to_speak_of(walk: float) -> None:
    found = [drawn(number, 0.0, walk)[0] for number in range(100)]
    assert sum(wave.power > 0.002 for wave in found) <= (3 if walk > 5.0 else 0)


def test_few_turns_count_what_the_best_wave_explains() -> None:
    turn = np.linspace(0.0, 5.0, 3000)
    wave = wave_of_mate(TEETH * turn + 0.05 * np.sin(np.pi * turn), 5.0)
    assert (wave.sharp, wave.turns) == (False, pytest.approx(2.5, abs=0.3))
    assert wave.power == pytest.approx(0.5 * (2.0 * np.pi * 0.05) ** 2, rel=0.1)
    assert wave.words(150.0) == ""


def test_a_far_wander_counts_as_no_more_than_sidebands_of_a_fifth() -> None:
    turn = np.linspace(0.0, 5.0, 3000)
    assert wave_of_mate(TEETH * turn + 3.0 * np.sin(np.pi * turn), 5.0).power == 0.1
