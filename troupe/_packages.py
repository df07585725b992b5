"""Our packages' names, claimed for our packages.

A world's folder may hold a `controllers` folder or a `sensors.py` of its own, and a notebook or
script beside it has that folder first among the places to import from. What we import must still
be ours; but what somebody has imported already is not taken away.
"""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
NAMES = ("player", "sensors", "sim", "controllers", "gridworld")


def claim_names() -> None:
    """Make sure that `import sensors` and the like find our packages, wherever we were started.

    Raises ImportError, and changes nothing, where a module of such a name has been imported that
    is not ours.
    """
    taken = [name for name in NAMES if name in sys.modules and not is_ours(name)]
    if taken:
        raise ImportError(clash(taken))
    for name in NAMES:
        origin = ROOT / name / "__init__.py"
        if name in sys.modules:
            continue
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


def is_ours(name: str) -> bool:
    """Whether an imported module is the package of ours that has its name."""
    return getattr(sys.modules[name], "__file__", None) == str(ROOT / name / "__init__.py")


def clash(taken: list[str]) -> str:
    """What to do about modules that have the names of ours."""
    known = {name: sys.modules[name] for name in taken}
    places = []
    for name, module in known.items():
        found = getattr(module, "__file__", None) or next(iter(getattr(module, "__path__", [])), "")
        places.append(f"{name} ({found})" if found else name)
    names = ", ".join(NAMES)
    return (
        f"Troupe has packages named {names}, and this program has imported others of these names "
        f"already: {', '.join(places)}. Rename yours, or run the world in a process of its own: "
        "subprocess.run([sys.executable, '-m', 'troupe', 'run', WORLD, '--json'])"
    )
