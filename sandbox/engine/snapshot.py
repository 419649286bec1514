"""Memory for samples, which compiled code fills with copies of arrays."""

from __future__ import annotations

from typing import Any

import numpy as np

from sandbox.engine import memory as at
from sandbox.engine.entry_points import entry_point
from sandbox.engine.kernel import kernel
from sandbox.engine.memory import view_name
from sandbox.engine.native import copy_words
from sandbox.engine.state import CONTACT, CONTACT_SUMS, SAMPLED, Snapshot
from sandbox.engine.tables import Tables
from sandbox.kinds.arrays import FORCES
from sandbox.numeric import Array, Records


def make_snapshot(samples: int, tables: Tables, drives: int, contacts: int) -> Snapshot:
    """Memory for so many samples of a run, and so many contacts in all of them together."""
    constants = tables.constants
    sampled = {view_name(type(part), name): getattr(part, name)
               for part in tables[1:] for name in SAMPLED[type(part)]}
    copied = {name: np.zeros((samples, *array.shape), array.dtype)
              for name, array in sampled.items()}
    copies = np.array([(array.ctypes.data, copied[name].ctypes.data, array.nbytes // 8)
                       for name, array in sampled.items()], dtype=np.int64)
    tendons = np.count_nonzero(constants.cords["whole"] < 0)
    forces = FORCES * len(constants.joints) + tendons + len(constants.slips) + drives
    return Snapshot(
        copied, copies, np.full((samples, drives), np.nan), np.zeros(contacts, CONTACT),
        np.zeros(samples, dtype=np.int64), np.zeros(4, dtype=np.int64), np.zeros(forces),
        np.zeros((samples, forces)), np.zeros(samples, dtype=np.int64), np.zeros(2),
        np.zeros(2 * contacts, CONTACT_SUMS), np.zeros(samples, dtype=np.int64),
        np.zeros(2, dtype=np.int64))


@kernel
def room_to_keep(table: int) -> bool:
    """Whether one more sample can be kept, however many contacts it has; noted if not."""
    fill, taken = at.kept_fill(table), at.kept_taken(table)
    n = taken[0] - taken[1]
    used = fill[n - 1] if n > 0 else 0
    if (n == len(fill) or used + len(at.touches(table)) > len(at.kept_contacts(table))
            or 2 * at.kept_unfinished(table)[0] > len(at.kept_mean_contacts(table))):
        taken[2] = 1
    return bool(taken[2] == 0)


@entry_point()
def take(table: int, drive: Array) -> None:
    """Copy the step just made, with its drives [nd], into the next row that samples are kept in."""
    taken = at.kept_taken(table)
    n = taken[0] - taken[1]
    copies = at.kept_copies(table)
    for i in range(len(copies)):
        words = copies[i, 2]
        copy_words(copies[i, 0], copies[i, 1] + 8 * n * words, words)
    kept_drive = at.kept_drive(table)
    for i in range(len(drive)):
        kept_drive[n, i] = drive[i]
    fill = at.kept_fill(table)
    first = fill[n - 1] if n > 0 else 0
    fill[n] = list_contacts(
        at.touches(table), at.touching(table)[0], at.body(table), at.kept_contacts(table), first)
    at.kept_steady(table)[n] = 1
    taken[0] += 1


@kernel
def list_contacts(touches: Records, count: int, body: Array, out: Records, m: int) -> int:
    """Note the points that carry something from row ``m`` of ``out`` on; where it ends."""
    for i in range(count):
        t, c = touches[i], out[m]
        normal = t["normal"] + t["bounce"]
        if normal > 0.0:
            c["a"], c["b"], c["gap"] = t["a"], t["b"], t["gap"]
            c["x"], c["y"] = body[t["a"], 0] + t["ax"], body[t["a"], 1] + t["ay"]
            c["nx"], c["ny"] = t["nx"], t["ny"]
            c["normal"], c["tangent"] = normal, t["tangent"] + t["rub"]
            c["twist"] = twist_of(body, t)
            m += 1
    return m


@kernel
def twist_of(body: Array, t: Any) -> float:
    """Moment that a contact's impulse has on body b besides that at the place on body a [N m s].

    An impact is where both surfaces will be when it happens, which is not one place at the pose.
    """
    if t["bounce"] == 0.0:
        return 0.0
    x = body[t["b"], 0] + t["bx"] - body[t["a"], 0] - t["ax"]
    y = body[t["b"], 1] + t["by"] - body[t["a"], 1] - t["ay"]
    normal, tangent = t["normal"] + t["bounce"], t["tangent"] + t["rub"]
    return float(x * (normal * t["ny"] + tangent * t["nx"])
                 - y * (normal * t["nx"] - tangent * t["ny"]))
