"""Bodies and their shapes. A body's points are in its own frame [m]."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from pydantic import AfterValidator, Field, PrivateAttr, ValidationInfo, field_validator

from sandbox.elements.element import Placed, Reference
from sandbox.errors import SceneError
from sandbox.scene.outlines.cams import DiscCam
from sandbox.scene.outlines.curves import SmoothCurve, flattened, turned
from sandbox.scene.outlines.drawings import Drawing
from sandbox.scene.outlines.rings import (
    PIECE_CORNERS,
    Ring,
    hole_fault,
    is_convex,
    pieces_of,
    ring_fault,
)
from sandbox.values import numbers as of
from sandbox.values.appearance import FillColour, Planes
from sandbox.values.signals import Path
from sandbox.values.spec import TYPE, Spec
from sandbox.values.tables import check_distinct
from sandbox.values.units import size_fault
from sandbox.wording import WrongValueError, refuse_if


class Circle(Spec):
    """A disc."""

    type: Literal["circle"] = TYPE
    radius: of.Length
    """Its radius [m]."""
    at: of.Point = (0.0, 0.0)
    """Its centre in the body's frame [m]."""


class Box(Spec):
    """A rectangle about ``at``, turned by ``angle`` in the body's frame."""

    type: Literal["box"] = TYPE
    size: of.Pair[of.Length]
    """[width, height] along its own x and y [m]."""
    at: of.Point = (0.0, 0.0)
    """Its centre in the body's frame [m]."""
    angle: Annotated[of.Angle, Placed("sign")] = 0.0
    """Its turn against the body's frame [rad], counter-clockwise."""


SHAPES = ("shapes", "displaces")  # fields of a body that hold outlines
SOUND = "an outline with an area that does not touch or cross itself"
MAX_CORNERS = 2000  # of a polygon with its holes, or of a polyline
Outline = Annotated[of.Items[of.Point], Field(min_length=3, max_length=MAX_CORNERS)]
Nodes = tuple[tuple[tuple[of.Coordinate, of.Coordinate, float, float], ...], ...]
AT_CORNER = 1e-6
"""Maximum distance of a node from a corner of its outline, as a share of the outline's size."""


def _check_nodes(nodes: Nodes, rings: Sequence[Ring]) -> None:
    """Check that nodes lie at corners of their outlines."""
    refuse_if(nodes and len(nodes) != len(rings), f"there are {len(nodes)} curves of 'nodes'",
              "bad-outline", allowed=f"{len(rings)}, one for each outline, or none")
    for number, (curve, ring) in enumerate(zip(nodes, rings, strict=False)):
        places, corners = np.array(curve).reshape(-1, 4)[:, :2], np.array(ring)
        size = float(np.ptp(corners, axis=0).max())
        apart = np.hypot(*(places[:, None] - corners).transpose(2, 0, 1)).min(axis=1)
        refuse_if(len(np.unique(places, axis=0)) < 2 or apart.max() > AT_CORNER * size,
                  f"the nodes of curve {number} are not on its outline", "bad-outline",
                  allowed="two or more nodes, each at a corner")


def _check_ring(ring: Ring, hole: str = "") -> Ring:
    refuse_if(fault := ring_fault(ring), f"{hole}{fault}", "bad-outline", allowed=SOUND)
    _check_sides((*ring, ring[0]))
    return ring


def _check_sides(points: Ring) -> Ring:
    fault = size_fault(min(math.dist(p, q) for p, q in pairwise(points)), "length")
    refuse_if(fault, f"the shortest side is {fault}", "out-of-range")
    return points


class Polygon(Spec):
    """An outline of straight sides, convex or not, with or without holes.

    It is cut into convex pieces, whose seams are neither touched nor drawn. It has at most 2000
    corners, including those of its holes.
    """

    type: Literal["polygon"] = TYPE
    points: Annotated[Outline, AfterValidator(_check_ring)]
    """Its corners in order, in the body's frame [m]; the outline may not touch or cross itself."""
    holes: Annotated[of.Items[Outline], Field(max_length=MAX_CORNERS)] = ()
    """Outlines of its holes, separate and inside the outline; corners as in ``points``."""
    nodes: Annotated[Nodes, Placed("nodes")] = ()
    """True curves of the outline and of each hole, from a curve, cam or drawing: contacts follow
    them instead of the sides. A node is `[x, y, direction, curvature]`; two at the same place are a
    corner or a jump of the curvature."""
    _swing: tuple[float, float, float] | None = PrivateAttr(None)

    @property
    def swing(self) -> tuple[float, float, float] | None:
        """Of a cam just read, :meth:`sandbox.scene.outlines.cams.DiscCam.swing`."""
        return self._swing

    @field_validator("holes")
    @classmethod
    def _check_holes(cls, holes: tuple[Ring, ...], info: ValidationInfo) -> tuple[Ring, ...]:
        outer = info.data.get("points")
        if not holes or outer is None:  # the points have a message of their own
            return holes
        for k, ring in enumerate(holes):
            _check_ring(ring, f"hole {k}: ")
        fault = hole_fault(outer, holes)
        refuse_if(fault, fault, "bad-outline", allowed=SOUND)
        return holes

    def _verify(self) -> None:
        corners = len(self.points) + sum(map(len, self.holes))
        refuse_if(corners > MAX_CORNERS, f"this outline and its holes have {corners} corners",
                  "bad-outline", allowed=f"at most {MAX_CORNERS}")
        _check_nodes(self.nodes, (self.points, *self.holes))
        if not self.whole:
            pieces_of(self.points, self.holes)

    @property
    def whole(self) -> bool:
        """Whether it is one convex piece by itself."""
        return not self.holes and len(self.points) <= PIECE_CORNERS and is_convex(self.points)


