"""Compiled forms of the rules and the other pure functions, for the grid model."""

import hashlib
from collections.abc import Callable
from functools import cache
from pathlib import Path
from types import FunctionType, ModuleType
from typing import Any

import numba

from controllers.dispersal import chance, vocabulary

_types: Any = numba.types
RULE_SIGNATURE = _types.UniTuple(_types.int64, 2)(_types.int64, _types.int64)
RULE_TYPE = _types.FunctionType(RULE_SIGNATURE)

Rule = Callable[[int, int], tuple[int, int]]


@cache
def compile_rule(rule: Rule) -> Any:
    """The machine code of a rule, as a C function that the compiled step calls.

    Any function of `rules`' kind will do, one of a user's too. The step itself is compiled once
    for all rules.
    """
    in_a_file = rule.__code__.co_filename[:1] != "<"  # numba keeps its cache beside the source
    kept = in_a_file and rule.__closure__ is None
    if kept and isinstance(rule, FunctionType):  # a copy, as `keyed` gives it another name
        copy = FunctionType(rule.__code__, rule.__globals__, rule.__name__, rule.__defaults__)
        rule = keyed(copy, vocabulary)
    try:
        return numba.cfunc(RULE_SIGNATURE, cache=kept)(rule)
    except RuntimeError:  # numba: "no locator available": nowhere to write a cache
        return numba.cfunc(RULE_SIGNATURE)(rule)


def compiled(signature: Any, function: Callable[..., Any]) -> Any:
    """The machine code of a function for one signature, kept on disk where that is possible."""
    try:
        return numba.njit(signature, cache=True)(function)
    except RuntimeError:
        return numba.njit(signature)(function)


def keyed(function: Callable[..., Any], *sources: ModuleType) -> Callable[..., Any]:
    """`function`, to be compiled anew when one of the modules has changed that it draws upon.

    numba sees for itself when the function's own file has changed, but code and constants from
    other files live on inside of what it keeps. Its files bear the function's qualified name, so
    that name gets a digest of the sources.
    """
    digest = hashlib.sha256()
    for module in sources:
        digest.update(Path(str(module.__file__)).read_bytes())
    function.__qualname__ = f"{function.__name__}_{digest.hexdigest()[:16]}"
    return function


draw: Any = compiled(numba.int64(numba.int64, numba.int64, numba.int64, numba.int64), chance.draw)
"""`chance.draw`, compiled."""
