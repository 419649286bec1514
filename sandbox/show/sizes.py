"""Widths, sizes and shares of pictures: the script has them by these names."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from sandbox.draw.figure import strands
from sandbox.draw.figure.style import MANY_MM
from sandbox.picture import camera
from sandbox.picture.tensions import SLACK_FRACTION
from sandbox.show import drawing

SIZES: Mapping[str, Any] = {
    "EDGE": drawing.EDGE, "HAIR": drawing.HAIR,
    "PIN": drawing.PIN, "COLLAR": drawing.COLLAR, "GAUGE": drawing.GAUGE,
    "CORD": drawing.CORD, "WOUND": drawing.WOUND, "SLACK_SHARE": SLACK_FRACTION,
    "COIL": drawing.COIL, "THICK": drawing.THICK,
    "BLOCK": drawing.BLOCK, "SLIM": drawing.SLIM, "FINE": drawing.FINE,
    "LABELLED": drawing.LABELLED, "MOST_LABELS": drawing.MOST_LABELS, "MARGIN": camera.MARGIN,
    "SHORT": drawing.SHORT, "MANY_MM": MANY_MM, "RIM": drawing.RIM,
    "TIP": drawing.TIP, "HINGE": drawing.HINGE, "OF_NUMBERS": drawing.OF_NUMBERS,
    "OF_FINGERS": drawing.OF_FINGERS,
    "AS_ONE": strands.NEAR, "CROSSING": strands.SHORT, "TURN": strands.STROKE,
}
"""In points, but for shares, angles and what is in m; what each is says the file that has it."""


def declared() -> str:
    """The line of the script that names them."""
    return f"const {', '.join(f'{name} = {json.dumps(v)}' for name, v in SIZES.items())};"
