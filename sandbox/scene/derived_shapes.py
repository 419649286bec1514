"""Shapes that are worked out from something else, and are polygons once a scene is read."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from sandbox.numeric import Array
from sandbox.scene.outlines.cams import CamCurve, tried_turns
from sandbox.scene.outlines.curves import through
from sandbox.values.numbers import Angle, Coordinate, Distance, Flag, Items, Length, Point
from sandbox.values.spec import TYPE, Spec
from sandbox.values.tables import PeriodicSpline, check_distinct
from sandbox.wording import WrongValueError


class SmoothCurve(Spec):
    """A smooth curve through points: a closed outline, or an open line such as a track.

    Bodies touch the curve itself: its normal and curvature, not chords. A closed one is a solid. An
    open one belongs to a body that does not move freely, and both of its sides can be touched.
    Between the points lies a cubic spline.
    """

    type: Literal["curve"] = TYPE
    points: Annotated[Items[Point], Field(min_length=3, max_length=1000)]
    """Points that it passes through, in order [m]; the last of a closed one is not the first."""
    closed: Flag = True
    """Whether it continues from the last point to the first and bounds a solid."""
    corners: Items[Annotated[int, Field(ge=0)]] = ()
    """Indices of the points with a corner, from 0; the curve is smooth elsewhere."""
    radius: Distance = 0.0
    """Of an open curve: distance of its surface from the curve."""
    tolerance: Length = 1e-5
    """Maximum deviation of its chords in pictures and in its area; contacts do not depend on it."""
    at: Point = (0.0, 0.0)
    """Position of the points' origin in the body's frame."""
    angle: Angle = 0.0
    """Rotation about that origin in the body's frame."""

    @model_validator(mode="after")
    def _sound(self) -> Self:
        if self.closed and self.radius:
            raise WrongValueError("conflicting-keys", "'radius' belongs to an open curve",
                                  allowed="'\"closed\": false', or no 'radius'")
        if self.corners and max(self.corners) >= len(self.points):
            raise WrongValueError("out-of-range", f"there is no point {max(self.corners)}",
                                  allowed=f"0 to {len(self.points) - 1}")
        check_distinct(self.points, closed=self.closed)
        return self

    def curve(self) -> Array:
        """Its nodes, [n, 4].

        Raises:
            WrongValueError: it turns back on itself, because its points lie in one line.
        """
        with np.errstate(invalid="ignore", divide="ignore"):
            nodes = through(np.array(self.points), closed=self.closed,
                            corners=tuple(sorted(set(self.corners))))
        if not np.isfinite(nodes).all():
            raise WrongValueError("bad-outline", "this curve turns back on itself at a point",
                                  allowed="points round an area, or a corner where it turns back")
        return nodes


class DiscCam(Spec):
    """A disc cam whose outline gives its follower the lift of a table.

    The lift between the table's angles is a smooth curve, a periodic cubic spline. The follower
    moves along a line through the cam's centre. Contacts follow the true outline. Once read, a cam
    is a polygon with nodes.
    """

    type: Literal["cam"] = TYPE
    base: Length
    """Radius of the outline where the lift is 0."""
    lift: Annotated[Items[tuple[Angle, Coordinate]], Field(min_length=3, max_length=720)]
    """How far the follower is raised, by how far the cam has turned: `[angle, lift]`.

    Angles rise over less than a whole turn; the curve continues from the last to the first.
    """
    follower: Literal["roller", "flat"] = "roller"
    """Type of follower: a roller, or a flat face across its path."""
    roller: Length | None = None
    """Radius of the roller; for a roller only."""
    towards: Angle = math.pi / 2
    """Direction from the cam's centre to the follower, in the body's frame at its angle 0."""
    turns: Literal["counterclockwise", "clockwise"] = "counterclockwise"
    """Sense in which the table's angles count the cam's rotation."""
    at: Point = (0.0, 0.0)
    """Centre of rotation, in the body's frame."""
    tolerance: Length = 1e-5
    """Maximum deviation of chords in pictures and in its area; contacts do not depend on it."""

    @model_validator(mode="after")
    def _whole(self) -> Self:
        if self.follower == "roller" and self.roller is None:
            raise WrongValueError("missing-key", "'roller' is missing (its radius)",
                                  allowed="a 'roller', or '\"follower\": \"flat\"'")
        if self.follower == "flat" and self.roller is not None:
            raise WrongValueError("conflicting-keys", "a flat follower has no 'roller'",
                                  allowed="no 'roller', or '\"follower\": \"roller\"'")
        angles = [angle for angle, _ in self.lift]
        for i, (one, two) in enumerate(pairwise(angles)):
            if two - one < 1e-6:
                raise WrongValueError("bad-outline", "the angles of 'lift' must increase: entry "
                                      f"{i + 1} has {math.degrees(two):.6g} deg after "
                                      f"{math.degrees(one):.6g} deg")
        if angles[-1] - angles[0] > math.tau - 1e-6:
            raise WrongValueError("bad-outline", "the angles of 'lift' cover "
                                  f"{math.degrees(angles[-1] - angles[0]):.6g} deg; plain numbers "
                                  "are radians", allowed="less than a whole turn, without the "
                                  "first entry again at its end; '15 deg' for degrees")
        return self

    def curve(self) -> CamCurve:
        """The outline about the cam's centre."""
        angles, lifts = np.array(self.lift).T
        return CamCurve(
            PeriodicSpline(angles, lifts), tried_turns(angles), self.base, self.roller or 0.0,
            self.towards, 1 if self.turns == "counterclockwise" else -1)


class Drawing(Spec):
    """A shape from an SVG or DXF file: its largest outline, with the outlines inside as holes.

    It is read into a polygon; a saved scene no longer needs the file.
    """

    type: Literal["drawing"] = TYPE
    file: Annotated[str, Field(min_length=1, max_length=200)]
    """Name of a `.svg` or `.dxf` file in the scene's own folder or below it."""
    unit: Length | None = None
    """Length of one unit of the drawing (of an SVG file's view box); by default as in the file.

    An SVG file without units uses pixels of 1/96 inch.
    """
    layer: Annotated[str, Field(max_length=200)] | None = None
    """Reads only this layer of a DXF file, or the element with this id in an SVG file."""
    tolerance: Length = 5e-5
    """Maximum gap between connected ends, and maximum deviation of chords in pictures and in the
    area."""
    at: Point = (0.0, 0.0)
    """Position of the drawing's origin in the body's frame; the drawing's y is up."""
    angle: Angle = 0.0
    """Rotation of the drawing about its origin, in the body's frame."""
