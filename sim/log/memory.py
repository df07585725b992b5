"""Numbers in memory by their addresses, wherever these lie, for compiled code: rows and messages.

A message's fields lie at odd addresses, so nothing is taken for aligned.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic
from numpy.typing import NDArray

SINGLE = 4
"""Bytes of a float32."""


def _getter(number: Any) -> Any:
    """An intrinsic that gives the number at an address."""

    def get(context: Any, address: Any) -> Any:
        signature = number(types.intp)

        def generate(target: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            kind = target.get_value_type(number).as_pointer()
            return builder.load(builder.inttoptr(arguments[0], kind), align=1)

        return signature, generate

    return intrinsic(get)


def _putter(number: Any) -> Any:
    """An intrinsic that writes a number to an address."""

    def put(context: Any, address: Any, value: Any) -> Any:
        signature = types.void(types.intp, number)

        def generate(target: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            kind = target.get_value_type(number).as_pointer()
            builder.store(arguments[1], builder.inttoptr(arguments[0], kind), align=1)
            return target.get_dummy_value()

        return signature, generate

    return intrinsic(put)


def _copy(context: Any, target: Any, source: Any, size: Any) -> Any:
    """Copy bytes from an address to another; they do not overlap."""
    signature = types.void(types.intp, types.intp, types.intp)

    def generate(target: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        to, source, size = arguments
        kind = ir.IntType(8).as_pointer()
        cgutils.raw_memcpy(  # type: ignore[no-untyped-call]
            builder, builder.inttoptr(to, kind), builder.inttoptr(source, kind), size, 1
        )
        return target.get_dummy_value()

    return signature, generate


get_byte, put_byte = _getter(types.uint8), _putter(types.uint8)
put_short = _putter(types.uint16)
get_int, put_word = _getter(types.int32), _putter(types.uint32)
get_long, put_long = _getter(types.int64), _putter(types.int64)
get_float, put_float = _getter(types.float64), _putter(types.float64)
put_single = _putter(types.float32)
copy: Any = intrinsic(_copy)


def address_of(array: NDArray[Any]) -> int:
    """Where an array's first number lies, as long as the array is there."""
    return int(array.ctypes.data)


def is_plain(array: NDArray[Any], dtype: Any) -> bool:
    """Whether an array's numbers are of a type and lie one after the other."""
    return array.dtype == np.dtype(dtype) and array.flags.c_contiguous
