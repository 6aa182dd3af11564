"""Eight lanes as one number: a vector type for compiled code.

Loops over a handful of lanes are left scalar by the compiler, and numba has no vector type, so one
is given here. ``Eight`` (eight float64) takes + - * / with its like and with a float, ``abs`` and
comparisons; those give ``Flags``, which take & | ~. Every operation is done lane by lane and
rounded once: a lane gives the same bits in any company and on any processor.
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any, ClassVar

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.typing import templates
from numba.extending import intrinsic, models, register_model
from numba.extending import lower_builtin as _lower_builtin

EIGHT = 8
Emit = Callable[..., Any]

_DOUBLE = ir.DoubleType()
_NUMBERS = ir.VectorType(_DOUBLE, EIGHT)
_BITS = ir.VectorType(ir.IntType(1), EIGHT)
_INDEX = ir.IntType(64)
_WORDS = ir.VectorType(_INDEX, EIGHT)
# their functions carry no types
_tools: Any = cgutils
_typing: Any = templates
_lower: Any = _lower_builtin


class Eight(types.Type):
    """Eight float64 side by side."""


class Flags(types.Type):
    """Eight truth values side by side."""


_kind: Any = Eight
eight = _kind("Eight")
_kind = Flags
flags = _kind("Flags")


def _model(kind: type[types.Type], back: ir.Type) -> None:
    class Model(models.PrimitiveModel):
        def __init__(self, manager: Any, front: Any) -> None:
            super().__init__(manager, front, back)  # type: ignore[no-untyped-call]

    register_model(kind)(Model)


_model(Eight, _NUMBERS)
_model(Flags, _BITS)


def _widened(builder: Any, value: Any) -> Any:
    """A float in all eight places."""
    if value.type == _NUMBERS:
        return value
    if isinstance(value, ir.Constant):
        return ir.Constant(_NUMBERS, [value.constant] * EIGHT)
    one = builder.insert_element(ir.Constant(_NUMBERS, ir.Undefined), value, _INDEX(0))
    spread = ir.Constant(ir.VectorType(ir.IntType(32), EIGHT), [0] * EIGHT)
    return builder.shuffle_vector(one, one, spread)


def _operator(
    function: Callable[..., Any], operands: list[tuple[Any, ...]], result: Any, emit: Emit
) -> None:
    """Teach numba ``function`` of these operands."""

    class Typing(_typing.ConcreteTemplate):  # type: ignore[misc]
        cases: ClassVar = [_typing.signature(result, *given) for given in operands]

    _typing.infer_global(function)(Typing)

    def lowered(_context: Any, builder: Any, sig: Any, given: Any) -> Any:
        if sig.args[0] is not flags:
            given = [_widened(builder, value) for value in given]
        return emit(builder, *given)

    for kinds in operands:
        _lower(function, *kinds)(lowered)


_TWO = [(eight, eight), (eight, types.float64), (types.float64, eight)]

_operator(operator.add, _TWO, eight, lambda b, x, y: b.fadd(x, y))
_operator(operator.sub, _TWO, eight, lambda b, x, y: b.fsub(x, y))
_operator(operator.mul, _TWO, eight, lambda b, x, y: b.fmul(x, y))
_operator(operator.truediv, _TWO, eight, lambda b, x, y: b.fdiv(x, y))
_operator(operator.neg, [(eight,)], eight, lambda b, x: b.fneg(x))
_operator(
    abs,
    [(eight,)],
    eight,
    lambda b, x: b.bitcast(b.and_(b.bitcast(x, _WORDS), _WORDS([2**63 - 1] * EIGHT)), _NUMBERS),
)
_operator(operator.lt, _TWO, flags, lambda b, x, y: b.fcmp_ordered("<", x, y))
_operator(operator.le, _TWO, flags, lambda b, x, y: b.fcmp_ordered("<=", x, y))
_operator(operator.gt, _TWO, flags, lambda b, x, y: b.fcmp_ordered(">", x, y))
_operator(operator.ge, _TWO, flags, lambda b, x, y: b.fcmp_ordered(">=", x, y))
_operator(operator.eq, _TWO, flags, lambda b, x, y: b.fcmp_ordered("==", x, y))
_operator(operator.ne, _TWO, flags, lambda b, x, y: b.fcmp_unordered("!=", x, y))
_operator(operator.and_, [(flags, flags)], flags, lambda b, x, y: b.and_(x, y))
_operator(operator.or_, [(flags, flags)], flags, lambda b, x, y: b.or_(x, y))
_operator(operator.xor, [(flags, flags)], flags, lambda b, x, y: b.xor(x, y))
_operator(operator.invert, [(flags,)], flags, lambda b, x: b.not_(x))


def _start(context: Any, builder: Any, kind: Any, array: Any) -> Any:
    """Pointer to the first number of a contiguous array."""
    return _tools.create_struct_proxy(kind)(context, builder, array).data


def _numbers_at(builder: Any, start: Any, at: Any) -> Any:
    """Pointer to eight numbers from the flat index ``at``."""
    return builder.bitcast(builder.gep(start, [at]), _NUMBERS.as_pointer())


def _load(_context: Any, array: Any, at: Any) -> Any:
    """Eight numbers of a contiguous array from its flat index ``at``."""

    def generate(context: Any, builder: Any, _signature: Any, given: Any) -> Any:
        start = _start(context, builder, array, given[0])
        return builder.load(_numbers_at(builder, start, given[1]), align=8)

    return eight(array, types.int64), generate


def _store(_context: Any, array: Any, at: Any, value: Any) -> Any:
    """Put eight numbers into a contiguous array at its flat index ``at``."""

    def generate(context: Any, builder: Any, _signature: Any, given: Any) -> Any:
        start = _start(context, builder, array, given[0])
        builder.store(given[2], _numbers_at(builder, start, given[1]), align=8)
        return context.get_dummy_value()

    return types.void(array, types.int64, eight), generate


def _pick(_context: Any, array: Any, base: Any, places: Any, first: Any) -> Any:
    """The numbers of a contiguous array at ``base`` + each of eight ``places`` from ``first``."""

    def generate(context: Any, builder: Any, _signature: Any, given: Any) -> Any:
        start = builder.gep(_start(context, builder, array, given[0]), [given[1]])
        index = _start(context, builder, places, given[2])
        index = builder.gep(index, [given[3]])
        found = ir.Constant(_NUMBERS, ir.Undefined)
        for k in range(EIGHT):
            place = builder.load(builder.gep(index, [_INDEX(k)]))
            number = builder.load(builder.gep(start, [place]))
            found = builder.insert_element(found, number, _INDEX(k))
        return found

    return eight(array, types.int64, places, types.int64), generate


def _drop(_context: Any, array: Any, base: Any, places: Any, value: Any) -> Any:
    """Put eight numbers into a contiguous array at ``base`` + each of eight flat ``places``."""

    def generate(context: Any, builder: Any, _signature: Any, given: Any) -> Any:
        start = builder.gep(_start(context, builder, array, given[0]), [given[1]])
        index = _start(context, builder, places, given[2])
        for k in range(EIGHT):
            place = builder.load(builder.gep(index, [_INDEX(k)]))
            number = builder.extract_element(given[3], _INDEX(k))
            builder.store(number, builder.gep(start, [place]))
        return context.get_dummy_value()

    return types.void(array, types.int64, places, eight), generate


def _choose(_context: Any, flag: Any, one: Any, other: Any) -> Any:
    """``one`` where the flag stands, else ``other``."""

    def generate(_context: Any, builder: Any, _signature: Any, given: Any) -> Any:
        picked = [_widened(builder, value) for value in given[1:]]
        return builder.select(given[0], *picked)

    kinds = [eight if kind is eight else types.float64 for kind in (one, other)]
    return eight(flags, *kinds), generate


def _bits(_context: Any, flag: Any) -> Any:
    """The flags as the low eight bits of a whole number."""

    def generate(_context: Any, builder: Any, _signature: Any, given: Any) -> Any:
        return builder.zext(builder.bitcast(given[0], ir.IntType(8)), _INDEX)

    return types.int64(flags), generate


def _turn(_context: Any, array: Any, places: Any, base: Any, out: Any, count: Any) -> Any:
    """Transpose ``count`` numbers, a multiple of eight, from each of eight flat places.

    They stand in ``places`` from ``base`` on. Row m of ``out`` (count, 8) becomes number m of all
    eight places.
    """

    def generate(context: Any, builder: Any, _signature: Any, given: Any) -> Any:
        start = _start(context, builder, array, given[0])
        index = _start(context, builder, places, given[1])
        index = builder.gep(index, [given[2]])
        end = _start(context, builder, out, given[3])
        lines = []
        for k in range(EIGHT):
            place = builder.load(builder.gep(index, [_INDEX(k)]))
            lines.append(builder.gep(start, [place]))
        with _tools.for_range_slice(builder, _INDEX(0), given[4], _INDEX(EIGHT), inc=True) as (
            first,
            _,
        ):
            rows = [builder.load(_numbers_at(builder, line, first), align=8) for line in lines]
            for row, numbers in enumerate(_transposed(builder, rows)):
                at = builder.mul(builder.add(first, _INDEX(row)), _INDEX(EIGHT))
                builder.store(numbers, _numbers_at(builder, end, at), align=8)
        return context.get_dummy_value()

    return types.void(array, places, types.int64, out, types.int64), generate


def _transposed(builder: Any, rows: list[Any]) -> list[Any]:
    """Eight rows of eight numbers as their eight columns."""
    kind = ir.VectorType(ir.IntType(32), EIGHT)
    for width in (1, 2, 4):
        # exchange blocks of this width between rows this far apart
        low = [k if not k & width else k - width + EIGHT for k in range(EIGHT)]
        high = [k + width if not k & width else k + EIGHT for k in range(EIGHT)]
        for k in range(EIGHT):
            if not k & width:
                pair = (rows[k], rows[k + width])
                rows[k], rows[k + width] = (
                    builder.shuffle_vector(*pair, ir.Constant(kind, mask)) for mask in (low, high)
                )
    return rows


load: Any = intrinsic(_load)
store: Any = intrinsic(_store)
pick: Any = intrinsic(_pick)
drop: Any = intrinsic(_drop)
choose: Any = intrinsic(_choose)
bits: Any = intrinsic(_bits)
turn: Any = intrinsic(_turn)
