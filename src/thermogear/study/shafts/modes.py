"""The lowest modes of a drive train: how often, which part bends, how much the teeth move."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from thermogear.base.arrays import Dataset
from thermogear.base.progress import Progress, silent
from thermogear.base.vocabulary import label
from thermogear.case.case import GearCase
from thermogear.case.one_point import counted
from thermogear.results.result import Result
from thermogear.shafts.linear import LinearTrain, Modes, damping_ratios, strain_shares, whirl
from thermogear.shafts.train import SHAFTS
from thermogear.study.declared import NaturalModes, declared
from thermogear.study.shafts.sketch import sketch
from thermogear.study.shafts.state import TrainState, plan_of, settled
from thermogear.study.shafts.statics import notices

MODE = ("state", "mode")


@declared(NaturalModes)
def modes(
    case: GearCase,
    *,
    operating: int | None = None,
    count: int = NaturalModes.count,
    progress: Progress = silent,
) -> Result:
    """The ``count`` lowest modes of a case's drive train at one operating point, cold and hot.

    ``operating`` counts from 1 in the order of the file, the hardest if left out. The contacts are
    springs at the equilibrium, the mesh at its mean stiffness. Groups: ``modes`` over (state,
    mode) with frequency [rad/s], damping ratio, whirl and the share of every part in the strain
    energy; ``shapes`` of both shafts along their length. Raises InputError for a case without
    shafts, and where the point has no equilibrium.
    """
    at = case.stated
    hardest = int(np.argmax(at.speed * at.torque))
    most = at.speed.size
    place = hardest if operating is None else counted("operating", operating, most=most)
    found = [row[0] for row in settled(case, [place], progress=progress)]
    linear = [one.linear for one in found]
    free = [one.modes(state.speed, count=count) for one, state in zip(linear, found, strict=True)]
    return Result.of(
        NaturalModes.kind,
        f"Modes of the drive train: {case.title}",
        {
            "modes": _table(linear, found, free, bearing_parts(case)),
            "shapes": _shapes(linear, free, found),
        },
        notices(case, [[one] for one in found]),
        **case.provenance,
        bundle=case.models[0].name,
        speed=found[0].speed,
        torque=found[0].torque,
        train=sketch(plan_of(case).drive_train(pair=case.pair), case.pair),
    )


def name_of(shares: Mapping[str, float], bearings: Mapping[str, str]) -> str:
    """The part with most strain energy, and the next where it has much too.

    ``bearings``: the shaft of each bearing by its part's name; those of one shaft count together.
    """
    joined: dict[str, float] = {}
    for part, share in shares.items():
        whole = f"{bearings[part]} bearings" if part in bearings else part
        joined[whole] = joined.get(whole, 0.0) + share
    first, second = sorted(joined, key=lambda name: -joined[name])[:2]
    return f"{first} and {second}" if joined[second] > 0.6 * joined[first] else first


def bearing_parts(case: GearCase) -> dict[str, str]:
    """The shaft of every bearing by the name of its part."""
    return {f"bearing {one.name}": one.shaft for one in plan_of(case).bearings}


def _table(
    linear: Sequence[LinearTrain],
    found: Sequence[TrainState],
    free: Sequence[Modes],
    rings: Mapping[str, str],
) -> Dataset:
    shares = [strain_shares(one, m.shape) for one, m in zip(linear, free, strict=True)]
    parts = list(shares[0])
    energy = np.array([[one[part] for part in parts] for one in shares]).swapaxes(1, 2)
    senses = [whirl(one.assembly, m.shape) for one, m in zip(linear, free, strict=True)]
    ratio = [
        damping_ratios(a, m.shape, frequency=m.frequency) for a, m in zip(linear, free, strict=True)
    ]
    names = [
        [name_of(dict(zip(parts, mode, strict=True)), rings) for mode in one] for one in energy
    ]
    variables = {
        "natural_frequency": (
            MODE,
            [m.frequency for m in free],
            "rad/s",
            "natural frequency",
        ),
        "modal_damping_ratio": (MODE, ratio, "1", "damping ratio of the mode"),
        "mesh_share": (MODE, energy[..., parts.index("mesh")], "1", "strain energy in the teeth"),
        "energy_share": ((*MODE, "part"), energy, "1", "share of the strain energy"),
        "mode_name": (MODE, names),
    }
    for shaft in SHAFTS:
        variables[f"{shaft}_whirl"] = (
            MODE,
            [one[shaft] for one in senses],
            "1",
            f"whirl of the {shaft}'s shaft: 1 forward, -1 backward, 0 in one plane",
        )
    count = free[0].frequency.size
    places = {
        "state": [one.state.kind for one in found],
        "part": parts,
        "mode": (("mode",), np.arange(1, count + 1), "1", "number of the mode"),
    }
    return label(variables, places)


def _shapes(
    linear: Sequence[LinearTrain], free: Sequence[Modes], found: Sequence[TrainState]
) -> Dataset:
    """Shapes of both shafts, scaled so that the largest of x, y and r_b tz is 1."""
    assembly = linear[0].assembly
    radii = assembly.frame.base_radii
    variables: dict[str, Any] = {}
    places: dict[str, Any] = {"state": [one.state.kind for one in found]}
    kinds = ("x", "y", "tz")
    rows = {}
    for number, shaft in enumerate(SHAFTS):
        nodes = range(assembly.nodes[number].size)
        rows[shaft] = np.array([[assembly.index[f"{shaft}.{i}.{c}"] for i in nodes] for c in kinds])
    shapes = [_real(m.shape) for m in free]
    sizes = [
        np.max(
            [
                np.abs(shape[rows[shaft][k]]).max(axis=0) * (radii[n] if k == 2 else 1.0)
                for n, shaft in enumerate(SHAFTS)
                for k in range(3)
            ],
            axis=0,
        )
        for shape in shapes
    ]
    for number, shaft in enumerate(SHAFTS):
        for k, kind in enumerate(("x", "y", "twist")):
            scale = radii[number] if kind == "twist" else 1.0
            values = [
                scale * (shape[rows[shaft][k]] / size).T
                for shape, size in zip(shapes, sizes, strict=True)
            ]
            words = f"{shaft}'s shaft, " + (
                "twist times base radius" if kind == "twist" else f"deflection along {kind}"
            )
            for part, name in ((np.real, "real"), (np.imag, "imaginary")):
                variables[f"{shaft}_{kind}_{name}"] = (
                    (*MODE, f"{shaft}_position"),
                    part(np.array(values)),
                    "1",
                    f"{words}, {name} part, over the largest of all",
                )
        along = assembly.nodes[number]
        places[f"{shaft}_position"] = (
            (f"{shaft}_position",),
            along - along[assembly.gear_nodes[number]],
            "m",
            "distance along the shaft from the middle of the gear",
        )
    return label(variables, places)


def _real(shape: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """Every mode turned in phase so that its real part is as large as can be."""
    turn = 0.5 * np.angle(np.sum(shape**2, axis=0))
    return np.asarray(shape * np.exp(-1j * turn))
