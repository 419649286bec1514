"""Outlines from drawings: SVG files by svgelements, DXF files by ezdxf.

Lines, arcs and splines become nodes (:mod:`sandbox.scene.outlines.curves`); open ones are joined
end to end. The largest outline is the shape's and those in it are its holes. Files come from the
scene's own folder, and references in them are not followed.
"""

from __future__ import annotations

import contextlib
import io
import math
import re
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path, PurePosixPath
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field

from sandbox.numeric import Array
from sandbox.scene.outlines.curves import (
    flattened,
    is_smooth,
    joined,
    nodes_along,
    nodes_of,
    reversed_nodes,
)
from sandbox.scene.outlines.rings import inside, signed_area
from sandbox.values.numbers import Angle, Length, Point
from sandbox.values.spec import TYPE, Spec
from sandbox.wording import WrongValueError, listed, near, quoted, refuse_if

MAX_BYTES = 1_000_000  # of a drawing: some seconds of reading
MAX_NODES = 20_000  # of all curves of a drawing
FINE = 1e-7  # maximum distance of spans from a curve, as a share of its size
POINT = 1e-9  # a piece that is smaller than this share of the largest is rounding
NEXT = 1e-4  # parameter next to the end of a curve
ARCS = 16  # cubic curves of a whole turn: within 1e-8 of the radius
CURVES = frozenset({"LINE", "LWPOLYLINE", "POLYLINE", "CIRCLE", "ARC", "ELLIPSE", "SPLINE"})
"""Entities of a DXF file that are read; others, such as dimensions and texts, are no outline."""
PIXEL = 0.0254 / 96  # of an SVG file without a unit of its own [m]
CODE = "bad-drawing"  # of a drawing without a usable outline


class Drawing(Spec):
    """A shape from an SVG or DXF file: its largest outline, with the outlines inside as holes.

    It is read into a polygon; a saved scene no longer needs the file.
    """

    type: Literal["drawing"] = TYPE
    file: Annotated[str, Field(min_length=1, max_length=200)]
    """Name of a `.svg` or `.dxf` file in the scene's own folder or below it."""
    unit: Length | None = None
    """Length of one unit of the drawing (of an SVG file's view box); by default as in the file, or
    1/96 inch for an SVG file without units."""
    layer: Annotated[str, Field(max_length=200)] | None = None
    """Reads only this layer of a DXF file, or the element with this id in an SVG file."""
    tolerance: Length = 5e-5
    """Maximum gap between connected ends, and deviation of chords in pictures and in the area."""
    at: Point = (0.0, 0.0)
    """Position of the drawing's origin in the body's frame; the drawing's y is up."""
    angle: Angle = 0.0
    """Rotation of the drawing about its origin, in the body's frame."""

    def curves(self, folder: Path | None) -> list[Array]:
        """Nodes [k, 4] of its outline, then of its holes, from the file in the scene's folder."""
        text, name = own_file(folder, self.file), quoted(self.file)
        ending = PurePosixPath(self.file).suffix.lower()
        refuse_if(ending not in READERS, f"{name} is neither an SVG nor a DXF file", CODE,
                  allowed=".svg, .dxf")
        try:
            curves, own = READERS[ending](text, self.layer)
        except WrongValueError as error:
            raise WrongValueError(CODE, f"{name}: {error.message}", allowed=error.allowed,
                                  hint=error.hint) from None
        except Exception as error:  # parsers raise many types of errors
            reason = " ".join(str(error).split())[:100] or type(error).__name__
            raise WrongValueError(
                CODE, f"{name} cannot be read as {ending[1:].upper()}: {reason}",
                allowed="a sound file, such as a drawing program writes it") from None
        scale = own if self.unit is None else self.unit
        if scale is None:
            raise WrongValueError(CODE, f"{name}: it has no unit",
                                  allowed="'unit', such as \"unit\": \"1 mm\"")
        scaled = [nodes * [scale, scale, 1.0, 1 / scale] for nodes in curves]
        curves = [_closed(nodes, self.tolerance, name)
                  for nodes in _chained(scaled, self.tolerance)]
        refuse_if(not curves, f"{name} has no outline", CODE,
                  allowed="closed paths, circles, rectangles or polylines, or lines that join")
        size = max(float(np.ptp(nodes[:, :2], axis=0).max()) for nodes in curves)
        flat = [flattened(nodes, 1e-4 * size, closed=True) for nodes in curves]
        order = sorted(range(len(curves)), key=lambda k: -abs(signed_area(flat[k])))
        beside = [flat[k][0] for k in order[1:] if not inside(flat[k][0], flat[order[0]])]
        for x, y in beside[:1]:
            refuse_if(beside, f"{name} holds {1 + len(beside)} outlines that are not one in the "
                      f"other, one through [{x:.6g}, {y:.6g}] m", CODE,
                      allowed="one outline and its holes: select it by 'layer'")
        return [curves[k] for k in order]


