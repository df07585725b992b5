"""What values a parameter of a sweep takes: a list of them, a grid, or draws at random.

A draw depends on the sampling's seed, the parameter's name and the sample's number alone: another
parameter changes none of them, and more samples begin with the same ones.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from typing import Any

import numpy as np

from sim.worldfile.mistakes import did_you_mean

KINDS = ("values", "grid", "uniform", "integers", "normal", "choice")
DRAWN = ("uniform", "integers", "normal", "choice")
ALLOWED = (
    "a value, a list of values, {grid: [first, last, number]}, {uniform: [low, high]}, "
    "{integers: [low, high]}, {normal: [mean, deviation]}, {choice: [values]}"
)


@dataclass(frozen=True)
class Sampler:
    """The values of one parameter: `kind` is one of KINDS, `of` its numbers or values."""

    kind: str
    of: tuple[Any, ...]

    @property
    def drawn(self) -> bool:
        """Whether each sample has a value of its own, instead of all values being multiplied."""
        return self.kind in DRAWN


def sampler_of(value: Any) -> Sampler:
    """What stands for a parameter's values in a file; raises ValueError, which says why not."""
    if isinstance(value, dict):
        if len(value) != 1:
            raise ValueError("must be one sampler")
        ((kind, of),) = value.items()
        if kind not in KINDS:
            near = did_you_mean(str(kind), KINDS)
            raise ValueError(f"unknown sampler {kind}" + (f"; did you mean {near}?" * bool(near)))
        if not isinstance(of, list | tuple) or not of:
            raise ValueError(f"`{kind}` needs a list")
        sampler = Sampler(kind, tuple(of))
    else:
        sampler = Sampler("values", tuple(value) if isinstance(value, list | tuple) else (value,))
    check(sampler)
    return sampler


def check(sampler: Sampler) -> None:
    """Raises ValueError for numbers that make no sense."""
    kind, of = sampler.kind, sampler.of
    if not of:
        raise ValueError("has no values")
    if kind in ("values", "choice"):
        return
    if len(of) != (3 if kind == "grid" else 2):
        raise ValueError(f"`{kind}` needs {'three' if kind == 'grid' else 'two'} numbers")
    if any(isinstance(one, bool) or not isinstance(one, int | float) for one in of):
        raise ValueError(f"`{kind}` needs numbers")
    if not all(np.isfinite(one) for one in of):
        raise ValueError(f"`{kind}` needs finite numbers")
    if kind == "grid" and not (isinstance(of[2], int) and 2 <= of[2] <= 1_000_000):
        raise ValueError("the third number of `grid` is how many there are, 2 or more")
    if kind == "integers" and not all(isinstance(one, int) for one in of):
        raise ValueError("`integers` needs whole numbers")
    if kind in ("uniform", "integers") and of[0] > of[1]:
        raise ValueError(f"the first number of `{kind}` is the lower one")
    if kind == "normal" and of[1] < 0:
        raise ValueError("the second number of `normal`, the deviation, is not below 0")


def multiplied(sampler: Sampler) -> list[Any]:
    """All values of a parameter that is not drawn."""
    if sampler.kind == "grid":
        first, last, number = sampler.of
        return [float(value) for value in np.linspace(first, last, number)]
    return list(sampler.of)


def draw(sampler: Sampler, name: str, seed: int, sample: int) -> Any:
    """The value of parameter `name` in one sample."""
    words = hashlib.sha256(f"{seed}\0{name}\0{sample}".encode()).digest()
    random = np.random.default_rng(np.frombuffer(words, dtype="<u4"))
    of = sampler.of
    if sampler.kind == "uniform":
        return float(random.uniform(of[0], of[1]))
    if sampler.kind == "integers":
        return int(random.integers(of[0], of[1], endpoint=True))
    if sampler.kind == "normal":
        return float(random.normal(of[0], of[1]))
    return of[int(random.integers(len(of)))]
