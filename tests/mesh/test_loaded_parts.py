"""The springs that the loaded contact stores: where one pair carries all, they are the mesh's."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from thermogear import GearPair, MeshModel, Operating
from thermogear.gears.contact import path_of_contact
from thermogear.mesh.elastic import LoadedPair, TextbookPair, elastic_pair
from thermogear.mesh.thermal import HotPair


def test_springs_of_the_loaded_pair(rig: GearPair, hot_rig: Operating) -> None:
    """Tooth springs are the textbook's; all in series are the secant stiffness of one pair."""
    cold = replace(hot_rig, temperatures=hot_rig.temperatures.cold())
    model = MeshModel.consistent()
    loaded = elastic_pair(HotPair(rig, cold, model))
    assert isinstance(loaded, LoadedPair)
    s = path_of_contact(rig, 41)
    parts = loaded.parts(s)
    tooth = TextbookPair(loaded.hot).parts(s)
    for name, k in parts.items():
        assert np.all(np.isfinite(k) & (k > 0.0))
        if not name.endswith(("body_stiffness", "hertz_stiffness")):
            assert k == pytest.approx(tooth[name], rel=1e-12)
    series = 1.0 / sum(1.0 / k for k in parts.values())
    # corner contact lets neighbours help a little outside the single contact's ends
    alone = np.flatnonzero(np.all(loaded.share(s) > 1.0 - 1e-12, axis=0))
    assert alone.size >= 3
    secant = loaded.solve((s[alone] - rig.path.a) / rig.base_pitch).secant
    assert series[:, alone] == pytest.approx(secant, rel=1e-6)
