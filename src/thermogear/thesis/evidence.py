"""What the claims are judged by: the package's own results, computed once and kept.

Everything comes from public modules: a run of the ready-made rig with its base sets, the chain
over speed and torque, the diagrams and bifurcations of the equation of motion, the published
table of the tests.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

from thermogear.base.arrays import Dataset
from thermogear.base.errors import InputError, ValidityWarning
from thermogear.base.progress import Progress, silent
from thermogear.case.case import DimensionlessCase, GearCase, gear_case, load_example
from thermogear.measured.comparison import Comparison
from thermogear.mesh.model import MeshModel
from thermogear.results.result import Result
from thermogear.study.compare import compare
from thermogear.study.run import run
from thermogear.study.sensitivity import Plan, sensitivity
from thermogear.thesis import base_sets, chain, experiment, motions
from thermogear.thesis.errata import with_errata

STAGES = (
    "the rig, from friction to motion",
    "speed and torque",
    "bifurcation diagrams",
    "bifurcation points",
    "temperature row",
    "table of the tests",
    "sensitivity",
    "drive trains of the rig",
    "verdicts",
)


@dataclass(frozen=True, kw_only=True)
class Size:
    """How much is computed; a small one answers every claim too, on coarser grids."""

    speeds: int = 6
    torques: int = 4
    diagram: int = 241
    flips: int = 4
    samples: int = 128


@dataclass(frozen=True, eq=False)
class Evidence:
    """Results by name, each computed when first asked for."""

    size: Size = field(default_factory=Size)
    progress: Progress = silent

    def finished(self, name: str) -> bool:
        """Whether the result ``name`` is there already."""
        return name in vars(self)

    def _tell(self, stage: str) -> None:
        self.progress(stage, STAGES.index(stage), len(STAGES))

    @cached_property
    def case(self) -> GearCase:
        """The ready-made case of the thesis's rig."""
        return gear_case(load_example("rig"))

    def rows(self, name: str) -> DimensionlessCase:
        """A ready-made case of the dimensionless equation."""
        case = load_example(name)
        if not isinstance(case, DimensionlessCase):
            raise InputError("example", name, why="it is no dimensionless case")
        return case

    @cached_property
    def result(self) -> Result:
        """The run of the rig, base sets and errata included."""
        self._tell(STAGES[0])
        return with_errata(run(self.case), self.case)

    @property
    def groups(self) -> Mapping[str, Dataset]:
        """The run's groups by their path."""
        return self.result.groups

    def bundle(self, group: str, name: str, state: str = "hot") -> Dataset:
        """One bundle of a group of the run in one state."""
        return self.groups[group].sel(bundle=name, state=state)

    @cached_property
    def grid(self) -> Dataset:
        """Friction, flash and growth over speed and torque; see :func:`chain.operating_grid`."""
        self._tell(STAGES[1])
        with warnings.catch_warnings(action="ignore", category=ValidityWarning):
            # the closed loop's oil may leave its line's range at the corners; the page says so
            return chain.operating_grid(
                self.case, speeds=self.size.speeds, torques=self.size.torques
            )

    @cached_property
    def diagrams(self) -> dict[str, Dataset]:
        """Orbit diagrams over zeta, omega_h and epsilon, by "parameter/heat"."""
        self._tell(STAGES[2])
        return motions.diagrams(self.row_points, self.size.diagram)

    @cached_property
    def flips(self) -> Dataset:
        """The located period doublings of every diagram."""
        self._tell(STAGES[3])
        return motions.flips(self.row_points, self.size.flips)

    @cached_property
    def row_points(self) -> motions.Rows:
        """The base set, its ranges, and what heat adds to it."""
        return motions.rows(self.rows("table-4.2"), self.rows("section-4.1"))

    @cached_property
    def base_sets(self) -> list[base_sets.Judged]:
        """Base sets that meet table 4.2, sampled, each with the statements that hold for it."""
        return base_sets.stored()

    @cached_property
    def warming(self) -> Dataset:
        """The temperature row with multipliers, and where its flip lies."""
        self._tell(STAGES[4])
        return motions.warming(self.rows("section-4.1"))

    @cached_property
    def comparison(self) -> Comparison:
        """The thesis's table of section 5.2 recomputed."""
        self._tell(STAGES[5])
        return compare("thesis-5.2")

    @cached_property
    def sensitivity(self) -> Result:
        """Which unstated input decides which conclusion."""
        self._tell(STAGES[6])
        plan = Plan(samples=self.size.samples)
        return sensitivity(self.case, plan)

    @cached_property
    def rig_trains(self) -> Dataset:
        """What accelerometers show on drive trains that the rig could have been."""
        self._tell(STAGES[7])
        return experiment.stored()

    @cached_property
    def two_gears(self) -> dict[str, float]:
        """Both rotations against the single equation."""
        return chain.two_gears_against_one(self.case)

    @cached_property
    def fit(self) -> dict[str, float]:
        """The face width at which the textbook stiffness meets the printed mid-range."""
        return chain.width_of_printed_stiffness(self.case)

    @cached_property
    def textbook(self) -> MeshModel:
        """The thesis's bundle."""
        return MeshModel.thesis()

    @cached_property
    def contact_at_a(self) -> dict[str, float]:
        """The contact at A, first operating point, hot, consistent bundle, oil as supplied (SI)."""
        here = self.bundle("path", "consistent").isel(operating=0, path_position=0)
        supplied = self.bundle("mesh", "thesis").isel(operating=0)
        shared = self.groups["path"].isel(operating=0, path_position=0)
        pair = self.case.pair
        return {
            "load": float(here["line_load"]),
            "v1": float(shared["pinion_rolling_velocity"]),
            "v2": float(shared["wheel_rolling_velocity"]),
            "width": float(here["hertz_half_width"]),
            "friction": float(here["friction_coefficient_mixed"]),
            "viscosity": float(supplied["dynamic_viscosity"]),
            "roughness": 0.5 * (pair.pinion.roughness + pair.wheel.roughness),
            "b1": pair.pinion.material.thermal_contact_coefficient,
            "b2": pair.wheel.material.thermal_contact_coefficient,
            "radius": float(shared["reduced_radius"]),
        }
