"""Drives of springs and tendons, and drives that release elements and engage them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, Self

from pydantic import model_validator

from sandbox.elements.drive import DriveKind, DriveSpec
from sandbox.elements.element import HELD, RELEASED, SPRING, TENDON, no_mesh
from sandbox.elements.tendons import RIGID, Tendon
from sandbox.errors import Problem
from sandbox.values.numbers import Name
from sandbox.values.signals import AnySignal, Constant, ForceSignal, ShareSignal, StiffnessSignal
from sandbox.values.spec import TYPE
from sandbox.wording import WrongValueError, quoted

if TYPE_CHECKING:
    from sandbox.engine.pymunk_draft import PymunkDraft
    from sandbox.export.document import Draft
    from sandbox.scene.mechanism import Mechanism


class PullDrive(DriveSpec):
    """Sets the tension of a tendon: an actuator at its last guide. Below 0 counts as 0."""

    facts: ClassVar[DriveKind] = DriveKind(
        TENDON, "tension", "N", "force", floor=0.0, sole="tension")

    type: Literal["pull"] = TYPE
    name: Name
    """Its name; its value is recorded as ``<name>.value``."""
    tendon: Annotated[Name, TENDON]
    """Name of a tendon, or of a finger or tree: then its own tendon is pulled."""
    value: ForceSignal
    """The tension over time [N]; below 0 counts as 0."""

    def write_mujoco(self, draft: Draft, index: int) -> None:
        """Add the drive to a MuJoCo model."""
        tendon = draft.model.tendons.name[draft.target(index)]
        draft.sense("actuatorfrc", f"{tendon}.tension", actuator=self.name)
        draft.motor(index, tendon=tendon, gear=-1.0, ctrlrange=(0.0, draft.MAX_FORCE))

    def write_pymunk(self, draft: PymunkDraft, index: int) -> None:
        """The tension of its tendon, set before each step."""
        draft.add("set", self.name, draft.value(index), self.tendon, "pulled", floor=0.0)


class StiffnessDrive(DriveSpec):
    """Sets the stiffness of a spring or of a tendon over time. Below 0 counts as 0."""

    facts: ClassVar[DriveKind] = DriveKind(
        SPRING, "stiffness", "", "", ("value",), floor=0.0, sole="stiffness",
        mujoco="a stiffness drive")
    on_tendon: ClassVar[DriveKind] = replace(
        facts, target=TENDON, unit="N/m", dimension="stiffness")

    type: Literal["stiffness"] = TYPE
    name: Name
    """Its name; its value is recorded as ``<name>.value``."""
    spring: Annotated[Name | None, SPRING] = None
    """Name of the spring, linear or rotary; its damping stays as it is. This or ``tendon``."""
    tendon: Annotated[Name | None, TENDON] = None
    """In place of ``spring``, the name of a tendon below 100 kN/m without pull drive and guide
    friction, or of a finger or tree for its own tendon. Damping and rest length do not change; a
    ``pretension`` sets the rest length by the tendon's own stiffness."""
    value: StiffnessSignal | None = None
    """Stiffness over time, [N/m] of a linear spring or a tendon, [N m/rad] of a rotary spring; by
    default the element's own, which a controller may change."""

    @model_validator(mode="after")
    def _one_target(self) -> Self:
        if (self.spring is None) == (self.tendon is None):
            raise WrongValueError("conflicting-keys", "a stiffness drive needs either 'spring' or "
                                  "'tendon'")
        return self

    @property
    def kind(self) -> DriveKind:
        """What it sets, by what it names."""
        return self.facts if self.tendon is None else self.on_tendon

    def _spring(self, mechanism: Mechanism) -> Any:
        """Its spring or tendon; None where no element has the name."""
        return next((each for each in (*mechanism.springs, *mechanism.tendons)
                     if each.name == (self.spring or self.tendon)), None)

    def unit(self, mechanism: Mechanism) -> str:
        """The unit of its value."""
        return self.kind.unit or str(self._spring(mechanism).facts.unit)

    def dimension(self, mechanism: Mechanism) -> str | None:
        """The dimension of its value; None where no element has the name."""
        if self.kind.dimension:
            return self.kind.dimension
        spring = self._spring(mechanism)
        return None if spring is None else str(spring.facts.dimension)

    def signal(self, mechanism: Mechanism) -> AnySignal:
        """Its value over time: by default the stiffness of its spring or tendon."""
        return (Constant(constant=self._spring(mechanism).stiffness) if self.value is None
                else self.value)

    def write_pymunk(self, draft: PymunkDraft, index: int) -> None:
        """The stiffness of its spring or tendon, set before each step."""
        draft.add("set", self.name, draft.value(index), self.spring or self.tendon, "stiffness",
                  floor=0.0)

    def problems(self, mechanism: Mechanism, path: str) -> Iterator[Problem]:
        """Springs and tendons that have no stiffness to set."""
        found = self._spring(mechanism)
        if self.tendon is not None:
            yield from self._tendon_problems(found, mechanism, f"{path}.tendon")
        elif found is not None and found.stiffness is None:
            yield Problem("not-settable",
                          f"{quoted(found.name)} follows a law and has no stiffness to set",
                          f"{path}.spring", allowed="a spring with a 'stiffness'")

    def _tendon_problems(
        self, tendon: Tendon | None, mechanism: Mechanism, path: str,
    ) -> Iterator[Problem]:
        """Tendons whose tension no stiffness sets, or not along all of them."""
        name = self.tendon or ""
        pull = next((each.name for each in mechanism.drives
                     if each.kind.gives == "tension" and each.target[1] == name), None)
        if pull is not None:
            yield Problem("not-settable",
                          f"{quoted(name)} has no stiffness to set: {quoted(pull)} pulls it, which "
                          "sets its tension", path, allowed="a tendon that no drive pulls")
        elif tendon is not None and tendon.gripping:
            yield Problem("not-settable", f"the stiffness of {quoted(name)} cannot be set: its "
                          f"guide {tendon.gripping[0]} has friction, so each span has its own "
                          "tension", path, allowed="a tendon whose guides have no 'friction'")
        elif tendon is not None and tendon.stiffness >= RIGID:
            yield Problem("not-settable", f"{quoted(name)} has no stiffness to set: with "
                          f"{tendon.stiffness:g} N/m it counts as inextensible", path,
                          allowed=f"a tendon with a 'stiffness' below {RIGID:g} N/m, which it has "
                          "until the drive sets another")


class HoldDrive(DriveSpec):
    """Releases and engages a joint, a spring or a tendon, any number of times.

    Models a clutch, a magnet, or a latch that a controller works. A broken element stays broken
    until the value has been 0.5 or less and rises again.
    """

    PYMUNK = RELEASED
    facts: ClassVar[DriveKind] = DriveKind(
        HELD, "hold", "1", "ratio", ("value",), sole="hold", mujoco=RELEASED)

    type: Literal["hold"] = TYPE
    name: Name
    """Its name; its value is recorded as ``<name>.value``, the state of the element as
    ``<element>.held``."""
    element: Annotated[Name, HELD]
    """Name of the joint, spring or tendon. A joint closes its gap in its ``takes_up_in``."""
    value: ShareSignal
    """Value over time: above 0.5 engages, otherwise releases. An event that releases or engages the
    same element overrides it until the value next crosses 0.5."""

    def problems(self, mechanism: Mechanism, path: str) -> Iterator[Problem]:
        """Wheels, which cannot be engaged again."""
        if any(joint.name == self.element and joint.facts.wheels for joint in mechanism.joints):
            yield no_mesh(self.element, f"{path}.element")
