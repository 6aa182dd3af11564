"""How the kernels are compiled: no lock, no exceptions of division, kept on disk."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from numba import njit

_OPTIONS = {"nogil": True, "cache": True, "error_model": "numpy", "_nrt": False}

kernel: Callable[..., Any] = njit(no_cfunc_wrapper=True, **_OPTIONS)
"""A kernel that Python calls. It neither allocates nor counts the users of an array."""

part: Callable[..., Any] = njit(no_cfunc_wrapper=True, no_cpython_wrapper=True, **_OPTIONS)
"""A part that only kernels call."""
