"""What events let go and take up, and what breaks: whether there is such a thing, and may be."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from sandbox.elements.drives import HoldDrive
from sandbox.elements.fluids import Vane
from sandbox.elements.kinds import JOINTS, NAMED, RELEASABLE
from sandbox.errors import Problem
from sandbox.scene.mechanism import Mechanism
from sandbox.wording import NearMisses, listed, quoted


def check_ties(
    mechanism: Mechanism, assumed: Callable[[str], bool], none: Callable[[str], str],
) -> Iterator[Problem]:
    """Names that are none or of what cannot be let go; wheels that would have to mesh anew.

    ``assumed`` are names that count as known although they were not read, ``none`` says that
    nothing is allowed and why, unless something was not read.
    """
    near = NearMisses()
    known = dict.fromkeys(each.name for kind in RELEASABLE for each in getattr(mechanism, kind))
    others = {each.name: kind for kind in NAMED if kind not in RELEASABLE
              for each in getattr(mechanism, kind)}
    wheels = {joint.name for joint in mechanism.joints if JOINTS[joint.type].wheels}
    for i, event in enumerate(mechanism.events):
        for field in ("release", "take_up"):
            for j, name in enumerate(getattr(event, field)):
                path = f"$.events[{i}].{field}[{j}]"
                if name in others:
                    yield Problem("not-releasable", f"{quoted(name)} is a "
                                  f"{NAMED[others[name]].one}, which events cannot release", path,
                                  allowed=listed(known) or none("nothing holds anything"))
                elif name not in known and not assumed(name):
                    yield Problem("name-not-found", "there is no joint, spring or tendon named "
                                  f"{quoted(name)}", path,
                                  allowed=listed(known) or none("nothing holds anything"),
                                  hint=near(name, known))
                elif name in wheels and (field == "take_up" or event.lasts is not None):
                    yield _no_mesh(name, path if field == "take_up" else f"$.events[{i}].lasts")
    for i, drive in enumerate(mechanism.drives):
        if isinstance(drive, HoldDrive) and drive.element in wheels:
            yield _no_mesh(drive.element, f"$.drives[{i}].element")
    for i, joint in enumerate(mechanism.joints):
        if joint.released and joint.name in wheels:
            yield _no_mesh(joint.name, f"$.joints[{i}].released")
    yield from _vanes(mechanism)


def _no_mesh(name: str, path: str) -> Problem:
    return Problem("not-releasable", f"{quoted(name)} joins wheels where they meet at t = 0, so "
                   "events cannot take it up again", path, allowed="a joint that joins points")


def _vanes(mechanism: Mechanism) -> Iterator[Problem]:
    """Hinges that fluid turns: what is in a vane would go nowhere."""
    loose = set(mechanism.releasable)
    for i, line in enumerate(mechanism.lines):
        for j, chamber in enumerate(line.chambers):
            if isinstance(chamber, Vane) and chamber.joint in loose:
                yield Problem("not-releasable", f"{quoted(chamber.joint)} can be released, but "
                              "this chamber needs it", f"$.lines[{i}].chambers[{j}].joint",
                              allowed="a hinge that stays")
