"""Outlines from drawings: SVG files by svgelements, DXF files by ezdxf.

A drawing's curves are flattened to chords within a tolerance; what is open is joined end to end.
The largest outline is the shape's and those in it are its holes. Files come from the scene's own
folder, and nothing that a file names is looked up.
"""

from __future__ import annotations

import io
import math
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Any

import numpy as np

from sandbox.numeric import Array
from sandbox.scene.outlines.rings import Ring, inside, signed_area
from sandbox.wording import listed, near, quoted

MOST_BYTES = 1_000_000
"""Of a drawing: some seconds of reading."""
MOST_POINTS = 20_000
"""Of all curves of a drawing once they are flattened."""
FINEST = 1e-6
"""The smallest tolerance, as a share of the drawing's size."""
CURVES = frozenset({"LINE", "LWPOLYLINE", "POLYLINE", "CIRCLE", "ARC", "ELLIPSE", "SPLINE"})
"""Of a DXF file; all else, such as dimensions and texts, is no outline."""
PIXEL = 0.0254 / 96
"""Of an SVG file without a unit of its own [m]."""


class DrawingError(ValueError):
    """A drawing that gives no outline: why, what would do, a near miss."""

    def __init__(self, message: str, allowed: str = "", hint: str = "") -> None:
        super().__init__(message)
        self.message, self.allowed, self.hint = message, allowed, hint


@dataclass(frozen=True)
class Curves:
    """What a drawing has: its curves as corners, x to the right and y up, and its unit."""

    corners: list[Array]
    """Of each, [k, 2], in the drawing's units."""
    unit: float | None
    """Length of one of these [m]; None where the drawing does not say."""


def own_file(folder: Path | None, name: str) -> bytes:
    """What is in a file of a scene's own folder.

    Args:
        folder: the scene's; None for a scene that is no file.
        name: the file's, below that folder, with / between its parts.

    Raises:
        DrawingError: another place, no file there, or a larger one.
    """
    if folder is None:
        raise DrawingError("a scene that is no file has no folder to read a drawing from",
                           "a polygon with the corners themselves")
    pure = PurePosixPath(name)
    if (not name or pure.is_absolute() or ".." in pure.parts or re.search(r'[\\:\0]', name)):
        raise DrawingError(f"{quoted(name)} is no file of the scene's own folder",
                           "a name such as 'plate.svg' or 'parts/plate.dxf', below the scene's")
    path = folder / pure
    try:
        linked = not path.resolve(strict=True).is_relative_to(folder.resolve(strict=True))
        found = b""
        if path.is_file() and not linked:  # what is no file may never end
            with path.open("rb") as file:
                found = file.read(MOST_BYTES + 1)
    except (OSError, RuntimeError, ValueError):
        raise _nowhere(folder, name) from None
    if linked:
        raise DrawingError(f"{quoted(name)} leads out of the scene's own folder by a link",
                           "a file that lies in it")
    if not found:
        raise DrawingError(f"{quoted(name)} is empty, or no file", "an SVG or DXF file")
    if len(found) > MOST_BYTES:
        raise DrawingError(f"{quoted(name)} is too large for the drawing of an outline",
                           f"at most {MOST_BYTES} bytes, with nothing in it but the outline")
    return found


def _nowhere(folder: Path, name: str) -> DrawingError:
    try:
        there = sorted(each.name for each in folder.iterdir() if each.suffix.lower() in READERS)
    except OSError:
        there = []
    return DrawingError(f"there is no file {quoted(name)} that can be read in the scene's folder",
                        listed(there) or "none: it has no .svg and no .dxf file", near(name, there))


def rings_of(
    name: str, text: bytes, *, unit: float | None, layer: str | None, tolerance: float,
) -> tuple[Ring, tuple[Ring, ...]]:
    """The outline of a drawing and its holes [m].

    Args:
        name: the file's; its ending says what it is.
        text: what is in it.
        unit: length of one of its units [m]; None for what the file says.
        layer: of a DXF file the layer, of an SVG file the id, of what is meant; None for all.
        tolerance: how far chords may be from curves, and ends that meet from each other [m].

    Raises:
        DrawingError: no outline, more than one, or what cannot be read.
    """
    ending = PurePosixPath(name).suffix.lower()
    if ending not in READERS:
        raise DrawingError(f"{quoted(name)} is neither an SVG nor a DXF file", ".svg, .dxf")
    try:
        curves = READERS[ending](text, layer, unit, tolerance)
    except DrawingError as error:
        raise DrawingError(f"{quoted(name)}: {error.message}", error.allowed, error.hint) from None
    except Exception as error:  # whatever a parser says of a stranger's file
        reason = " ".join(str(error).split())[:100] or type(error).__name__
        raise DrawingError(f"{quoted(name)} cannot be read as {ending[1:].upper()}: {reason}",
                           "a sound file, such as a drawing program writes it") from None
    scale = curves.unit if unit is None else unit
    assert scale is not None  # readers ask for it
    rings = [_closed(corners * scale, tolerance, name)
             for corners in _chained([c for c in curves.corners if len(c) > 1], tolerance / scale)]
    return _sorted_out(rings, name)


