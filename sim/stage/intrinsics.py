"""Calls of C functions by their addresses, from compiled code: no Python between a tick's steps.

A compiled loop is given addresses as integers (so that its machine code can be kept on disk, for
any process) and calls them as C would: Chipmunk's, see `chipmunk`.
"""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic


def _call(builder: Any, function: Any, arguments: list[Any]) -> None:
    """Call the function at an address: it takes these values and returns nothing."""
    kind = ir.FunctionType(ir.VoidType(), [argument.type for argument in arguments])
    builder.call(builder.inttoptr(function, kind.as_pointer()), arguments)


def _step_space(context: Any, function: Any, space: Any, seconds: Any) -> Any:
    """cpSpaceStep(space, seconds)."""
    signature = types.void(types.uintp, types.uintp, types.float64)

    def generate(target: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        _call(builder, arguments[0], list(arguments[1:]))
        return target.get_dummy_value()

    return signature, generate


def _for_each(context: Any, function: Any, space: Any, callback: Any, data: Any) -> Any:
    """cpSpaceEachBody(space, callback, data), and functions of its kind."""
    signature = types.void(types.uintp, types.uintp, types.uintp, types.uintp)

    def generate(target: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        _call(builder, arguments[0], list(arguments[1:]))
        return target.get_dummy_value()

    return signature, generate


def _set_iterations(context: Any, function: Any, space: Any, rounds: Any) -> Any:
    """cpSpaceSetIterations(space, rounds)."""
    signature = types.void(types.uintp, types.uintp, types.int32)

    def generate(target: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        _call(builder, arguments[0], list(arguments[1:]))
        return target.get_dummy_value()

    return signature, generate


step_space: Any = intrinsic(_step_space)
for_each: Any = intrinsic(_for_each)
set_iterations: Any = intrinsic(_set_iterations)


def _at(number: Any) -> Any:
    """An intrinsic that takes an address for that of numbers of this type."""

    def cast(context: Any, place: Any) -> Any:
        signature = types.CPointer(number)(types.uintp)  # type: ignore[no-untyped-call]

        def generate(target: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            return builder.inttoptr(arguments[0], target.get_value_type(signature.return_type))

        return signature, generate

    return intrinsic(cast)


floats_at = _at(types.float64)
words_at = _at(types.uintp)
ints_at = _at(types.int32)
longs_at = _at(types.int64)
