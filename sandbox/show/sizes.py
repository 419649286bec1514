"""Widths, sizes and shares of pictures: the script has them by these names."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from sandbox.draw.film import (
    bodies,
    camera,
    drives,
    forces,
    grounds,
    joints,
    leaders,
    springs,
    tendons,
)
from sandbox.draw.film.tensions import SLACK_FRACTION
from sandbox.figure import strands
from sandbox.figure.style import MANY_MM

SIZES: Mapping[str, Any] = {
    "EDGE": bodies.EDGE, "HAIR": bodies.HAIR,
    "PIN": joints.PIN, "COLLAR": joints.COLLAR, "GAUGE": grounds.GAUGE,
    "CORD": tendons.CORD, "WOUND": tendons.WOUND, "SLACK_SHARE": SLACK_FRACTION,
    "COIL": springs.LINE, "THICK": springs.THICK,
    "BLOCK": drives.BLOCK, "SLIM": drives.SLIM, "FINE": forces.FINE,
    "LABELLED": forces.LABELLED, "MOST_LABELS": forces.MOST_LABELS, "MARGIN": camera.MARGIN,
    "SHORT": joints.SHORT, "MANY_MM": MANY_MM, "RIM": leaders.RIM,
    "TIP": leaders.TIP, "HINGE": leaders.HINGE, "OF_NUMBERS": leaders.OF_NUMBERS,
    "OF_FINGERS": leaders.OF_FINGERS,
    "AS_ONE": strands.NEAR, "CROSSING": strands.SHORT, "TURN": strands.STROKE,
}
"""In points, but for shares, angles and what is in m; what each is says the file that has it."""


def declared() -> str:
    """The line of the script that names them."""
    return f"const {', '.join(f'{name} = {json.dumps(v)}' for name, v in SIZES.items())};"