def _closed(corners: Array, tolerance: float, name: str) -> Ring:
    apart = math.dist(corners[0], corners[-1])
    if apart > tolerance:
        (x0, y0), (x1, y1) = corners[0].tolist(), corners[-1].tolist()
        raise DrawingError(
            f"{quoted(name)}: an outline is open, from [{x0:.6g}, {y0:.6g}] to [{x1:.6g}, "
            f"{y1:.6g}] m", f"ends that meet within the tolerance of {tolerance:g} m; their "
            f"distance is {apart:.4g} m")
    kept = corners[:-1]
    # neighbours that are one point but for rounding
    step = np.hypot(*(np.roll(kept, -1, axis=0) - kept).T)
    kept = kept[step > 1e-3 * tolerance]
    if len(kept) < 3:
        raise DrawingError(f"{quoted(name)}: an outline at [{corners[0][0]:.6g}, "
                           f"{corners[0][1]:.6g}] m has no area")
    return tuple((x, y) for x, y in kept.tolist())


def _sorted_out(rings: list[Ring], name: str) -> tuple[Ring, tuple[Ring, ...]]:
    """The largest outline, and the holes in it."""
    if not rings:
        raise DrawingError(f"{quoted(name)} holds no outline",
                           "closed paths, circles, rectangles or polylines, or lines that join")
    rings = sorted(rings, key=lambda ring: -abs(signed_area(ring)))
    outer, holes = rings[0], tuple(rings[1:])
    beside = [hole for hole in holes if not inside(hole[0], outer)]
    if beside:
        x, y = beside[0][0]
        raise DrawingError(
            f"{quoted(name)} holds {1 + len(beside)} outlines that are not one in the other, one "
            f"through [{x:.6g}, {y:.6g}] m", "one outline and its holes: say which by 'layer'")
    return outer, holes


def _chained(curves: list[Array], tolerance: float) -> Iterator[Array]:
    """Curves, those that are open joined end to end."""
    left = []
    for corners in curves:
        if len(corners) > 2 and math.dist(corners[0], corners[-1]) <= tolerance:
            yield np.vstack([corners[:-1], corners[:1]])
        else:
            left.append(corners)
    while left:
        chain = left.pop(0)
        while left and math.dist(chain[0], chain[-1]) > tolerance:
            ends = np.array([(one[0], one[-1]) for one in left])
            apart = np.hypot(*(ends - chain[-1]).transpose(2, 0, 1))
            k, end = np.unravel_index(int(apart.argmin()), apart.shape)
            if apart[k, end] > tolerance:
                break
            following = left.pop(int(k))
            chain = np.vstack([chain, following[::-1][1:] if end else following[1:]])
        yield chain


def flattened(curve: Callable[[Array], Array], tolerance: float) -> Array:
    """Corners of a curve over [0, 1], ends included, none of its chords further off than that."""
    at = np.linspace(0.0, 1.0, 5)
    while True:
        points, step = curve(at), np.diff(at)
        chord = np.diff(points, axis=0)
        length = np.maximum(np.hypot(*chord.T), 1e-300)
        off = np.zeros(len(step))
        for share in (0.25, 0.5, 0.75):
            to = curve(at[:-1] + share * step) - points[:-1]
            along = np.clip((to * chord).sum(axis=1) / length**2, 0.0, 1.0)
            off = np.maximum(off, np.hypot(*(to - along[:, None] * chord).T))
        if not (off > tolerance).any():
            return points
        if len(at) > MOST_POINTS:
            raise DrawingError(f"a curve has more than {MOST_POINTS} corners within the tolerance",
                               "a larger tolerance")
        at = np.sort(np.concatenate([at, (at[:-1] + step / 2)[off > tolerance]]))


