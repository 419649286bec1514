"""References of a mechanism to other elements, and unique names."""

from __future__ import annotations

import fnmatch
import re
from collections.abc import Collection, Iterator, Sequence
from itertools import accumulate

from sandbox.elements import element as base
from sandbox.elements.element import NAMED, Reference
from sandbox.elements.quantities import GRASP, reserved
from sandbox.elements.registry import KINDS
from sandbox.errors import Problem
from sandbox.scene.check.control import check_control
from sandbox.scene.layers import BY_ROLE, EVERY, meant
from sandbox.scene.mechanism import Mechanism
from sandbox.values.spec import Spec
from sandbox.wording import NearMisses, is_pattern, listed, quoted


def check_references(
    mechanism: Mechanism, *, assumed: Collection[str] = (), faulty: bool = False,
) -> list[Problem]:
    """Every name that is unknown, duplicate or ambiguous.

    Names in ``assumed``, also followed by a dot and more, count as known: they belong to elements
    that could not be read. ``"*"`` matches any name. Quantities are checked when the mechanism is
    complete; of a ``faulty`` one only those that its elements exclude are reported.
    """
    names = _References(mechanism, assumed)
    found = [*names.names(), *names.elements(), *names.others(),
             *check_control(mechanism, names.is_assumed)]
    return [*found, *(names.expected() if found or faulty else ())]


