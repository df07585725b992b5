"""Colours of a frame: the robots' tints and the inks; everything OpenCV gets is BGR."""

from __future__ import annotations

from functools import cache

Bgr = tuple[int, int, int]

TINTS: tuple[int, ...] = (
    # Okabe and Ito's set, told apart with every common kind of colour blindness
    # (B. Wong, "Points of view: Color blindness", Nature Methods 8:441, 2011), without black.
    0xE69F00,  # orange
    0x56B4E9,  # sky blue
    0x009E73,  # bluish green
    0xF0E442,  # yellow
    0x0072B2,  # blue
    0xD55E00,  # vermillion
    0xCC79A7,  # reddish purple
    0x5D3A1A,  # dark brown in black's place, which would be taken for walls and text
    # And for larger teams those that lie farthest from these and from each other, one after the
    # other, in CIELAB, as paint and as they are, with common and with colour-blind eyes.
    0x0000FF,
    0x2266FF,
    0x00EE77,
    0x770033,
    0x550099,
    0xDD0088,
    0xFF3355,
    0xFF00EE,
    0xBB9944,
    0x99CCAA,
    0x22DDDD,
    0x445500,
)
"""0xRRGGBB of robots 0, 1, 2, ...: who they are, whatever colour their bodies have. From the 21st
robot on they repeat."""

GROUND = 0xFBFAF7
OUTSIDE = 0xE9E7E1
GRID = 0xEDEBE4
INK = 0x26292E
SOFT_INK = 0x7A7D82
STRIP = 0xFFFFFF
PAPER = 0xFFFFFF


def bgr(color: int) -> Bgr:
    """(blue, green, red) of 0xRRGGBB."""
    return color & 0xFF, (color >> 8) & 0xFF, (color >> 16) & 0xFF


@cache
def mix(color: int, other: int, share: float) -> int:
    """0xRRGGBB with `share` (0 to 1) of `other` in it."""
    result = 0
    for shift in (16, 8, 0):
        a, b = (color >> shift) & 0xFF, (other >> shift) & 0xFF
        result |= round(a + (b - a) * share) << shift
    return result


def luminance(color: int) -> float:
    """0 (black) to 1 (white), as the eye weighs red, green and blue (Rec. 601)."""
    return (
        0.299 * ((color >> 16) & 0xFF) + 0.587 * ((color >> 8) & 0xFF) + 0.114 * (color & 0xFF)
    ) / 255


def contrast_ink(color: int) -> int:
    """A dark or a light ink, whichever stands out on `color`."""
    return INK if luminance(color) > 0.45 else PAPER


def tint(robot: int) -> int:
    """A robot's identity colour, 0xRRGGBB: of its rim, arrow, paint, trail, fan and balloon."""
    return TINTS[robot % len(TINTS)]
