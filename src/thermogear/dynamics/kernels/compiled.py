"""How the kernels are compiled: no lock, no exceptions of division, kept on disk.

They neither allocate nor count the users of an array: counting costs more than a short sum. So
what they work on is given to them, flat.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar, cast

import numba

from thermogear.base.kernel_cache import rebuilt

_Function = TypeVar("_Function", bound=Callable[..., object])

_njit: Any = numba.njit
_OPTIONS = {"nogil": True, "cache": True, "error_model": "numpy", "_nrt": False}


def kernel(function: _Function) -> _Function:
    """Compile what Python calls."""
    return rebuilt(cast(_Function, _njit(no_cfunc_wrapper=True, **_OPTIONS)(function)))


def part(function: _Function) -> _Function:
    """Compile what only kernels call."""
    alone = {"no_cfunc_wrapper": True, "no_cpython_wrapper": True}
    return rebuilt(cast(_Function, _njit(**alone, **_OPTIONS)(function)))


def small(function: _Function) -> _Function:
    """Compile what only kernels call, often: its code is put where it is called.

    A call hands over every array of a tuple, which costs more than a short function.
    """
    alone = {"no_cfunc_wrapper": True, "no_cpython_wrapper": True, "forceinline": True}
    return rebuilt(cast(_Function, _njit(**alone, **_OPTIONS)(function)))
