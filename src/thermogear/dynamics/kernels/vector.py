"""Horner's rule on eight lanes at once.

Loops over a handful of lanes are left scalar by the compiler, and numba has no vector type, so
the few vector instructions that count are written out here; any processor can run them.
"""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

EIGHT = 8


def _horner(_context: Any, coefficients: Any, u: Any, out: Any) -> Any:
    """p, p' and p''/2 of eight polynomials: coefficients (K + 1, 8), u (8) -> out (3, 8).

    All three contiguous float64; row m of the coefficients multiplies u**m.
    """

    def generate(context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        kind = ir.VectorType(ir.DoubleType(), EIGHT)
        index = ir.IntType(64)
        tools: Any = cgutils  # its functions carry no types

        def array(position: int) -> tuple[Any, Any]:
            given = (coefficients, u, out)[position]
            proxy = tools.create_struct_proxy(given)(context, builder, arguments[position])
            return builder.bitcast(proxy.data, kind.as_pointer()), proxy.shape

        (rows, shape), (at, _), (end, _) = array(0), array(1), array(2)
        count = tools.unpack_tuple(builder, shape)[0]
        x = builder.load(at, align=8)
        nothing = ir.Constant(kind, [0.0] * EIGHT)
        value, slope, bend = (tools.alloca_once_value(builder, nothing) for _ in range(3))
        with tools.for_range(builder, count) as loop:
            row = builder.sub(builder.sub(count, index(1)), loop.index)
            p, d = builder.load(value), builder.load(slope)
            part = builder.load(builder.gep(rows, [row]), align=8)
            builder.store(builder.fadd(builder.fmul(builder.load(bend), x), d), bend)
            builder.store(builder.fadd(builder.fmul(d, x), p), slope)
            builder.store(builder.fadd(builder.fmul(p, x), part), value)
        for number, state in enumerate((value, slope, bend)):
            place = builder.gep(end, [index(number)])
            builder.store(builder.load(state), place, align=8)
        return context.get_dummy_value()

    return types.void(coefficients, u, out), generate


horner: Any = intrinsic(_horner)
