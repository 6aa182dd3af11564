"""How the kernels are compiled: no lock, no exceptions of division, kept on disk."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from numba import njit

kernel: Callable[..., Any] = njit(nogil=True, cache=True, error_model="numpy")
"""A kernel that Python calls."""

part: Callable[..., Any] = njit(
    nogil=True, cache=True, error_model="numpy", _nrt=False, no_cpython_wrapper=True,
    no_cfunc_wrapper=True,
)  # fmt: skip
"""A part that only kernels call: it neither allocates nor counts the users of an array."""
