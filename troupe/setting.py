"""Changes to a world that are given in Python, as `--set` has them."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from troupe.usage import UsageError

Setting = Mapping[str, Any] | Sequence[str]


def as_text(settings: Setting) -> list[str]:
    """Changes to the world as the command line has them; JSON is YAML."""
    if isinstance(settings, str):
        raise UsageError(f"set: must be a mapping such as {{'clock.interval': 0.05}}: {settings!r}")
    if not isinstance(settings, Mapping):
        return list(settings)
    try:
        return [f"{key}={json.dumps(value, default=plain)}" for key, value in settings.items()]
    except (TypeError, ValueError) as error:
        raise UsageError(f"set: {error}") from None


def plain(value: Any) -> Any:
    """What a world file can hold of a path, or of numpy's numbers and arrays."""
    if isinstance(value, Path):
        return str(value)
    if hasattr(value, "tolist"):
        return value.tolist()
    raise TypeError(f"a world file cannot hold {value!r}")
