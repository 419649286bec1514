"""The Mechanism: a scene expanded to plain elements, without parts."""

from __future__ import annotations

from typing import Annotated

from pydantic import BeforeValidator, Field

from sandbox.elements.element import LISTS, NAMED, RELEASABLE, Vec
from sandbox.elements.fluids import Line, Valve
from sandbox.elements.loads import Load
from sandbox.elements.registry import Controller, Drive, Joint
from sandbox.elements.springs import Spring
from sandbox.elements.tendons import Tendon
from sandbox.scene.bodies import Body, Material
from sandbox.scene.geometry import anchors, pose_of, to_world
from sandbox.scene.settings import ContactRule, Event, Expect, Group, Meter, Run, View
from sandbox.values.expressions import call
from sandbox.values.numbers import Acceleration, Items, Name, Pair
from sandbox.values.spec import Spec
from sandbox.values.tables import NamedTable, TableName, Tables, function_of
from sandbox.wording import counted, refuse_if

FORMAT = 1  # the version of the scene format that is read


def _readable(version: object) -> object:
    refuse_if(isinstance(version, int) and version > FORMAT, f"this scene has format {version}; "
              f"this version of sandbox reads format {FORMAT}", "unsupported-format")
    return version


class SceneHead(Spec):
    """The name, run and surroundings of a scene."""

    format: Annotated[int, BeforeValidator(_readable)] = Field(default=1, ge=1, le=FORMAT)
    """Version of the format of scenes, always 1."""
    name: str = ""
    """Name of the run's folder and files; by default the file's name without its extension."""
    title: str = ""
    """One line for the picture and for ``sandbox list``; by default the name."""
    about: str = ""
    """Description of the scene, for people only."""
    run: Run = Run()
    """Duration, time step and sample rate of the run."""
    gravity: Pair[Acceleration] = (0.0, 0.0)
    """Acceleration of gravity [x, y] in the world [m/s^2]; ``[0, -9.81]`` in a vertical plane."""
    tables: dict[TableName, NamedTable] = Field(default_factory=dict)
    """Functions of one number, given by points, for expressions: ``"=profile(hinge.angle)"``."""


class ElementLists(Spec):
    """The elements of a scene or an assembly by kind, in order."""

    materials: dict[Name, Material] = Field(default_factory=dict)
    """Contact surfaces by name, for the ``material`` of bodies."""
    bodies: Items[Body] = ()
    """The rigid bodies, fixed ones included."""
    joints: Items[Joint] = ()
    """Rigid connections of two bodies: pins, slots, welds, rods, ropes, gears, racks, rolling."""
    springs: Items[Spring] = ()
    """Springs with dampers, between two points or about a hinge."""
    tendons: Items[Tendon] = ()
    """Elastic tendons that pass guides and only pull."""
    lines: Items[Line] = ()
    """Fluid under pressure, in chambers that move bodies."""
    valves: Items[Valve] = ()
    """Flow resistances between lines of fluid."""
    loads: Items[Load] = ()
    """Forces on bodies by laws of their own motion: drag, buoyancy, fields."""
    drives: Items[Drive] = ()
    """Inputs over time: forces, torques, pulls, speeds, stiffnesses, radii, fluid flows and
    pressures, valve openings, conveyor surfaces."""
    controllers: Items[Controller] = ()
    """Controllers that read quantities during the run and set drives."""
    events: Items[Event] = ()
    """Actions that happen once, at a time or on a condition."""
    contacts: Items[ContactRule] = ()
    """Which bodies may touch, and their friction; for a pair the last rule counts."""
    groups: Items[Group] = ()
    """Named groups of bodies."""
    meters: Items[Meter] = ()
    """Quantities computed from others by expressions."""


class Mechanism(ElementLists, SceneHead):
    """All elements by kind, in order. It is itself a valid scene without parts."""

    expect: Items[Expect] = ()
    """Expectations on recorded quantities; a run that misses one fails."""
    view: View = View()
    """Content, size and speed of the picture."""

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {self.name!r}: {self.counted or 'empty'}>"

    __str__ = __repr__

    def _repr_html_(self) -> str:
        from sandbox.notebook import card_of_scene

        return card_of_scene(self)

    @property
    def counted(self) -> str:
        """Numbers of elements, such as ``4 bodies, 3 joints``; parts are not expanded."""
        words = {"contacts": "contact rule", "expect": "expectation", "parts": "part"}
        return ", ".join(counted(len(each), words.get(key) or f"{NAMED[key].one}|{key}")
                         for key in ("parts", *LISTS) if (each := getattr(self, key, ())))

    @property
    def holding(self) -> tuple[Joint | Spring | Tendon, ...]:
        """All elements that can be released."""
        return tuple(each for kind in RELEASABLE for each in getattr(self, kind))

    @property
    def releasable(self) -> tuple[str, ...]:
        """Names of those of :attr:`holding` that this run may release."""
        named = {name for event in self.events for name in (*event.release, *event.take_up)}
        named |= {drive.target[1] for drive in self.drives if drive.kind.gives == "hold"}
        return tuple(each.name for each in self.holding
                     if each.released or each.breaks_at is not None or each.name in named)

    @property
    def functions(self) -> Tables:
        """Tables by their calls in expressions."""
        return {call(name): function_of(table) for name, table in self.tables.items()}

    @property
    def loaded(self) -> tuple[tuple[int, int], ...]:
        """Numbers of each load and each body that it acts on."""
        return tuple((i, body) for i, load in enumerate(self.loads)
                     for body in load.borne(self.bodies))

    def anchors(self, joint: Joint) -> tuple[Vec, Vec]:
        """Anchors of a joint in the frames of its bodies ``a`` and ``b`` [m]."""
        bodies = {body.name: body for body in self.bodies}
        return anchors(joint, bodies[joint.a], bodies[joint.b])

    def world(self, body: str, point: Vec) -> Vec:
        """A point of a body's frame [m] in the world at t = 0."""
        return to_world(pose_of(next(each for each in self.bodies if each.name == body)), point)
