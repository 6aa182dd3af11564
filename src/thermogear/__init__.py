"""thermogear: dynamics of spur gear pairs that get hot.

The public names are loaded when first used, so that importing the package is cheap.
"""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:  # nothing is loaded here before the command line answers signals
    from typing import Any

__version__ = "0.1.0"

_HOME = {
    "ThermogearError": "thermogear.base.errors",
    "InputError": "thermogear.base.errors",
    "GeometryError": "thermogear.base.errors",
    "ConvergenceError": "thermogear.base.errors",
    "ValidityWarning": "thermogear.base.errors",
    "Material": "thermogear.base.materials",
    "Lubricant": "thermogear.base.materials",
    "material": "thermogear.base.materials",
    "lubricant": "thermogear.base.materials",
    "Periodic": "thermogear.base.excitation",
    "Excitation": "thermogear.base.excitation",
    "Gear": "thermogear.gears.geometry",
    "GearPair": "thermogear.gears.pair",
    "Rack": "thermogear.gears.geometry",
    "Relief": "thermogear.gears.deviations",
    "BasePitchDifference": "thermogear.gears.deviations",
    "PitchError": "thermogear.gears.deviations",
    "Eccentricity": "thermogear.gears.turn",
    "ToothShapes": "thermogear.gears.turn",
    "Population": "thermogear.gears.population",
    "drawn_pair": "thermogear.gears.population",
    "film_thickness": "thermogear.heat.film",
    "friction_law": "thermogear.heat.friction",
    "flash_temperature": "thermogear.heat.moving_source",
    "radial_temperature": "thermogear.heat.temperature",
    "thermal_network": "thermogear.heat.gearbox",
    "MeshModel": "thermogear.mesh.model",
    "Operating": "thermogear.mesh.operating",
    "Temperatures": "thermogear.mesh.operating",
    "mesh_cycle": "thermogear.mesh.cycle",
    "excitation": "thermogear.mesh.excite",
    "TorsionalModel": "thermogear.dynamics.models",
    "GearedModel": "thermogear.dynamics.geared",
    "ReturnMap": "thermogear.dynamics.return_map",
    "IteratedMap": "thermogear.dynamics.return_map",
    "SmoothModel": "thermogear.dynamics.smooth_map",
    "PairModel": "thermogear.dynamics.models",
    "simulate": "thermogear.dynamics.integrate",
    "periodic_orbit": "thermogear.analysis.orbits",
    "continuation": "thermogear.analysis.continuation",
    "lyapunov_exponent": "thermogear.analysis.lyapunov",
    "label": "thermogear.analysis.labels",
    "LoadedModel": "thermogear.gears.loaded",
    "loaded_contact": "thermogear.gears.loaded",
    "Gearbox": "thermogear.mesh.balance",
    "Surroundings": "thermogear.heat.gearbox",
    "heat_balance": "thermogear.mesh.balance",
    "warm_up": "thermogear.mesh.warm_up",
    "Duty": "thermogear.mesh.warm_up",
    "orbit_diagram": "thermogear.analysis.diagram",
    "parameter_map": "thermogear.analysis.maps",
    "basins": "thermogear.analysis.basins",
    "basin_shares": "thermogear.analysis.basin_shares",
    "slices": "thermogear.base.plan",
    "run_up": "thermogear.study.run_up",
    "sweep": "thermogear.study.sweep",
    "load_case": "thermogear.case.case",
    "read_rexs": "thermogear.case.rexs.container",
    "family": "thermogear.case.family",
    "run": "thermogear.study.run",
    "drawing": "thermogear.study.drawing",
    "answers": "thermogear.study.answers.survey",
    "sensitivity": "thermogear.study.sensitivity",
    "Result": "thermogear.results.result",
    "open_results": "thermogear.results.result",
    "save": "thermogear.views.write",
    "save_results": "thermogear.views.write",
    "write_report": "thermogear.views.write",
    "pictures": "thermogear.views.write",
    "statics": "thermogear.study.shafts.statics",
    "modes": "thermogear.study.shafts.modes",
    "campbell": "thermogear.study.shafts.campbell",
    "waterfall": "thermogear.study.shafts.waterfall",
    "relief_survey": "thermogear.study.relief",
    "warm_up_survey": "thermogear.study.warm_up",
    "read_duty": "thermogear.case.duty",
    "read_measured": "thermogear.case.duty",
    "read_record": "thermogear.measured.readers",
    "Chain": "thermogear.measured.chain",
    "measure": "thermogear.measured.reduction",
    "compare": "thermogear.study.compare",
}

__all__ = ["__version__", *_HOME]


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'thermogear' has no attribute {name!r}")
    import importlib

    return getattr(importlib.import_module(_HOME[name]), name)


def __dir__() -> list[str]:
    return sorted(__all__)
