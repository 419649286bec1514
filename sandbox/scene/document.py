"""The Scene: a mechanism as its author wrote it, with parameters, templates and parts."""

from __future__ import annotations

import dataclasses
from typing import Annotated, Any, Literal

from pydantic import Field

from sandbox.elements.fluids import Line, Valve
from sandbox.elements.loads import Load
from sandbox.elements.registry import Controller, Drive, Joint
from sandbox.elements.springs import Spring
from sandbox.elements.tendons import Tendon
from sandbox.scene.bodies import Body, Material
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.parts.assembly import expand_parts, placed
from sandbox.scene.parts.expansion import Elements, Known, PartError, PartSpec
from sandbox.scene.parts.finger import Finger
from sandbox.scene.parts.placement import Mirror, Placement
from sandbox.scene.parts.section import Section
from sandbox.scene.parts.trees import PulleyTree, RockerTree
from sandbox.scene.settings import ContactRule, Event, Group, Meter
from sandbox.values.numbers import POSITIVE, Angle, Items, Name, Number, Point, Quantity
from sandbox.values.spec import TYPE


class Assembly(PartSpec):
    """Elements and parts in one piece: placed, turned, mirrored and scaled as one.

    They are written as in a scene, about an origin of their own. In the scene their names begin
    with the assembly's: its ``jaw`` is ``left.jaw``. A name that the assembly does not have is the
    scene's. It is scaled first, then mirrored, then turned, then moved.
    """

    type: Literal["assembly"] = TYPE
    name: Name
    """Of the assembly; the names of its elements begin with it and a dot."""
    at: Point = (0.0, 0.0)
    """Its origin, in the world or in the assembly that it is part of."""
    angle: Angle = 0.0
    """Rotation about its origin."""
    mirror: Mirror | None = None
    """Sides to mirror, about its origin. Hinges then count the opposite sense as positive, so their
    angles, stops and drives do not change."""
    scale: Annotated[Number, POSITIVE] = 1.0
    """Of all lengths in the plane, and of speeds; inertias by its square. Masses, stiffnesses,
    forces, areas of pistons and volumes stay as they are written, and so does ``thickness``."""
    materials: dict[Name, Material] = Field(default_factory=dict)
    """Its own contact surfaces, by name."""
    bodies: Items[Body] = ()
    """Its bodies."""
    joints: Items[Joint] = ()
    """Its joints; one of the two bodies may be the scene's."""
    springs: Items[Spring] = ()
    """Its springs."""
    tendons: Items[Tendon] = ()
    """Its tendons."""
    lines: Items[Line] = ()
    """Its lines of fluid."""
    valves: Items[Valve] = ()
    """Its valves."""
    loads: Items[Load] = ()
    """Its loads. Their expressions, components and levels are of the world, however the assembly is
    turned."""
    drives: Items[Drive] = ()
    """Its drives."""
    controllers: Items[Controller] = ()
    """Its controllers. They read quantities as they are: in a mirror those of hinges stay the
    same, a body's ``x`` and ``angle`` do not."""
    events: Items[Event] = ()
    """Its events."""
    contacts: Items[ContactRule] = ()
    """Contact rules among its bodies and with the scene's; the scene's own rules come later."""
    groups: Items[Group] = ()
    """Its groups. All its bodies together are a group of the assembly's name."""
    meters: Items[Meter] = ()
    """Its meters."""
    parts: Items[Part] = ()
    """Its parts, assemblies among them."""

    @property
    def body_count(self) -> int:
        """Number of its bodies and those of its parts."""
        return len(self.bodies) + sum(part.body_count for part in self.parts)

    @property
    def tendon_names(self) -> dict[str, str]:
        """The tendons of its parts."""
        return {f"{self.name}.{name}": f"{self.name}.{tendon}"
                for part in self.parts for name, tendon in part.tendon_names.items()}

    def expand(self, known: Known) -> Elements:
        """All elements so far, and its own, placed and under their names outside."""
        begin, before = f"{self.name}.", known.elements

        def outside(name: str) -> Body | None:
            return before.body(name) or known.outside(name)

        pulled = frozenset(name.removeprefix(begin) for name in known.pulled
                           if name.startswith(begin))
        inner, problems = expand_parts(self, pulled, outside, known.near)
        if problems:
            raise PartError([dataclasses.replace(problem, path=problem.path.removeprefix("$"))
                             for problem in problems])
        placement = Placement(self.at, self.angle, self.mirror, self.scale)
        return before + placed(self.name, inner, placement, outside)


Part = Annotated[Finger | RockerTree | PulleyTree | Section | Assembly,
                 Field(discriminator="type")]


class Scene(Mechanism):
    """The whole file: a mechanism, and the parameters, templates and parts it is written with.

    An element names its template with ``"like"``; templates are merged into the
    elements, and ``like`` removed, before a scene is validated.
    """

    schema_: Annotated[str | None, Field(alias="$schema")] = None
    """Where an editor finds the JSON Schema of scenes."""
    parameters: dict[Name, Quantity] = Field(default_factory=dict)
    """Named numbers, for expressions such as ``"=pull / 4"``: SI once read, whatever unit they were
    written in."""
    templates: dict[Name, dict[str, Any]] = Field(default_factory=dict)
    """Templates by name: ``{"digit": {"type": "finger", ...}}``. An entry with ``"like": "digit"``
    takes all keys of that template and overrides them with its own, object by object; lists are
    replaced whole. A template may itself have a ``like``."""
    parts: Items[Part] = ()
    """Assemblies of several elements, such as fingers and trees; ``sandbox check --expand`` shows
    their elements."""


Assembly.model_rebuild()
KEYS = tuple(field.alias or name for name, field in Scene.model_fields.items())
"""The keys of a scene's file."""
ASSEMBLED = tuple(key for key in KEYS if key in Assembly.model_fields and key != "name")
"""Those that an assembly takes from a scene that it includes."""
