"""The Mechanism: a scene spelled out as plain elements. Nothing downstream knows a finger."""

from __future__ import annotations

from pydantic import Field

from sandbox.scene.elements.bodies import Body, Material
from sandbox.scene.elements.controllers import Controller
from sandbox.scene.elements.drives import Drive, StiffnessDrive
from sandbox.scene.elements.events import Event
from sandbox.scene.elements.joints import Joint
from sandbox.scene.elements.settings import ContactRule, Expect, Group, Meter, Run, View
from sandbox.scene.elements.spec import Spec
from sandbox.scene.elements.springs import Spring
from sandbox.scene.elements.tendons import Tendon
from sandbox.scene.values.numbers import Acceleration, Name
from sandbox.scene.values.signals import AnySignal, Constant


class Mechanism(Spec):
    """All elements by kind, in order. It is itself a valid scene without parts."""

    format: int = Field(1, ge=1, le=1)
    name: str = ""
    """By default the file's name without its ending."""
    title: str = ""
    about: str = ""
    run: Run = Run()
    gravity: tuple[Acceleration, Acceleration] = (0.0, 0.0)
    """[m/s^2]; none by default: the plane lies flat."""
    materials: dict[Name, Material] = Field(default_factory=dict)
    bodies: tuple[Body, ...] = ()
    joints: tuple[Joint, ...] = ()
    springs: tuple[Spring, ...] = ()
    tendons: tuple[Tendon, ...] = ()
    drives: tuple[Drive, ...] = ()
    controllers: tuple[Controller, ...] = ()
    events: tuple[Event, ...] = ()
    contacts: tuple[ContactRule, ...] = ()
    groups: tuple[Group, ...] = ()
    meters: tuple[Meter, ...] = ()
    expect: tuple[Expect, ...] = ()
    view: View = View()


def signal_of(drive: Drive, mechanism: Mechanism) -> AnySignal:
    """The signal of a drive; that of a stiffness which says nothing is what the spring has."""
    if isinstance(drive, StiffnessDrive) and drive.value is None:
        spring = next(s for s in mechanism.springs if s.name == drive.spring)
        return Constant(constant=spring.stiffness)
    assert drive.value is not None  # only that of a stiffness may be left out
    return drive.value
