"""A trajectory set down on an unstable orbit stays for long; no label may take it for settled."""

import numpy as np
import pytest

from thermogear.analysis.labels import label
from thermogear.analysis.orbits import periodic_orbit
from thermogear.dynamics.models import TorsionalModel

BASE = TorsionalModel(
    damping_ratio=0.1535,
    frequency=1.245,
    stiffness_amplitude=0.335,
    mean_force=0.017,
    force_amplitude=-1.16,
)


@pytest.mark.parametrize(
    ("damping", "name"), [(0.168, "period-2"), (0.165, "period-2"), (0.16, "period-2")]
)
def test_the_label_is_of_the_stable_motion_it_leaves_for(damping, name):
    model = BASE.replace(damping_ratio=damping)
    orbit = periodic_orbit(model, 1, (1.08, -0.25))
    assert orbit.multipliers[0].real < -1.0
    # a trillionth beside it: exactly on it, rounding alone may hold it there for ever
    start = np.asarray(orbit.state) + np.array([1e-12, 0.0])
    found = label(model, initial_state=start, discard=20)
    assert str(found) == name
    assert np.max(np.abs(found.multipliers)) < 1.0