def own_file(folder: Path | None, name: str) -> bytes:
    """The content of a file in a scene's own folder, or below it."""
    if folder is None:
        raise WrongValueError(CODE, "a scene that is no file has no folder to read a drawing from",
                              allowed="a polygon with the corners themselves")
    found = b""
    try:
        path = (folder / name).resolve(strict=True)
        outside = not path.is_relative_to(folder.resolve(strict=True))
        if path.is_file() and not outside:  # a pipe may never end
            with path.open("rb") as file:
                found = file.read(MAX_BYTES + 1)
    except (OSError, RuntimeError, ValueError):
        there: list[str] = []
        with contextlib.suppress(OSError):
            there = sorted(each.name for each in folder.iterdir() if each.suffix.lower() in READERS)
        raise WrongValueError(
            CODE, f"there is no file {quoted(name)} that can be read in the scene's folder",
            allowed=listed(there) or "none: it has no .svg and no .dxf file",
            hint=near(name, there)) from None
    refuse_if(outside, f"{quoted(name)} leads out of the scene's own folder", CODE,
              allowed="a name such as 'plate.svg' or 'parts/plate.dxf', below the scene's")
    refuse_if(not found, f"{quoted(name)} is empty, or no file", CODE, allowed="an SVG or DXF file")
    refuse_if(len(found) > MAX_BYTES, f"{quoted(name)} is too large for the drawing of an outline",
              CODE, allowed=f"at most {MAX_BYTES} bytes, with nothing in it but the outline")
    return found


def _closed(nodes: Array, tolerance: float, name: str) -> Array:
    apart = math.dist(nodes[0, :2], nodes[-1, :2])
    (x0, y0), (x1, y1) = nodes[0, :2].tolist(), nodes[-1, :2].tolist()
    refuse_if(apart > tolerance, f"{name}: an outline is open, from [{x0:.6g}, {y0:.6g}] "
              f"to [{x1:.6g}, {y1:.6g}] m", CODE, allowed="ends that meet within the tolerance of "
              f"{tolerance:g} m; their distance is {apart:.4g} m")
    refuse_if(len(flattened(nodes, tolerance, closed=False)) < 4,
              f"{name}: an outline at [{x0:.6g}, {y0:.6g}] m has no area", CODE)
    nodes[-1, :2] = nodes[0, :2]
    return nodes[:-1] if is_smooth(nodes[-1], nodes[0]) else nodes


def _chained(curves: list[Array], tolerance: float) -> Iterator[Array]:
    left = []
    for nodes in curves:
        if len(nodes) > 2 and math.dist(nodes[0, :2], nodes[-1, :2]) <= tolerance:
            yield nodes
        else:
            left.append(nodes)
    while left:
        chain = left.pop(0)
        while left and math.dist(chain[0, :2], chain[-1, :2]) > tolerance:
            ends = np.array([(one[0, :2], one[-1, :2]) for one in left])
            apart = np.hypot(*(ends - chain[-1, :2]).transpose(2, 0, 1))
            k, end = np.unravel_index(int(apart.argmin()), apart.shape)
            if apart[k, end] > tolerance:
                break
            following = left.pop(int(k))
            chain = joined([chain, reversed_nodes(following) if end else following])
        yield chain


def _bezier(points: Array) -> Callable[[Array], Array]:
    """Nodes of a Bézier curve at parameters of [0, 1]."""
    degree = len(points) - 1
    first, second = np.diff(points, axis=0), np.diff(points, 2, axis=0)

    def at(control: Array, t: Array) -> Array:
        n = len(control) - 1
        weights = [math.comb(n, k) * t**k * (1 - t) ** (n - k) for k in range(n + 1)]
        return np.asarray(np.transpose(weights) @ control) if weights else np.zeros((len(t), 2))

    def nodes(t: Array) -> Array:
        # where the speed is 0, because control points coincide, take what is next to it
        still = np.hypot(*at(first, t).T) < 1e-9 * np.hypot(*first.T).max()
        beside = np.where(still, np.clip(t, NEXT, 1 - NEXT), t)
        return nodes_of(at(points, t), degree * at(first, beside),
                        degree * (degree - 1) * at(second, beside))

    return nodes


