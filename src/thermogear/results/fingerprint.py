"""What code, what libraries and what kind of machine a stored number came from."""

from __future__ import annotations

import hashlib
import platform
from functools import cache
from importlib.metadata import version
from pathlib import Path

import thermogear

FLOORS = ("base", "signals", "dynamics", "analysis", "gears", "heat", "mesh", "study")
LIBRARIES = ("numpy", "scipy", "numba", "xarray", "zarr")


@cache
def code_version() -> str:
    """Version and a hash of every source file that numbers can depend on."""
    digest = hashlib.sha256()
    root = Path(thermogear.__file__).parent
    for floor in FLOORS:
        for path in sorted((root / floor).rglob("*.py")):
            digest.update(path.relative_to(root).as_posix().encode())
            digest.update(path.read_bytes())
    return f"{thermogear.__version__}+{digest.hexdigest()[:16]}"


@cache
def environment() -> dict[str, str]:
    """Versions of Python and the libraries that compute, and the architecture of the machine."""
    found = {name: version(name) for name in LIBRARIES}
    return {"python": platform.python_version(), "machine": platform.machine(), **found}
