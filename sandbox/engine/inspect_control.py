"""Checks of controllers and events: their readings, and algebraic loops."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from sandbox.elements.controllers.custom import Custom
from sandbox.elements.quantities import LIVE, row_of
from sandbox.errors import Problem, SceneError
from sandbox.model.catalogue import Catalogue
from sandbox.model.meters import misread, order
from sandbox.scene.check.control import rate_problems
from sandbox.scene.check.ranges import nothing_to_run
from sandbox.scene.document import Scene
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.read.load import read_scene, sound
from sandbox.values.expressions import dotted, names_in, parse_expression, rings
from sandbox.wording import MAX_NAMED, NearMisses, listed, quoted


def control_problems(mechanism: Mechanism) -> list[Problem]:
    """Readings that a run does not have or cannot give while it runs, and algebraic loops."""
    known = LiveCatalogue(mechanism)
    problems: list[Problem] = []
    for i, controller in enumerate(mechanism.controllers):
        several = isinstance(getattr(controller, "reads", ""), tuple)
        for j, text in enumerate(controller.readings):
            place = f"$.controllers[{i}].{controller.reads_key}" + (f"[{j}]" if several else "")
            problems += unreadable(text, known, place)
    for i, event in enumerate(mechanism.events):
        if event.when is not None:
            problems += unreadable(event.when, known, f"$.events[{i}].when")
    if not problems:
        problems += _circles(mechanism, known)
        for i, controller in enumerate(mechanism.controllers):
            problems += controller.law_problems(mechanism, f"$.controllers[{i}]")
    return problems


@dataclass(frozen=True)
class Checked:
    """A mechanism that was read and inspected, and is not checked again."""

    mechanism: Mechanism


Runnable = Scene | Mechanism | Checked | str | os.PathLike[str] | Mapping[str, Any]


def checked(scene: Runnable, customs: Sequence[Custom]) -> Mechanism:
    """The mechanism of a scene; SceneError with every problem of its control."""
    problems: list[Problem] = []
    name = ""
    if isinstance(scene, Checked):
        mechanism = scene.mechanism
    elif isinstance(scene, (str, os.PathLike, Mapping)):
        loaded = read_scene(scene)
        mechanism, name = loaded.mechanism, loaded.name
        problems += loaded.placed(control_problems(mechanism))
    else:
        mechanism = sound(scene)
        problems += control_problems(mechanism)
    problems += [*nothing_to_run(mechanism), *_custom_problems(mechanism, customs)]
    if problems:
        raise SceneError(problems, name)
    return mechanism


def _custom_problems(mechanism: Mechanism, customs: Sequence[Custom]) -> Iterator[Problem]:
    known, near = LiveCatalogue(mechanism), NearMisses()
    drives = dict.fromkeys(drive.name for drive in mechanism.drives)
    taken = {name for controller in mechanism.controllers for name in controller.written}
    taken |= {name for event in mechanism.events for name in event.set}
    named = {controller.name for controller in mechanism.controllers}
    for custom in customs:
        place = f"controller {custom.name}"
        if custom.name in named:
            yield Problem("duplicate-name",
                          "another controller has this name", place, allowed="a unique name")
        named.add(custom.name)
        yield from rate_problems(custom.rate, mechanism.run.step, place)
        for text in custom.reads:
            yield from unreadable(text, known, place)
        for name in custom.writes:
            if name not in drives:
                yield Problem("name-not-found", f"there is no drive named {quoted(name)} to write",
                              place, allowed=listed(drives), hint=near(name, drives))
            elif name in taken:
                yield Problem("set-twice", f"the drive {quoted(name)} is written already, by "
                              "another controller or an event", place)
            taken.add(name)


class LiveCatalogue(Catalogue):
    """All quantities, and what readings come from."""

    def late(self, names: Iterable[str]) -> list[str]:
        """Those of the names that cannot be read during a run; of meters the first in them."""
        found: set[str] = set()
        for name in names:
            if name not in self:
                continue
            source = self.find(name)
            if source.kind == "meter":
                found.update(self._late_of_meters.get(source.index, ()))
            elif not row_of(source.kind, source.quantity).live:
                found.add(name)
        return sorted(found)

    @cached_property
    def _late_of_meters(self) -> dict[int, tuple[str, ...]]:
        """By meter: meters that do not depend on themselves, after those that they read."""
        self._late_of_meters = found = {}
        for index in order(self.mechanism)[0]:
            found[index] = tuple(self.late(
                names_in(self.mechanism.meters[index].value) - {"t"})[:MAX_NAMED])
        return found


def _names(text: str, known: Catalogue) -> list[str]:
    """The quantities that a reading is made of; a bare pair name is one."""
    if not text.startswith("=") and text in known:
        return [text]
    return sorted(names_in(text) - {"t"})


def unreadable(text: str, known: LiveCatalogue, path: str) -> Iterator[Problem]:
    """Problems of a quantity or an expression that is to be read during a run."""
    if not text.startswith("=") and "/" not in text and dotted(parse_expression(text).tree) is None:
        yield Problem("bad-quantity",
                      f"{quoted(text)} is an expression", path, allowed=quoted(f"={text}"))
    names = _names(text, known)
    if text not in known:
        yield from misread(known, text, names, path, live=True,
                           itself="{} without '=' and all else is read as the pair")
    for name in known.late(names):
        kind = known.find(name).kind
        yield Problem("quantity-not-live", f"{quoted(name)} is computed after the run and cannot "
                      "be read during it", path, allowed=f"of a {kind}: {listed(LIVE[kind])}")


def _circles(mechanism: Mechanism, known: Catalogue) -> Iterator[Problem]:
    """Loops of laws without memory that read each other's outputs."""
    controllers = mechanism.controllers
    laws = [("law", i) for i, law in enumerate(controllers) if law.immediate]
    writer = {f"{name}.value": law for law in laws for name in controllers[law[1]].written}

    def nexts(node: tuple[str, int]) -> Iterator[tuple[str, int]]:
        """What a law or a meter reads: the laws that write it, and meters."""
        kind, index = node
        for name in (_names(controllers[index].immediate, known) if kind == "law"
                     else sorted(names_in(mechanism.meters[index].value))):
            if name in writer:
                yield writer[name]
            elif name in known and (source := known.find(name)).kind == "meter":
                yield "meter", source.index

    meters = [("meter", i) for i in range(len(mechanism.meters) if laws else 0)]
    for ring in rings({node: [*nexts(node)] for node in (*laws, *meters)}):
        members = [index for kind, index in ring if kind == "law"]
        if not members:
            continue  # meters alone are reported elsewhere
        members = members[(at := members.index(min(members))):] + members[:at]
        path = " → ".join(quoted(controllers[i].name) for i in [*members, members[0]])
        yield Problem("algebraic-loop", f"an algebraic loop: {path}; each reads the value that the "
                      "next one writes", f"$.controllers[{members[0]}].value",
                      allowed="a law with memory in the loop, such as a pid")
