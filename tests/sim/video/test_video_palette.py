"""Robots' tints are told apart by everybody, on paper white and as paint."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from sim.video.paint import STRENGTH
from sim.video.palette import GROUND, TINTS, bgr, contrast_ink, mix, tint

# G. M. Machado, M. M. Oliveira, L. A. F. Fernandes, "A physiologically-based model for
# simulation of color vision deficiency", IEEE TVCG 15(6), 2009, severity 1.0, linear RGB.
VISION = {
    "common": np.eye(3),
    "protanopia": np.array(
        [
            [0.152286, 1.052583, -0.204868],
            [0.114503, 0.786281, 0.099216],
            [-0.003882, -0.048116, 1.051998],
        ]
    ),
    "deuteranopia": np.array(
        [
            [0.367322, 0.860646, -0.227968],
            [0.280085, 0.672501, 0.047413],
            [-0.011820, 0.042940, 0.968881],
        ]
    ),
}
XYZ = np.array(
    [
        [0.4124564, 0.3575761, 0.1804375],
        [0.2126729, 0.7151522, 0.0721750],
        [0.0193339, 0.1191920, 0.9503041],
    ]
)
NOTICEABLE = 2.3
"""CIE76 distance that is just noticeable (M. Mahy et al., Color Res. Appl. 19, 1994)."""


def lab(color: int, vision: str) -> np.ndarray:
    """CIE L*a*b* of an sRGB colour as seen with the given vision."""
    rgb = np.array(bgr(color)[::-1]) / 255
    linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    xyz = XYZ @ np.clip(VISION[vision] @ linear, 0, 1) / (XYZ @ np.ones(3))
    f = np.where(xyz > 0.008856, np.cbrt(xyz), 7.787 * xyz + 16 / 116)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


@pytest.mark.parametrize("vision", VISION)
def test_any_two_tints_of_paint_differ_clearly_in_every_eye(vision: str) -> None:
    paints = [mix(GROUND, color, STRENGTH) for color in TINTS]
    nearest = min(
        np.linalg.norm(lab(a, vision) - lab(b, vision)) for a, b in combinations(paints, 2)
    )
    # Three times the just noticeable: paints also lie side by side under grid and fans.
    assert nearest > 3 * NOTICEABLE


@pytest.mark.parametrize("vision", VISION)
def test_paint_is_told_from_bare_ground(vision: str) -> None:
    bare = lab(GROUND, vision)
    assert all(
        np.linalg.norm(lab(mix(GROUND, color, STRENGTH), vision) - bare) > 3 * NOTICEABLE
        for color in TINTS
    )


def test_tints_repeat_after_the_last() -> None:
    assert [tint(i) for i in range(2 * len(TINTS))] == [*TINTS, *TINTS]


def test_a_mixture_lies_between_its_parts() -> None:
    assert mix(0x000000, 0xFFFFFF, 0) == 0x000000
    assert mix(0x000000, 0xFFFFFF, 1) == 0xFFFFFF
    assert mix(0x102030, 0x302010, 0.5) == 0x202020


def test_the_heading_is_dark_on_light_bodies_and_light_on_dark_ones() -> None:
    assert contrast_ink(0x00FF00) != contrast_ink(0x202080)
