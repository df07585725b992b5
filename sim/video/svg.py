"""A moment as an SVG document, made of the same things in the same places as the pixels."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING
from xml.sax.saxutils import escape

import numpy as np
from numpy.typing import NDArray

from sim.video.axes import TICK, edges_of, ticks
from sim.video.bodies import coat_of
from sim.video.ground import floor_of, grid_lines, soften
from sim.video.paint import STRENGTH as PAINT
from sim.video.paint import rectangles_of
from sim.video.palette import (
    GRID,
    GROUND,
    INK,
    OUTSIDE,
    PAPER,
    SOFT_INK,
    STRIP,
    mix,
    tint,
)
from sim.video.projection import SHIFT
from sim.video.scans import PALE, PALER, RING_WIDTH, fan_outline, sighting_arcs
from sim.video.text import SCALE, Lettering, balloon_outline

if TYPE_CHECKING:
    from sim.video.compose import Composer, Composition
    from sim.video.status import StatusLine

Points = NDArray[np.float64]
FONT = "Helvetica, Arial, 'Liberation Sans', 'DejaVu Sans', sans-serif"
LETTER = 28.5
"""Units of a font's size per unit of OpenCV's scale."""
FAN = 0.16


def svg_of(composer: Composer, composed: Composition, status: StatusLine) -> str:
    """The document of a moment; lengths are those of the picture in pixels."""
    p, lettering = composer.projection, composer.lettering
    body = [
        *_ground(composer),
        *_scans(composer, composed),
        *_paint(composer, composed),
        *_solids(composer),
        *(_trails(composer) if composed.trails else ()),
        *_bodies(composed, p.unit),
        *_sightings(composer, composed),
        *_drawings(composer, composed),
        *_callouts(composer, composed),
    ]
    field = p.field_height
    strip = [
        f'<rect x="0" y="{field}" width="{p.width}" height="{p.height - field}" '
        f'fill="{_hex(STRIP)}"/>',
        *(
            text(lettering, words, x, field + status.baseline, ink)
            for words, x, ink in status.entries(composed.snapshot, len(composed.colors))
        ),
    ]
    if status.title is not None:
        words, x = status.title
        strip.append(text(lettering, words, x, field + status.baseline, SOFT_INK))
    if status.bar is not None:
        bar, tick = status.bar, 3 * p.unit
        y = field + bar.y
        corners = [(bar.left, y - tick), (bar.left, y), (bar.right, y), (bar.right, y - tick)]
        strip.append(path([np.array(corners)], stroke=SOFT_INK, width=p.unit, closed=False))
        strip.append(text(lettering, bar.label, bar.start, y - 4 * p.unit, SOFT_INK))
    clip = f'<clipPath id="field"><rect width="{p.width}" height="{field}"/></clipPath>'
    title = composer.backdrop.title
    return document(
        (p.width, p.height), title, [clip, '<g clip-path="url(#field)">', *body, "</g>", *strip]
    )


def document(size: tuple[int, int], title: str, parts: Iterable[str]) -> str:
    """An SVG document of a size in pixels."""
    width, height = size
    head = (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" '
        f'viewBox="0 0 {width} {height}" stroke-linejoin="round" font-family="{FONT}">'
    )
    return "\n".join([head, f"<title>{_clean(title)}</title>", *parts, "</svg>", ""])


def path(
    outlines: Iterable[Points],
    *,
    fill: int | None = None,
    stroke: int | None = None,
    width: float = 1.0,
    closed: bool = True,
    more: str = "",
) -> str:
    """A path of outlines (k, 2) in pixels; colours 0xRRGGBB."""
    end = "z" if closed else ""
    data = "".join(f"M{_points(outline)}{end}" for outline in outlines)
    inside = "none" if fill is None else _hex(fill)
    line = "" if stroke is None else f' stroke="{_hex(stroke)}" stroke-width="{width:.4g}"'
    return f'<path d="{data}" fill="{inside}"{line}{more}/>'


def text(
    lettering: Lettering, words: str, x: float, y: float, ink: int, *, halo: bool = False
) -> str:
    """A text whose baseline begins at (x, y), as wide as it is in pixels."""
    size = SCALE * LETTER * lettering.unit
    around = (
        f' stroke="{_hex(PAPER)}" stroke-width="{3 * lettering.unit:.3g}" stroke-opacity="0.8"'
        ' paint-order="stroke"'
    )
    return (
        f'<text x="{x:.4g}" y="{y:.4g}" font-size="{size:.3g}" fill="{_hex(ink)}" '
        f'textLength="{lettering.width(words)}" lengthAdjust="spacingAndGlyphs"'
        f"{around * halo}>{_clean(words)}</text>"
    )


def _ground(composer: Composer) -> list[str]:
    p, backdrop = composer.projection, composer.backdrop
    outside = PAPER if composer.axes else OUTSIDE
    parts = [
        f'<rect width="{p.width}" height="{p.height}" fill="{_hex(outside)}"/>',
        path([p.edges(floor_of(backdrop))], fill=GROUND),
        path([p.edges(line) for line in grid_lines(backdrop.size, p)], stroke=GRID, closed=False),
    ]
    doors = [p.edges(np.asarray(door, float)) for door in backdrop.doors]
    if doors:
        parts.append(path(doors, fill=mix(GROUND, SOFT_INK, 0.12), stroke=SOFT_INK, width=p.unit))
    if composer.axes:
        parts += _axes(composer)
    return parts


def _axes(composer: Composer) -> list[str]:
    p, lettering = composer.projection, composer.lettering
    column, row = edges_of(p)
    tick = TICK * p.unit
    lines, words = [], []
    for each in ticks(composer.backdrop.size, p, lettering):
        if each.axis == "x":
            lines.append(np.array([[each.at, row], [each.at, row + tick]]))
        else:
            lines.append(np.array([[column - tick, each.at], [column, each.at]]))
        words.append(text(lettering, each.text, *each.origin, SOFT_INK))
    return [path(lines, stroke=SOFT_INK, width=p.unit, closed=False), *words]


def _solids(composer: Composer) -> list[str]:
    by_color: dict[int, list[Points]] = {}
    backdrop = composer.backdrop
    for vertices, color in (*backdrop.marks, *backdrop.solids):
        by_color.setdefault(soften(color), []).append(
            composer.projection.edges(np.asarray(vertices, float))
        )
    # A thin edge of its own colour closes the seams between the pieces of one wall.
    return [path(them, fill=color, stroke=color, width=0.5) for color, them in by_color.items()]


def _paint(composer: Composer, composed: Composition) -> list[str]:
    if composed.snapshot.floor is None:
        return []
    p, step = composer.projection, composed.snapshot.resolution
    parts = []
    for owner, rectangles in rectangles_of(composed.snapshot.floor):
        data = []
        for row, column, rows, columns in rectangles:
            x, y = p.edges(np.array([column * step, (row + rows) * step]) + p.low)
            width, height = columns * step * p.scale, rows * step * p.scale
            data.append(f"M{x:.2f} {y:.2f}h{width:.2f}v{height:.2f}h{-width:.2f}z")
        color = mix(GROUND, tint(owner - 1), PAINT)
        parts.append(
            f'<path d="{"".join(data)}" fill="{_hex(color)}" shape-rendering="crispEdges"/>'
        )
    return parts


def _scans(composer: Composer, composed: Composition) -> list[str]:
    p, parts = composer.projection, []
    filled = composed.fans == "filled"
    strength = FAN / np.sqrt(max(len(composed.scans), 1))
    for scan in composed.scans:
        outline = _edges(fan_outline(scan, p))
        color = tint(scan.robot)
        opacity = f' fill-opacity="{strength:.3f}"' if filled else ""
        edge = mix(color, PAPER, PALE if filled else PALER)
        fill = color if filled else None
        parts.append(path([outline], fill=fill, stroke=edge, width=p.unit, more=opacity))
    return parts


def _trails(composer: Composer) -> list[str]:
    return [
        path(map(_edges, lines), stroke=color, width=composer.projection.unit, closed=False)
        for color, lines in composer.trails.lines()
    ]


def _bodies(composed: Composition, unit: float) -> list[str]:
    parts = []
    for group, colors, robots in (
        (composed.movables, composed.movable_colors, False),
        (composed.robots, composed.colors, True),
    ):
        drawn: list[tuple[int, str]] = []
        for placed in group:
            kind, count = placed.kind, placed.kind.count
            for index, corners in zip(kind.members.tolist(), placed.corners, strict=True):
                points = np.stack([corners.real, corners.imag], axis=1)
                settled = robots and bool(composed.settled[index])
                robot = index if robots and kind.rimmed else None
                coat = coat_of(int(colors[index]), robot, settled)
                outline = points[:count]
                if not kind.detailed:
                    drawn.append((index, path([outline], fill=coat.fill)))
                    continue
                words = path([outline], fill=coat.rim, stroke=coat.edge, width=unit)
                if kind.rimmed:
                    words += path([points[count : 2 * count]], fill=coat.fill)
                    arrow = ' paint-order="stroke"'
                    words += path(
                        [points[2 * count :]],
                        fill=coat.rim,
                        stroke=coat.halo,
                        width=3 * unit,
                        more=arrow,
                    )
                drawn.append((index, words))
        parts += [words for _, words in sorted(drawn)]
    return parts


def _sightings(composer: Composer, composed: Composition) -> list[str]:
    p, radii = composer.projection, composer.bodies.radii
    width = RING_WIDTH * p.unit
    return [
        path([points], stroke=color, width=width, closed=False)
        for sighting in composed.sightings
        for color, points in sighting_arcs(sighting, radii[sighting.robot], p)
    ]


def _drawings(composer: Composer, composed: Composition) -> list[str]:
    p, parts = composer.projection, []
    for drawing in composed.snapshot.drawings:
        points = p.edges(np.asarray(drawing.points, float).reshape(-1, 2))
        color, unit = drawing.color, p.unit
        if drawing.kind == "points":
            parts += [
                f'<circle cx="{x:.2f}" cy="{y:.2f}" r="{2 * unit:.3g}" fill="{_hex(color)}"/>'
                for x, y in points
            ]
        elif drawing.kind == "polyline" and len(points) >= 2:
            parts.append(path([points], stroke=color, width=unit, closed=False))
        elif drawing.kind == "multiline" and len(points) >= 2:
            pairs = points[: len(points) // 2 * 2].reshape(-1, 2, 2)
            parts.append(path(pairs, stroke=color, width=unit, closed=False))
        elif drawing.kind == "polygon" and len(points) >= 3:
            fill = None
            if drawing.filled:
                fill = color if drawing.fill_color is None else drawing.fill_color
            parts.append(path([points], fill=fill, stroke=color, width=unit))
    return parts


def _callouts(composer: Composer, composed: Composition) -> list[str]:
    lettering, parts = composer.lettering, []
    unit = lettering.unit
    for callout in composed.callouts:
        left, top, _, height = callout.box
        if callout.kind == "name":
            baseline = top + height / 2 + 4 * unit
            parts.append(text(lettering, callout.text, left + 3, baseline, INK, halo=True))
            continue
        outline = balloon_outline(callout.box, callout.tip, unit)
        edge = mix(tint(callout.robot), INK, 0.35)
        parts.append(path([outline], fill=PAPER, stroke=edge, width=unit))
        x, y = left + 7 * unit, top + 1 + lettering.ascent
        parts.append(text(lettering, callout.text, x, y, INK))
    return parts


def _edges(fixed: NDArray[np.int32]) -> Points:
    """OpenCV's fixed-point coordinates as pixel edges."""
    points: Points = fixed.reshape(-1, 2) / float(1 << SHIFT) + 0.5
    return points


def _points(outline: Points | Sequence[Sequence[float]]) -> str:
    return "L".join(f"{x:.2f} {y:.2f}" for x, y in np.asarray(outline, float).tolist())


def _hex(color: int) -> str:
    return f"#{color:06x}"


def _clean(words: str) -> str:
    """What XML may hold: no control characters, no lone surrogates."""
    kept = "".join(c if c.isprintable() else " " for c in words)
    return escape(kept.encode("utf-8", "replace").decode("utf-8"))
