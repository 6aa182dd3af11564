"""The scripts of checks/ and trials/, which are no packages, as modules."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[2]


def script(name: str) -> Any:
    """``checks/<name>.py`` as a module; a name with its folder, "trials/pairs", is that of it."""
    path = ROOT / (f"{name}.py" if "/" in name else f"checks/{name}.py")
    name = path.stem if path.parent.name == "checks" else f"trial_{path.stem}"
    spec = importlib.util.spec_from_file_location(name, path)
    if spec is None or spec.loader is None:
        raise ImportError(name)
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module  # where dataclasses look their own module up
    spec.loader.exec_module(module)
    return module