def _all_nodes(drawn: Iterable[list[Array]]) -> list[Array]:
    """Nodes [k, 4] of curves, each of consecutive Bézier curves by their 2 to 4 control points."""
    curves: list[Array] = []
    for pieces in drawn:
        sizes = [float(np.ptp(points, axis=0).max()) for points in pieces]
        found = [nodes_along(_bezier(points), np.array([0.0, 1.0]), FINE * size)
                 for points, size in zip(pieces, sizes, strict=True) if size > POINT * max(sizes)]
        curves += [joined(found)] if found else []
        refuse_if(sum(map(len, curves)) > MAX_NODES, "its curves have more than "
                  f"{MAX_NODES} nodes", CODE, allowed="fewer curves")
    return curves


def _svg(text: bytes, layer: str | None) -> tuple[list[Array], float | None]:
    import svgelements

    if found := re.search(rb"<!ENTITY|<use[\s/>]", text):
        word = found[0].decode().strip("<! />").strip()
        raise WrongValueError(CODE, f"it holds {word!r}, which is not followed",
                              allowed="copies and clones made paths of their own")
    # a drawing's own unit is that of its view box, else pixels
    drawn = svgelements.SVG.parse(io.BytesIO(text), reify=True, ppi=96.0)
    view = svgelements.Matrix(drawn.viewbox_transform or "")
    box = abs(float(view.a)) or 1.0, float(view.e), float(view.f)
    chosen = drawn if layer is None else drawn.get_element_by_id(layer)
    refuse_if(chosen is None, f"it has no id {quoted(layer)}", CODE,
              allowed=listed(sorted(drawn.objects)[:20]))
    shapes = ([chosen] if isinstance(chosen, svgelements.Shape) else
              [each for each in chosen.select() if isinstance(each, svgelements.Shape)])
    paths = (svgelements.Path(part) for shape in shapes
             for part in svgelements.Path(shape).as_subpaths())

    def control_points(path: Any) -> list[Array]:
        """Of a path, in units of the view box, y up."""
        found: list[Array] = []
        for segment in path:
            if isinstance(segment, svgelements.Move) or None in (segment.start, segment.end):
                continue
            pieces = [segment]
            if isinstance(segment, svgelements.Arc):
                count = max(1, math.ceil(abs(segment.sweep) / math.tau * ARCS))
                pieces = list(segment.as_cubic_curves(count))
            for piece in pieces:
                found.append((np.array([(p.x, p.y) for p in piece]) - box[1:])
                             * (1 / box[0], -1 / box[0]) + 0.0)
        return found

    return _all_nodes(map(control_points, paths)), PIXEL * box[0]


def _dxf(text: bytes, layer: str | None) -> tuple[list[Array], float | None]:
    from ezdxf import path, recover, units
    from ezdxf.enums import InsertUnits

    document, _ = recover.read(io.BytesIO(text))
    own = None
    if document.units:
        own = units.conversion_factor(InsertUnits(document.units), InsertUnits.Meters)
    space = list(document.modelspace())
    layers = sorted({entity.dxf.layer for entity in space})
    if layer is not None and layer not in layers:
        raise WrongValueError(CODE, f"it has no layer {quoted(layer)}", allowed=listed(layers),
                              hint=near(layer, layers))
    chosen = [entity for entity in space if layer is None or entity.dxf.layer == layer]
    for block in (entity for entity in chosen if entity.dxftype() == "INSERT"):
        refuse_if(block, f"it holds the block {quoted(block.dxf.name)}, which is not followed",
                  CODE, allowed="blocks exploded into lines and curves")

    def control_points(entity: Any) -> list[Array]:
        drawn = path.make_path(entity, segments=ARCS)
        pieces, at = [], drawn.start
        for command in drawn.commands():
            end, *control = command
            pieces.append(np.array([(p.x, p.y) for p in (at, *control, end)]))
            at = end
        return pieces

    return _all_nodes(control_points(each) for each in chosen if each.dxftype() in CURVES), own


READERS: dict[str, Callable[[bytes, str | None], tuple[list[Array], float | None]]] = {
    ".svg": _svg, ".dxf": _dxf}
"""By extension: the nodes of a drawing's curves [k, 4] in its units, y up; one unit [m] or None."""
