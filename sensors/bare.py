"""Arrays within a kernel that are not counted.

numba counts who holds an array, by an atomic addition and another that takes it back, whenever a
function is given it or cuts a piece out of it. In kernels whose functions draw a few rays each that
took half of the time. A bare array is the same memory without the counter: whoever called the
kernel holds it meanwhile.
"""

from __future__ import annotations

from typing import Any

from numba.core import cgutils, types
from numba.extending import intrinsic

_null: Any = cgutils.get_null_value
_tuple: Any = types.BaseTuple


def _strip(target: Any, builder: Any, kind: Any, value: Any) -> Any:
    """The value of an array, or of a tuple of arrays, without its counter."""
    if isinstance(kind, _tuple):
        parts = [
            _strip(target, builder, each, builder.extract_value(value, number))
            for number, each in enumerate(kind)
        ]
        return target.make_tuple(builder, kind, parts)
    array = target.make_array(kind)(target, builder, value=value)
    array.meminfo, array.parent = _null(array.meminfo.type), _null(array.parent.type)
    return array._getvalue()


def _bare(context: Any, array: Any) -> Any:
    def generate(target: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return _strip(target, builder, signature.args[0], arguments[0])

    return array(array), generate


bare: Any = intrinsic(_bare)
"""bare(array), or bare(tuple of arrays), within a kernel."""
