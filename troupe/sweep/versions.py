"""What a result depends on besides its world and seed, and the machine that it was made on."""

from __future__ import annotations

import hashlib
import os
import platform
from collections.abc import Sequence
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from troupe import __version__

ROOT = Path(__file__).resolve().parent.parent.parent
PACKAGES = ("numpy", "numba", "pymunk", "opencv-python-headless")
SOURCES = ("sim", "sensors", "player", "controllers")
"""Our packages of which a world's result is made."""
OTHERS = ("gridworld", "troupe")
"""Those that a function may make use of besides."""


@cache
def versions() -> dict[str, str]:
    """The versions of all that a digest depends on; ours besides by its sources' bytes."""
    found = {"troupe": __version__, "sources": sources(), "python": platform.python_version()}
    for name in PACKAGES:
        try:
            found[name] = version(name)
        except PackageNotFoundError:  # the same package under another name
            found[name] = "unknown"
    return found


@cache
def all_versions() -> dict[str, str]:
    """The same for what may make use of everything: of all our packages, and of our maps."""
    return {**versions(), "sources": sources((*SOURCES, *OTHERS), (".py", ".txt"))}


def sources(packages: Sequence[str] = SOURCES, endings: Sequence[str] = (".py",)) -> str:
    """A digest of our own sources: a checkout changes without its version."""
    digest = hashlib.sha256()
    for name in packages:
        paths = (path for path in (ROOT / name).rglob("*.*") if path.suffix in endings)
        for path in sorted(paths):
            digest.update(str(path.relative_to(ROOT)).encode() + b"\0")
            digest.update(hashlib.sha256(path.read_bytes()).digest())
    return digest.hexdigest()[:16]


@cache
def machine() -> dict[str, str]:
    """This machine, for people: where a run was made changes nothing in it."""
    model = platform.processor() or platform.machine()
    info = Path("/proc/cpuinfo")
    if info.exists():
        names = [line for line in info.read_text().splitlines() if line.startswith("model name")]
        model = names[0].partition(":")[2].strip() if names else model
    return {
        "host": platform.node(),
        "system": f"{platform.system()} {platform.machine()}",
        "processor": model,
        "cores": str(os.cpu_count()),
    }