class Polyline(Spec):
    """A line from point to point, such as uneven ground, of a body that does not move freely.

    Sliding bodies are not caught at its joints. Both of its sides can be touched.
    """

    type: Literal["polyline"] = TYPE
    points: Annotated[of.Items[of.Point], Field(min_length=2, max_length=MAX_CORNERS),
                      AfterValidator(partial(check_distinct, closed=False)),
                      AfterValidator(_check_sides)]
    """Its corners and ends; closed if the last point equals the first."""
    radius: of.Distance = 0.0
    """Distance of its surface from the line through its points."""
    nodes: Annotated[Nodes, Placed("nodes")] = ()
    """The true curve, as of a polygon."""

    def _verify(self) -> None:
        _check_nodes(self.nodes, (self.points,))


class Capsule(Spec):
    """A segment from ``start`` to ``end`` with a radius: a phalanx."""

    type: Literal["capsule"] = TYPE
    start: of.Point = (0.0, 0.0)
    """Centre of one round end, in the body's frame [m]."""
    end: of.Point
    """Centre of the other round end, in the body's frame [m]."""
    radius: of.Length
    """Half its thickness, and the radius of its ends [m]."""


Solid = Circle | Box | Polygon | Capsule  # shapes with an area; only a polygon may not be convex
Shape = Solid | Polyline
WrittenShape = Annotated[Shape | SmoothCurve | DiscCam | Drawing, Field(discriminator="type")]
"""Shapes as an author writes them."""


def made(shape: Shape | DiscCam | Drawing | SmoothCurve, info: ValidationInfo) -> Shape:
    """The polygon or polyline of a curve, cam or drawing; any other shape as it is."""
    if not isinstance(shape, DiscCam | Drawing | SmoothCurve):
        return shape
    rings = shape.curves((info.context or {}).get("folder")) if isinstance(shape, Drawing) else \
        [shape.curve()]
    turn = 0.0 if isinstance(shape, DiscCam) else shape.angle
    rings = [turned(nodes, turn, shape.at) for nodes in rings]
    closed = not isinstance(shape, SmoothCurve) or shape.closed
    flat = [flattened(each, shape.tolerance, closed=closed) for each in rings]
    corners = sum(map(len, flat))  # they go by the root of the tolerance
    refuse_if(corners > MAX_CORNERS, f"the tolerance of {shape.tolerance:.3g} m needs {corners} "
              f"corners, more than {MAX_CORNERS}", "bad-outline",
              allowed=f"a tolerance of {2 * shape.tolerance * (corners / MAX_CORNERS)**2:.1g} m")
    nodes: Nodes = tuple(tuple(map(tuple, each.tolist())) for each in rings) if any(
        each[:, 3].any() for each in rings) else ()  # of straight lines none
    try:
        if isinstance(shape, SmoothCurve) and not closed:
            return Polyline(points=flat[0], radius=shape.radius, nodes=nodes)
        found = Polygon(points=flat[0], holes=tuple(flat[1:]), nodes=nodes)
    except SceneError as error:
        # corners of chords are not those that the author wrote: the place is enough
        raise WrongValueError("bad-outline", error.problems[0].message.partition(", where")[0],
                              allowed=SOUND) from None
    if isinstance(shape, DiscCam):
        found._swing = shape.swing()
    return found


if TYPE_CHECKING:
    BodyShape = Shape
else:
    BodyShape = Annotated[WrittenShape, AfterValidator(made)]
Role = Literal["link", "ground", "palm", "phalanx", "rocker", "pulley", "object"]


