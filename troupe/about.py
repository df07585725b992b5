"""What a result depends on besides world and seed: versions and the machine."""

from __future__ import annotations

import platform
from importlib.metadata import PackageNotFoundError, version

PACKAGES = ("numpy", "numba", "pymunk")
"""On whose versions the digest of a run depends."""


def versions() -> dict[str, str]:
    """Troupe's version, Python's, and those of the packages that a digest depends on."""
    from troupe import __version__  # noqa: PLC0415

    found = {"version": __version__, "python": platform.python_version()}
    for name in PACKAGES:
        try:
            found[name] = version(name)
        except PackageNotFoundError:  # bundled in some other way
            found[name] = "unknown"
    return found


def machine() -> str:
    """The kind of machine, such as `x86_64 Linux`."""
    return f"{platform.machine()} {platform.system()}"
