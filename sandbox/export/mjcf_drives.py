"""Actuators of a MuJoCo model, and the state in which it starts."""

from __future__ import annotations

import math

import numpy as np

from sandbox.export.mjcf_cords import FORCE
from sandbox.export.mjcf_document import Draft
from sandbox.export.xmltext import add, comment, number
from sandbox.scene.elements.drives import BrakeDrive, ForceDrive, PullDrive, TorqueDrive
from sandbox.scene.elements.joints import Pin
from sandbox.scene.values.signals import AnySignal, Constant, values


def final_value(signal: AnySignal, time: float) -> float:
    """A drive's value at the end of the run [N, N m]."""
    return float(values(signal, np.array([time]))[0])


def add_drives(draft: Draft) -> list[float]:
    """A motor for each drive; the values at the end of the run, of all actuators in order.

    Brakes are no actuators: their hinges have them (``hinge_law``).
    """
    section = draft.sections["actuator"]
    controls = [0.0] * len(section)  # so far: elastic tendons, actuators without input
    frame = ""
    for steering in (*draft.mechanism.controllers, *draft.mechanism.events):
        draft.notes.append(f"{steering.name}: MuJoCo keeps no controllers and no events; the "
                           "drives have what their own signals say")
    for drive in draft.mechanism.drives:
        if isinstance(drive, BrakeDrive):
            continue
        if not isinstance(drive, PullDrive | TorqueDrive | ForceDrive):
            raise AssertionError("refused before")
        end = final_value(drive.value, draft.mechanism.run.duration)
        if not isinstance(drive.value, Constant):
            law = drive.value.model_dump_json(exclude_defaults=True)
            section.append(comment(
                f"{drive.name} over time: {law}; {number(end)} at the end of the run"))
            draft.notes.append(f"{drive.name}: MuJoCo keeps no signals over time; the keyframe "
                               f"holds its last value, {number(end)}")
        match drive:
            case PullDrive():
                add(section, "motor", name=drive.name, tendon=drive.tendon, gear=-1.0,
                    ctrlrange=(0.0, FORCE))
                draft.sense("actuatorfrc", f"{drive.tendon}.tension", actuator=drive.name)
                end = max(end, 0.0)
            case TorqueDrive():
                _add_torque(draft, drive)
            case ForceDrive():
                if drive.frame == "world" and not frame:
                    frame = draft.site("", "frame")
                _add_force(draft, drive, frame)
        controls.append(end)
        draft.sense("actuatorfrc", f"{drive.name}.value", actuator=drive.name)
    return controls


def _add_torque(draft: Draft, drive: TorqueDrive) -> None:
    pin = next(j for j in draft.mechanism.joints if j.name == drive.joint)
    assert isinstance(pin, Pin)  # references are checked when a scene is read
    section = draft.sections["actuator"]
    on_tendon = not draft.carried(pin)
    add(section, "motor", name=drive.name, joint=None if on_tendon else pin.name,
        tendon=pin.name if on_tendon else None)


def _add_force(draft: Draft, drive: ForceDrive, frame: str) -> None:
    size = math.hypot(*drive.direction)
    x, y = drive.direction[0] / size, drive.direction[1] / size
    add(draft.sections["actuator"], "motor", name=drive.name, gear=(x, y, 0, 0, 0, 0),
        site=draft.site(drive.body, f"{drive.name}.site", drive.at),
        refsite=frame if drive.frame == "world" else None)


def add_start(draft: Draft, controls: list[float]) -> None:
    """The keyframe ``start``: the pose and speeds at t = 0, the drives' values at the end."""
    moves = draft.coordinates()
    if not moves and not controls:
        return
    add(draft.sections["keyframe"], "key", name="start",
        qpos=[move.start for move in moves] if moves else None,
        qvel=[move.rate for move in moves] if any(move.rate for move in moves) else None,
        ctrl=controls or None)
