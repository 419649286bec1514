"""Actuators of a MuJoCo model, and the state in which it starts."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from sandbox.export.freedoms import angle_sum
from sandbox.export.mjcf_cords import FORCE
from sandbox.export.mjcf_document import Draft
from sandbox.export.xmltext import Value, add, comment, number
from sandbox.scene.mechanism import signal_of
from sandbox.scene.values.signals import Constant, values


def add_drives(draft: Draft) -> None:
    """All drives; a note for every controller and event, which are lost."""
    for steering in (*draft.mechanism.controllers, *draft.mechanism.events):
        draft.notes.append(f"{steering.name}: MuJoCo keeps no controllers and no events; the "
                           "drives have what their own signals say")
    for i, drive in enumerate(draft.mechanism.drives):
        DRIVES[drive.type](draft, i)


def final_value(draft: Draft, drive: int) -> float:
    """A drive's value at the end of the run, in the drive's unit."""
    signal = signal_of(draft.mechanism.drives[drive], draft.mechanism)
    end = np.array([draft.mechanism.run.duration])
    return float(values(signal, end, draft.mechanism.functions)[0])


def _motor(
    draft: Draft, drive: int, what: str = "motor", gives: str = "value", **attributes: Value,
) -> None:
    """An actuator ``what`` whose control is the drive's value; a note where that varies.

    ``gives`` is the drive's quantity that it gives.
    """
    section, name = draft.sections["actuator"], draft.model.drives.name[drive]
    signal = signal_of(draft.mechanism.drives[drive], draft.mechanism)
    end = final_value(draft, drive)
    if not isinstance(signal, Constant):
        law = signal.model_dump_json(exclude_defaults=True)
        section.append(comment(f"{name} over time: {law}; {number(end)} at the end of the run"))
        draft.notes.append(f"{name}: MuJoCo keeps no signals over time; the keyframe "
                           f"holds its last value, {number(end)}")
    add(section, what, name=name, **attributes)
    draft.controls.append(max(end, float(draft.model.drives.floor[drive])))
    draft.sense("actuatorfrc", f"{name}.{gives}", actuator=name)


def _pull(draft: Draft, drive: int) -> None:
    tendon = draft.model.tendons.name[int(draft.model.drives.target[drive])]
    draft.sense("actuatorfrc", f"{tendon}.tension", actuator=draft.model.drives.name[drive])
    _motor(draft, drive, tendon=tendon, gear=-1.0, ctrlrange=(0.0, FORCE))


def _torque(draft: Draft, drive: int) -> None:
    joint = int(draft.model.drives.target[drive])
    draft.hinges[joint].driven = True
    where = "joint" if draft.carried(joint) else "tendon"
    _motor(draft, drive, **{where: draft.model.joints.name[joint]})


def _push(draft: Draft, drive: int) -> None:
    _motor(draft, drive, tendon=draft.model.joints.name[int(draft.model.drives.target[drive])])


def _servo(draft: Draft, drive: int) -> None:
    """Of a pin that closes a loop the coordinate is a sum of angles, less what that lacks."""
    joint, lacks = int(draft.model.drives.target[drive]), 0.0
    draft.hinges[joint].driven = True
    where = "joint" if draft.carried(joint) else "tendon"
    if where == "tendon":
        lacks = angle_sum(draft.model, joint, draft.tree, draft.moves).offset
    _sprung(draft, drive, where, lacks, "torque")


def _length(draft: Draft, drive: int) -> None:
    _sprung(draft, drive, "tendon", 0.0, "force")


def _sprung(draft: Draft, drive: int, where: str, lacks: float, gives: str) -> None:
    """Gives k (value - place) - c rate within a range; MuJoCo's place is less by ``lacks``."""
    drives = draft.model.drives
    k, c, most = (float(row[drive]) for row in (drives.stiffness, drives.damping, drives.most))
    name = draft.model.joints.name[int(drives.target[drive])]
    _motor(draft, drive, "general", gives, gainprm=k, biastype="affine",
           biasprm=(-k * lacks, -k, -c), forcerange=(-most, most), **{where: name})


def _force(draft: Draft, drive: int) -> None:
    drives = draft.model.drives
    x, y = drives.direction[drive].tolist()
    frame = None if drives.turning[drive] else draft.world_frame()
    at_x, at_y = drives.at[drive].tolist()
    site = draft.site(int(drives.target[drive]), f"{drives.name[drive]}.site", (at_x, at_y))
    _motor(draft, drive, gear=(x, y, 0, 0, 0, 0), site=site, refsite=frame)


def _brake(draft: Draft, drive: int) -> None:
    """No actuator: its hinge has it (``hinge_law``)."""
    draft.hinges[int(draft.model.drives.target[drive])].brake = final_value(draft, drive)


DRIVES: Mapping[str, Callable[[Draft, int], None]] = {
    "force": _force, "torque": _torque, "pull": _pull, "brake": _brake,
    "servo": _servo, "push": _push, "length": _length}
"""By kind of drive: writes one."""


def add_start(draft: Draft) -> None:
    """The keyframe ``start``: the pose and speeds at t = 0, the drives' values at the end."""
    moves = draft.coordinates()
    if not moves and not draft.controls:
        return
    add(draft.sections["keyframe"], "key", name="start",
        qpos=[move.start for move in moves] if moves else None,
        qvel=[move.rate for move in moves] if any(move.rate for move in moves) else None,
        ctrl=draft.controls or None)
