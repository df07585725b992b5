"""What a result depends on besides its world and seed, and the machine that it was made on."""

from __future__ import annotations

import hashlib
import os
import platform
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from troupe import __version__

ROOT = Path(__file__).resolve().parent.parent.parent
PACKAGES = ("numpy", "numba", "pymunk", "opencv-python-headless")
SOURCES = ("sim", "sensors", "player", "controllers")
"""Our packages of which a result is made."""


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


def sources() -> str:
    """A digest of our own sources: a checkout changes without its version."""
    digest = hashlib.sha256()
    for name in SOURCES:
        for path in sorted((ROOT / name).rglob("*.py")):
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