def _counted(corners: list[Array]) -> list[Array]:
    if sum(map(len, corners)) > MOST_POINTS:
        raise DrawingError(f"its curves have more than {MOST_POINTS} corners within the tolerance",
                           "a larger tolerance, or fewer curves")
    return corners


def _svg(text: bytes, layer: str | None, unit: float | None, tolerance: float) -> Curves:
    import svgelements

    if found := re.search(rb"<!ENTITY|<use[\s/>]", text):
        word = found[0].decode().strip("<! />").strip()
        raise DrawingError(f"it holds {word!r}, which is not followed",
                           "copies and clones made paths of their own")
    # a drawing's own unit is what its view box counts in, else pixels
    drawn = svgelements.SVG.parse(io.BytesIO(text), reify=True, ppi=96.0)
    box = _svg_box(drawn)
    chosen = drawn if layer is None else drawn.get_element_by_id(layer)
    if chosen is None:
        raise DrawingError(f"it has no id {quoted(layer)}", listed(sorted(drawn.objects)[:20]))
    shapes = ([chosen] if isinstance(chosen, svgelements.Shape) else
              [each for each in chosen.select() if isinstance(each, svgelements.Shape)])
    own = unit if unit is not None else PIXEL * box[0]
    corners: list[Array] = []
    for shape in shapes:
        for part in svgelements.Path(shape).as_subpaths():
            corners.append(_svg_path(svgelements.Path(part), box, tolerance / own))
            _counted(corners)
    return Curves(corners, PIXEL * box[0])


def _svg_box(drawn: Any) -> tuple[float, float, float]:
    """Pixels of one unit of an SVG drawing's view box, and where the box has its origin [px]."""
    import svgelements

    box = svgelements.Matrix(drawn.viewbox_transform or "")
    return abs(float(box.a)) or 1.0, float(box.e), float(box.f)


def _svg_path(path: Any, box: tuple[float, float, float], tolerance: float) -> Array:
    """Corners of a path without gaps, in units of the view box, y up."""
    import svgelements

    found: list[Array] = []
    for segment in path:
        if isinstance(segment, svgelements.Move) or segment.start is None or segment.end is None:
            continue

        def curve(at: Array, segment: Any = segment) -> Array:
            points = np.asarray(segment.npoint(at))
            return np.asarray((points - box[1:]) * (1 / box[0], -1 / box[0]))

        straight = isinstance(segment, (svgelements.Line, svgelements.Close))
        found.append(curve(np.array([0.0, 1.0])) if straight else flattened(curve, tolerance))
        _counted(found)
    return np.vstack([found[0], *(each[1:] for each in found[1:])]) if found else np.zeros((0, 2))


def _dxf(text: bytes, layer: str | None, unit: float | None, tolerance: float) -> Curves:
    from ezdxf import path, recover, units
    from ezdxf.enums import InsertUnits

    document, _ = recover.read(io.BytesIO(text))
    own = None
    if document.units:
        own = units.conversion_factor(
            InsertUnits(document.units), InsertUnits.Meters)
    scale = own if unit is None else unit
    if scale is None:
        raise DrawingError("it does not say its unit", "'unit', such as \"unit\": \"1 mm\"")
    space = list(document.modelspace())
    layers = sorted({entity.dxf.layer for entity in space})
    if layer is not None and layer not in layers:
        raise DrawingError(f"it has no layer {quoted(layer)}", listed(layers), near(layer, layers))
    corners: list[Array] = []
    for entity in space:
        if layer is not None and entity.dxf.layer != layer:
            continue
        if entity.dxftype() == "INSERT":
            raise DrawingError(f"it holds the block {quoted(entity.dxf.name)}, which is not "
                               "followed", "blocks exploded into lines and curves")
        if entity.dxftype() not in CURVES:
            continue
        drawn = path.make_path(entity)
        size = max((abs(v) for point in drawn.control_vertices() for v in (point.x, point.y)),
                   default=0.0)
        finest = max(tolerance / scale, FINEST * size)
        corners.append(np.array([(point.x, point.y) for point in drawn.flattening(finest)]))
        _counted(corners)
    return Curves(corners, own)


READERS: dict[str, Callable[[bytes, str | None, float | None, float], Curves]] = {
    ".svg": _svg, ".dxf": _dxf}
"""What reads a drawing, by the ending of its name."""
