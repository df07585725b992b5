"""Our packages' names, claimed for our packages.

A world's folder may hold a `controllers` folder or a `sensors.py` of its own, and a notebook or
script beside it has that folder first among the places to import from. What we import must still
be ours.
"""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
NAMES = ("player", "sensors", "sim", "controllers", "gridworld")


def claim_names() -> None:
    """Make sure that `import sensors` and its kin find our packages, wherever we were started."""
    for name in NAMES:
        origin = ROOT / name / "__init__.py"
        known = sys.modules.get(name)
        if known is not None:
            if getattr(known, "__file__", None) == str(origin):
                continue
            for module in [m for m in sys.modules if m == name or m.startswith(f"{name}.")]:
                del sys.modules[module]
        found = importlib.util.find_spec(name)
        if found is not None and found.origin == str(origin):
            continue
        spec = importlib.util.spec_from_file_location(
            name, origin, submodule_search_locations=[str(origin.parent)]
        )
        if spec is None or spec.loader is None:
            raise ImportError(f"Troupe's own package {name} is missing: {origin}")
        module_of_ours = importlib.util.module_from_spec(spec)
        sys.modules[name] = module_of_ours
        spec.loader.exec_module(module_of_ours)