class _References:
    def __init__(self, mechanism: Mechanism, assumed: Collection[str]) -> None:
        self.mechanism, self.assumed, self.near = mechanism, assumed, NearMisses()
        self.known = {kind: dict.fromkeys(each.name for each in getattr(mechanism, kind))
                      for kind in NAMED}
        self.known["materials"] = dict.fromkeys(mechanism.materials)
        self.known[base.RELEASABLES] = {
            name: None for kind in base.RELEASABLE for name in self.known[kind]}
        self.hinges = dict.fromkeys(joint.name for joint in mechanism.joints if joint.facts.angle)
        self.actuators = dict.fromkeys(joint.name for joint in mechanism.joints if joint.facts.line)

    def is_assumed(self, name: str) -> bool:
        """Whether a name is, or begins with, that of an element that could not be read."""
        return bool(self.assumed) and ("*" in self.assumed or any(
            begin in self.assumed for begin in accumulate(name.split("."), "{}.{}".format)))

    def target(self, model: type[Spec], mark: Reference, name: str, path: str) -> Iterator[Problem]:
        """An element that a field names; a pull may name the group of its tendon."""
        known, also = self.known[mark.among], list[str]()
        what = {"materials": "material", base.RELEASABLES: "joint, spring or tendon"}.get(
            mark.among) or NAMED[mark.among].one
        if mark.hinge or mark.line:
            known, what, others, one, acts = \
                (self.hinges, "pin joint", self.actuators, "an actuator", "a hinge") \
                if mark.hinge else \
                (self.actuators, "actuator", self.hinges, "a hinge", "an actuator")
            if (tag := base.tag_of(model)) and name in others:
                twin = getattr(getattr(model, "facts", None), "twin", "")
                yield Problem(
                    "name-not-found", f"{quoted(name)} is {one}, and '{tag}' acts on {acts}", path,
                    allowed=listed(known) or f"none: there is no {acts.split()[1]}",
                    hint=f"a drive of type '{twin}', which acts on {one}" if twin else "")
                return
        elif mark.among == "tendons":
            also = [group.name for group in self.mechanism.groups
                    if group.tree or group.kind == "finger"]
        if name in known or self.is_assumed(name):
            return
        kind = next((kind for kind in NAMED if name in self.known[kind]), "")
        if kind and mark.among == base.RELEASABLES:
            yield Problem("not-releasable", f"{quoted(name)} is a {NAMED[kind].one}, which cannot "
                          "be released", path, allowed=listed(known))
            return
        none = "" if self.assumed else f"none: there is no {what}"
        unread = sorted({*self.assumed} - {"*"})  # of such names the list of allowed ones has none
        hint = self.near(name, [*known, *also, *unread])
        yield Problem("name-not-found", f"there is no {what} named {quoted(name)}", path, hint=hint,
                      allowed="" if hint in map(quoted, unread) else listed(known) or none)

    def names(self) -> Iterator[Problem]:
        """Duplicate names, and names that are also another element's quantity."""
        first: dict[str, tuple[str, str]] = {}
        for kind in NAMED:
            for i, element in enumerate(getattr(self.mechanism, kind)):
                path = f"$.{kind}[{i}].name"
                other, _ = first.setdefault(element.name, (kind, path))
                if first[element.name][1] != path:
                    yield Problem("duplicate-name", f"the name {quoted(element.name)} is already "
                                  f"that of {'another' if other == kind else 'a'} "
                                  f"{NAMED[other].one}", path,
                                  allowed="a unique name for every element")
        taken = {kind: reserved(kind) for kind in NAMED}
        objects = {body.name for body in self.mechanism.bodies if body.role == "object"}
        for name, (_, path) in first.items():
            words = name.split(".")
            for count in range(1, len(words)):
                head, quantity = ".".join(words[:count]), ".".join(words[count:])
                if head in first and (quantity in taken[first[head][0]]
                                      or (head in objects and quantity in GRASP)):
                    yield Problem("duplicate-name", f"the name {quoted(name)} also means the "
                                  f"quantity {quoted(quantity)} of {quoted(head)}", path,
                                  allowed="another name")

    def elements(self) -> Iterator[Problem]:
        """References to unknown elements, and problems of each kind of element."""
        owners: dict[tuple[object, ...], str] = {}
        for kind in NAMED:
            for i, element in enumerate(getattr(self.mechanism, kind)):
                path = f"$.{kind}[{i}]"
                named = list(base.references(element, path))
                for place, reference, name in named:
                    yield from self.target(type(element), reference, name, place)
                if kind == "loads":
                    for j, pattern in enumerate(element.bodies):
                        yield from self._fitting(pattern, f"{path}.bodies[{j}]", load=True)
                if kind in KINDS:
                    yield from element.problems(self.mechanism, path)
                if kind == "drives" and element.kind.sole:
                    owned = element.owned
                    if owned in owners:
                        yield Problem(
                            "set-twice", f"the {owned[0]} of {quoted(str(owned[1]))} is set "
                            f"already, by {owners[owned]}",
                            named[0][0] if len(owned) == 2 else path, allowed="one drive for each")
                    owners.setdefault(owned, quoted(element.name))

    def others(self) -> Iterator[Problem]:
        """Unknown names in contact rules and the view, and wheels that events engage."""
        mechanism, view = self.mechanism, self.mechanism.view
        for i, rule in enumerate(mechanism.contacts):
            for j, pattern in enumerate(rule.between):
                yield from self._fitting(pattern, f"$.contacts[{i}].between[{j}]")
        wheels = {joint.name for joint in mechanism.joints if joint.facts.wheels}
        for i, event in enumerate(mechanism.events):
            for name in wheels.intersection(event.release if event.lasts is not None else ()):
                yield base.no_mesh(name, f"$.events[{i}].lasts")
            for j, name in enumerate(event.take_up):
                if name in wheels:
                    yield base.no_mesh(name, f"$.events[{i}].take_up[{j}]")
        for place, reference, name in base.references(view, "$.view"):
            yield from self.target(type(view), reference, name, place)
        groups = [group.name for group in mechanism.groups]
        for i, pattern in enumerate(view.bodies):
            if not any(fnmatch.fnmatchcase(group, pattern) for group in groups):
                yield from self._seen(pattern, f"$.view.bodies[{i}]", groups)
        for layer, patterns in view.show.items():
            for pattern in patterns if patterns != EVERY else ():
                yield from self._seen(pattern, f"$.view.show.{layer}")

    def expected(self) -> Iterator[Problem]:
        """Expectations on unknown elements, or on quantities that one element does not have."""
        words = {"solver": ["residual"]} | {name: found for kind in NAMED for found in [
            [*reserved(kind), *(GRASP if kind == "bodies" else ())]] for name in self.known[kind]}
        for i, expect in enumerate(self.mechanism.expect):
            for name in expect.quantity.split("/"):
                heads = [each for each in accumulate(name.split("."), "{}.{}".format)
                         if each in words]
                whole = [f"{head}.{word}" for head in heads for word in words[head]]
                # pairs, and quantities of guides by their number, are left out
                fits = name in whole or not whole or name[-1:].isdigit() or "/" in expect.quantity
                if not ((heads and fits) or is_pattern(name) or self.is_assumed(name)):
                    yield Problem("unknown-quantity", f"unknown quantity {quoted(expect.quantity)}",
                                  f"$.expect[{i}].{expect.key}", hint=self.near(name, whole)
                                  if whole else self.near(name.split(".")[0], words))

    def _seen(self, pattern: str, path: str, groups: Sequence[str] = ()) -> Iterator[Problem]:
        if not pattern.startswith(BY_ROLE):
            yield from self._fitting(pattern, path, groups)
        elif not self.assumed and not meant([pattern], self.mechanism.bodies):
            roles = dict.fromkeys(BY_ROLE + body.role for body in self.mechanism.bodies)
            yield Problem("name-not-found",
                          f"no body has the role {quoted(pattern.removeprefix(BY_ROLE))}", path,
                          allowed=listed(roles), hint=self.near(pattern, roles))

    def _fitting(self, pattern: str, path: str, groups: Sequence[str] = (), *,
                 load: bool = False) -> Iterator[Problem]:
        """A pattern of bodies, or ``groups``, that fits none; of a load, none that moves freely."""
        if self.is_assumed(pattern) or (self.assumed and "*" in pattern):
            return  # a body that could not be read may fit
        fits = re.compile(fnmatch.translate(pattern) if is_pattern(pattern) else "(?!)").match
        found = [body for body in self.mechanism.bodies if body.name == pattern or fits(body.name)]
        free = [body.name for body in self.mechanism.bodies if body.motion == "dynamic"]
        if not found:
            grouped = any(group.name == pattern for group in self.mechanism.groups)
            names = [*groups, *self.known["bodies"]]
            hint = "'*', every body that moves freely" if load and pattern == "all" else (
                f"'{pattern}.*'" if grouped else self.near(pattern, names))
            yield Problem("name-not-found", f"no body's name matches {quoted(pattern)}", path,
                          allowed=listed(free if load else names), hint=hint)
        elif load and all(body.motion != "dynamic" for body in found):
            yield Problem("name-not-found", f"{quoted(pattern)} matches no body that moves freely",
                          path, allowed=listed(free) or "none: no body moves freely")
