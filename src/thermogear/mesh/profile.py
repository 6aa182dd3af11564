"""The tooth's flank cold and hot; where it is asked for also hot as printed."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from thermogear.base.arrays import Dataset
from thermogear.base.vocabulary import label
from thermogear.gears.pair import GearPair
from thermogear.heat.thesis_profile import profile_as_printed
from thermogear.mesh.model import MeshModel
from thermogear.mesh.operating import Operating
from thermogear.mesh.thermal import HotPair

POINTS = 61


def profiles(pair: GearPair, operating: Operating, *, printed: bool) -> Dataset:
    """One flank of each gear, from form circle to tip form circle: coordinates [m].

    y is the tooth's centre line. The first operating point's temperatures hold. ``consistent`` is
    the hot profile; where it is asked for, ``printed`` the one with the angle as printed (whose
    second term carries 1/K).
    """
    hot = HotPair(pair, operating, MeshModel.consistent())
    columns: dict[str, list[NDArray[np.float64]]] = {}
    for gear in (pair.pinion, pair.wheel):
        r = np.linspace(max(gear.form_radius, gear.base_radius), gear.tip_form_radius, POINTS)
        psi = gear.half_thickness_angle(r)
        drawn = {"involute": (r, psi), "consistent": hot.grown(gear, r, psi)}
        if printed:
            drawn["printed"] = profile_as_printed(gear, hot.field(gear), r)
        for name, curve in drawn.items():
            radius, angle = (np.atleast_2d(v)[0] for v in curve)
            columns.setdefault(f"{name}_x", []).append(radius * np.sin(angle))
            columns.setdefault(f"{name}_y", []).append(radius * np.cos(angle))
    words = {
        "involute": "cold involute",
        "printed": "hot profile as printed",
        "consistent": "hot profile",
    }
    data = label(
        {
            name: (
                ("gear", "profile_point"),
                np.stack(rows),
                "m",
                f"{words[name[:-2]]}, {name[-1]}",
            )
            for name, rows in columns.items()
        },
        {"gear": ["pinion", "wheel"]},
    )
    return data.assign_attrs(magnification=1)
