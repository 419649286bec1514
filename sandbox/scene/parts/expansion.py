"""What a part becomes: plain elements by kind, in order."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

from sandbox.elements.controllers.kinds import Controller
from sandbox.elements.drives import Drive
from sandbox.elements.fluids import Line, Valve
from sandbox.elements.joints import Joint
from sandbox.elements.loads import Load
from sandbox.elements.springs import Spring
from sandbox.elements.tendons import Guide, Tendon
from sandbox.errors import Problem
from sandbox.scene.bodies import Body, Material
from sandbox.scene.events import Event
from sandbox.scene.settings import ContactRule, Group, Meter


@dataclass(frozen=True)
class Elements:
    """Plain elements of a mechanism; two sets are added kind by kind."""

    bodies: tuple[Body, ...] = ()
    joints: tuple[Joint, ...] = ()
    springs: tuple[Spring, ...] = ()
    tendons: tuple[Tendon, ...] = ()
    lines: tuple[Line, ...] = ()
    valves: tuple[Valve, ...] = ()
    loads: tuple[Load, ...] = ()
    contacts: tuple[ContactRule, ...] = ()
    groups: tuple[Group, ...] = ()
    drives: tuple[Drive, ...] = ()
    controllers: tuple[Controller, ...] = ()
    events: tuple[Event, ...] = ()
    meters: tuple[Meter, ...] = ()
    materials: tuple[tuple[str, Material], ...] = ()

    def __add__(self, other: Elements) -> Elements:
        return Elements(**{
            kind.name: getattr(self, kind.name) + getattr(other, kind.name)
            for kind in dataclasses.fields(Elements)
        })

    def body(self, name: str) -> Body | None:
        """The body of that name."""
        return next((body for body in self.bodies if body.name == name), None)

    def tendon(self, name: str) -> Tendon | None:
        """The tendon of that name."""
        return next((tendon for tendon in self.tendons if tendon.name == name), None)

    def with_tendon_led_to(self, name: str, *guides: Guide) -> Elements:
        """The same elements with more guides at the end of tendon ``name``."""
        tendons = tuple(
            tendon.model_copy(update={"guides": (*tendon.guides, *guides)})
            if tendon.name == name else tendon
            for tendon in self.tendons
        )
        return dataclasses.replace(self, tendons=tendons)


@dataclass
class PartError(Exception):
    """What is wrong with one part; ``path`` of each problem starts at the part itself."""

    problems: list[Problem]
