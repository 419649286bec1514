"""Joints with dry friction as flat tables for the compiled step."""

from __future__ import annotations

import numpy as np

from sandbox.engine.records import RUB, RUB_STATE
from sandbox.model.model import Model
from sandbox.model.starts import sliding, turning
from sandbox.numeric import Records


def rub_table(joints: Records, model: Model, first: int) -> tuple[Records, list[tuple[int, int]]]:
    """RUB of all joints that rub and hold a free body; the rows that some of them hang on.

    Args:
        joints: JOINT, with the numbers of their rows.
        model: the mechanism.
        first: the number of the first sum of rows.
    """
    held = [j for j in model.joints.rubbed.tolist() if joints[j]["row"] >= 0]
    table = np.zeros(len(held), RUB)
    sums: list[tuple[int, int]] = []
    for rub, j in zip(table, held, strict=True):
        rub["joint"], rub["sum"] = j, -1
        rub["most"], rub["share"] = model.joints.friction[j], model.joints.rubbing[j]
        rub["static"] = model.joints.static[j]
        if rub["share"] > 0:
            rub["sum"] = first + len(sums)
            one, two = int(joints[j]["row"]), int(joints[j]["row_y"])
            sums.append((one, two if two >= 0 else one))
    return table, sums


def rub_state(rubs: Records, model: Model) -> Records:
    """What they begin with: joints that move at t = 0 slip, those at rest hold."""
    state = np.zeros(len(rubs), RUB_STATE)
    state["ux"], state["bound"] = 1.0, np.nan
    for own, j in zip(state, rubs["joint"].tolist(), strict=True):
        slides = model.joints.kind[j].keeps == "groove"
        own["mode"] = -np.sign(sliding(model, j) if slides else turning(model, j))
    return state
