"""Rules of uniform dispersal: plain functions from (state, seen) to (state, move), on integers.

Sources: Amir and Bruckstein, "Minimizing Travel in the Uniform Dispersal Problem for Robotic
Sensors" (AAMAS 2019), called "the paper" below, and "Time, Travel, and Energy in the Uniform
Dispersion Problem" (2024), "the later paper"; Hsiang, Arkin, Bender, Fekete and Mitchell,
"Algorithms for Rapidly Dispersing Robot Swarms in Unknown Environments" (WAFR 2002).

A module of rules imports the vocabulary alone and no rule calls another function: a robot calls a
rule, and the grid model compiles the very same one. Each module ends with its `RULES`, functions
by name, and with their `SENSES` where they see more than occupied cells.
"""

from collections.abc import Callable
from importlib import import_module

from controllers.dispersal.vocabulary import (
    DICE,
    DOWN,
    LEFT,
    LIGHTS,
    RIGHT,
    SETTLE,
    STAY,
    TALK,
    UP,
)

MODULES = (
    "find_corner",
    "variants",
    "leader_follower",
)
"""The modules of rules in this folder: a new one is a file here and its line above."""

RULES: dict[str, Callable[[int, int], tuple[int, int]]] = {}
"""Every rule by name."""

SENSES: dict[str, int] = {}
"""What a rule sees beyond occupied cells; nothing, if it is not here."""

for _name in MODULES:
    _module = import_module(f"{__name__}.{_name}")
    RULES |= _module.RULES
    SENSES |= getattr(_module, "SENSES", {})

__all__ = [
    "DICE",
    "DOWN",
    "LEFT",
    "LIGHTS",
    "MODULES",
    "RIGHT",
    "RULES",
    "SENSES",
    "SETTLE",
    "STAY",
    "TALK",
    "UP",
]
