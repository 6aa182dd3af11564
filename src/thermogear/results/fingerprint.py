"""What code, what libraries and what kind of machine a stored number came from."""

from __future__ import annotations

import ctypes
import hashlib
import platform
from collections.abc import Mapping
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

import thermogear

FLOORS = ("base", "signals", "dynamics", "analysis", "gears", "heat", "mesh", "study")
LIBRARIES = ("numpy", "scipy", "numba", "xarray", "zarr")
_KERNELS = tuple(
    f"{name}get_corename{end}" for name in ("scipy_openblas_", "openblas_") for end in ("64_", "")
)


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
    """Versions of Python and the libraries that compute, and the kind of machine."""
    found = {name: version(name) for name in LIBRARIES}
    return {"python": platform.python_version(), "machine": platform.machine(), **found, **kind()}


@cache
def kind() -> dict[str, str]:
    """What decides the last digits on machines of one architecture.

    ``blas`` and ``lapack``: the libraries behind numpy and scipy with the kernel that each chose
    for this processor; ``vectors``: the instructions that numpy's loops use; ``libc``, whose
    elementary functions the compiled kernels call.
    """
    import numpy as np
    import scipy
    from numpy.linalg import _umath_linalg
    from scipy.linalg import _flapack

    def library(config: Mapping[str, Any], module: str | None) -> str:
        built = config.get("Build Dependencies", {}).get("blas", {})
        kernel = _kernel(module)
        words = [built.get("name", "unknown"), built.get("version", ""), kernel and f"({kernel})"]
        return " ".join(word for word in words if word)

    configured = np.show_config(mode="dicts")
    vectors = configured.get("SIMD Extensions", {})
    return {
        "blas": library(configured, _umath_linalg.__file__),
        "lapack": library(scipy.show_config(mode="dicts"), _flapack.__file__),
        "vectors": " ".join([*vectors.get("baseline", []), *vectors.get("found", [])]) or "unknown",
        "libc": " ".join(platform.libc_ver()).strip() or platform.version(),
    }


def _kernel(module: str | None) -> str:
    """The kernel of the OpenBLAS that a compiled ``module`` calls; "" where none says it."""
    try:
        linked = ctypes.CDLL(module)
    except OSError:
        return ""
    for name in _KERNELS:
        question = getattr(linked, name, None)
        if question is not None:
            question.restype = ctypes.c_char_p
            return str((question() or b"").decode("ascii", "replace"))
    return ""