class Body(Spec):
    """A rigid body: initial pose, motion, mass and appearance.

    Its mass is ``mass``, or ``density`` times ``thickness`` times the area of its shapes.
    """

    name: of.Name
    """Its name; quantities are ``<name>.x``, ``<name>.angle`` and so on."""
    at: Annotated[of.Point, Placed("place")] = (0.0, 0.0)
    """Origin of the body's frame in the world at t = 0 [m]."""
    angle: Annotated[of.Angle, Placed("turn")] = 0.0
    """Turn of the body's frame against the world at t = 0 [rad], counter-clockwise."""
    motion: Literal["dynamic", "fixed", "scheduled"] = "dynamic"
    """``dynamic`` moves by forces, ``fixed`` does not move, ``scheduled`` follows its ``path``."""
    path: Annotated[Path | None, Placed("kept")] = None
    """Pose over time; required for ``"motion": "scheduled"``, and only allowed there."""
    shapes: of.Items[BodyShape] = ()
    """Its shapes in its frame, for contacts, pictures and mass. Without shapes it touches
    nothing."""
    displaces: of.Items[BodyShape] = ()
    """Shapes that displace liquid (load ``buoyancy``), in its frame; by default its ``shapes``. A
    bin of three walls floats by one polygon around it. They touch and weigh nothing."""
    mass: of.Mass | None = None
    """Mass [kg]; a dynamic body has either this or ``density``."""
    density: of.Density | None = None
    """Mass per volume [kg/m^3], instead of ``mass``."""
    thickness: Annotated[of.Length, Placed("kept")] = 0.01
    """Depth across the plane [m]; used with ``density`` and in a liquid only."""
    centre: of.Point | None = None
    """Centre of mass in the body's frame [m]; by default that of the shapes' area."""
    inertia: of.Inertia | None = None
    """Moment of inertia about the centre of mass [kg m^2]; by default that of the shapes' area."""
    velocity: Annotated[of.Pair[of.Speed], Placed("vector")] = (0.0, 0.0)
    """Velocity [x, y] of the centre of mass at t = 0, in the world [m/s]."""
    angular_velocity: Annotated[of.AngularSpeed, Placed("sign")] = 0.0
    """Angular velocity at t = 0 [rad/s], counter-clockwise."""
    material: Annotated[of.Name, Reference("materials")] | None = None
    """Name of one of the scene's ``materials``; without one, friction is 0.5 and restitution 0."""
    plane: Planes = (0,)
    """Plane number: bodies of different planes never touch; higher numbers are drawn in front. A
    body with a list of planes touches the bodies of each and is drawn in the lowest; ``"all"``
    touches everything and is drawn behind."""
    role: Role = "link"
    """For pictures and grasps, not for the motion: an ``object`` has grasp quantities, ``ground``
    is not part of a hand."""
    colour: FillColour | None = None
    """Its fill in pictures: white, grey, black, blue, teal, green, yellow, orange, red, pink,
    purple, brown, or ``"#f5c542"``; by default that of its material, else that of its role."""
    fill: of.Flag = True
    """False draws only the outline; a circle whose radius a drive changes stays filled."""

    def _verify(self) -> None:
        refuse_if((self.motion == "scheduled") != (self.path is not None),
                  "'path' and \"motion\": \"scheduled\" belong together")
        refuse_if(any(isinstance(shape, Polyline) for shape in self.displaces), "a polyline has no "
                  "area that could keep a liquid away", "bad-outline",
                  allowed="shapes with an area for 'displaces'")
        if self.motion == "dynamic":
            refuse_if(any(isinstance(shape, Polyline) for shape in self.shapes), "a dynamic body "
                      "cannot have a polyline or open curve: it has no area", "bad-outline",
                      allowed='"motion": "fixed" or "scheduled"; or a closed shape')
            refuse_if((self.mass is None) == (self.density is None),
                      "a dynamic body needs either 'mass' or 'density'")
            refuse_if(not self.shapes and (self.inertia is None or self.mass is None),
                      "a dynamic body without shapes needs 'mass' and 'inertia'")


BOUNCING_SKIN = "'restitution' is for rigid surfaces; a 'skin' rebounds by its stiffness"
STATIC_OF_NOTHING = "'static' is a multiple of 'friction', which is 0"


class Skin(Spec):
    """A soft layer on a surface: a spring and a damper at each contact point.

    Along the surface a sticking contact has two thirds of both. Two skins act in series.
    """

    stiffness: of.Stiffness = Field(gt=0)
    """Normal force per depth of each contact point [N/m]."""
    damping: of.Damping = 0.0
    """Force per rate of the depth [N s/m]; 0 by default."""
    thickness: of.Length | None = None
    """Depth at which the layer is squeezed to nothing [m]; the audit warns beyond it."""


class Material(Spec):
    """A contact surface with friction, restitution and, if it is soft, a skin.

    Friction, static and restitution of a pair are the geometric means of the two.
    """

    friction: of.Ratio = 0.5
    """Coulomb coefficient, 0 or more, of two surfaces of this material."""
    static: of.Ratio = Field(default=1.0, ge=1)
    """Ratio of static to sliding friction, 1 or more; 1 by default."""
    restitution: of.Share = 0.0
    """Rebound speed over approach speed of two surfaces of this material: 0 does not bounce, 1
    loses nothing."""
    skin: Skin | None = None
    """A soft layer; by default contacts are rigid. A soft surface does not bounce."""
    colour: FillColour | None = None
    """Fill in pictures of the bodies of this material, as a body's ``colour``."""

    def _verify(self) -> None:
        refuse_if(self.static > 1 and not self.friction, STATIC_OF_NOTHING)
        refuse_if(self.skin and self.restitution, BOUNCING_SKIN)
