"""Small cases of every command: for ``checks/same.py``."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True)
class Case:
    """Commands carried out one after another in a folder of their own.

    ``steps``: words after ``thermogear``, as a shell splits them; ``files``: what stands in the
    folder beforehand; ``before``: the steps of the reference, where its words were others.
    """

    name: str
    steps: tuple[str, ...]
    files: Mapping[str, str | bytes] = field(default_factory=dict)
    before: tuple[str, ...] | None = None


FEW = (
    "--set grid.mesh_positions=48 --set grid.harmonics=12 --set grid.path_positions=41 "
    "--set simulation.periods=16 --set simulation.discard=40 --set simulation.most_discarded=400 "
    "--set simulation.steps_per_period=128 --set simulation.samples=32 "
    "--set simulation.sample_periods=2"
)
"""A run's grids made small."""
RIG = """--set 'draw.base_sets=[]'"""

CASES = (
    Case(
        "run-rig",
        (f"""run rig -o out --json {FEW} {RIG} --set 'operating.speed=["1000 rpm","3000 rpm"]'""",),
    ),
    Case(
        "orbit-dimensionless", ("orbit table-4.2 --row zeta --point 2 -o out --json",)
    ),
    Case("orbit-gear", ("orbit rig --operating 2 -o out --json",)),
    Case("relief", ("relief rig -o out --json",)),
    Case("runup", ("runup rig --rpm 2000:9000:8 -o out --json --threads 1",)),
    Case("sweep", ("sweep rig --over rpm=2000:9000:5 --over temperature=20,140 -o out --json",)),
    Case("map-gear", ("map rig --over rpm=2000:9000:6 --over torque=50:200:4 -o out --json",)),
    Case(
        "map-dimensionless",
        ("map table-4.2 --over zeta=0.1:0.18:6 --over omega=1.1:1.3:6 -o out --json",),
    ),
)
