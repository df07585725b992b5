"""The parts of a picture that can be left out, by name."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from typing import Literal, get_args

from sim.video.errors import VideoError

Layer = Literal["fans", "names", "trails", "speech", "blobs"]
"""Laser fans; the robots' names; where they came from; what they say; what blobfinders see."""

LAYERS: tuple[Layer, ...] = get_args(Layer)
SHOWN: frozenset[Layer] = frozenset({"fans", "names", "trails", "speech"})
"""What shows unless told otherwise."""


def layers_of(names: Iterable[str]) -> frozenset[Layer]:
    """The layers of these names; raises VideoError for a name that there is not."""
    found: set[Layer] = set()
    for name in names:
        layer = next((layer for layer in LAYERS if layer == name), None)
        if layer is None:
            close = difflib.get_close_matches(name, LAYERS, 1)
            hint = f"; did you mean {close[0]!r}?" if close else ""
            raise VideoError(f"video show {name!r}: not one of {', '.join(LAYERS)}{hint}")
        found.add(layer)
    return frozenset(found)


def parse_layers(text: str) -> frozenset[Layer]:
    """The layers of a text such as `fans,names`; `none` for none of them; raises VideoError."""
    if text.strip() == "none":
        return frozenset()
    return layers_of(name.strip() for name in text.split(","))
