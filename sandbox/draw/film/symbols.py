"""What marks mean: the lines of a legend, each with its words, one list for films and pages.

What draws a symbol stands by its name in :mod:`sandbox.draw.film.legend`, for a browser in
``show/web/legend.js``.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from typing import NamedTuple

import numpy as np

from sandbox.draw.film.bodies import styles
from sandbox.draw.film.drives import signs_of
from sandbox.draw.film.filmed import Filmed
from sandbox.draw.film.links import has_ropes
from sandbox.draw.film.palette import Style
from sandbox.elements.arrays import largest_size
from sandbox.model.model import NONE, Model
from sandbox.samples.contacts import OBJECT


class Symbol(NamedTuple):
    """One line of a legend."""

    layer: str
    """With which it goes."""
    width: float
    """Of the symbol [points]."""
    words: str
    """After it; ``{}`` stands for a number with its unit."""
    before: str = ""


SYMBOLS: Mapping[str, Symbol] = {
    "cut": Symbol("contacts", 34, "larger, cut short"),
    "patch": Symbol("pressure", 22, "force per length"),
    "bars": Symbol("bars", 96, "{} pull", "bars push {}"),
    "both": Symbol("tensions", 96, "{} pulls", "pushes {}"),
    "pull": Symbol("tensions", 64, "{}", "tension 0"),
    "pressure": Symbol("tendons", 64, "{}", "pressure 0"),
    "vane": Symbol("tendons", 16, "turned by pressure"),
    "rope": Symbol("joints", 30, "rope"),
    "slack": Symbol("tendons", 26, "slack"),
    "spring": Symbol("springs", 36, "spring"),
    "stiffer": Symbol("drives", 36, "made stiffer"),
    "braked": Symbol("drives", 12, "brake holds"),
    "unbraked": Symbol("drives", 12, "free"),
    "motor": Symbol("drives", 20, "way a motor turns"),
    "belt": Symbol("drives", 16, "surface runs"),
    "servo": Symbol("drives", 30, "servo"),
    "wider": Symbol("drives", 22, "wider: made stiffer"),
    "rubs": Symbol("drives", 14, "friction holds"),
    "slides": Symbol("drives", 14, "slips"),
    "scaled": Symbol("drives", 30, "driving force"),
    "driven": Symbol("drives", 30, "driving force, not to scale"),
    "torque": Symbol("drives", 22, "driving torque"),
    "holds": Symbol("joints", 18, "may let go"),
    "gone": Symbol("joints", 18, "let go"),
    "open": Symbol("tendons", 15, "valve open"),
    "shut": Symbol("tendons", 15, "shut"),
    "stop": Symbol("joints", 16, "joint stop"),
    "trace": Symbol("traces", 30, "trace, marked every {}"),
    "fixed": Symbol("bodies", 22, "fixed"),
}
"""By name, most important first; before them stand the scales of lengths and arrows."""


def signs_in(run: Filmed) -> set[str]:
    """The symbols of what is in a run, but those that hang on what is shown of it.

    Left out are the scales of tensions and pressures, what is cut short, arrows of drives, cords
    that hang, traces, and fixed bodies.
    """
    model = run.model
    there = {"rope": has_ropes(model), "spring": _springs_seen(model),
             "vane": bool((model.lines.joint != NONE).any()), "holds": bool(model.ties.name),
             "gone": bool(model.ties.name), "open": len(model.valves.lines) > 0,
             "shut": len(model.valves.lines) > 0,
             "stop": largest_size(run.arrays["joint_stop"]) > 0}
    return {name for name, found in there.items() if found} | signs_of(model)


def _springs_seen(model: Model) -> bool:
    """Whether there is a spring that no vane on its hinge covers."""
    springs = model.springs
    covered = ~springs.straight & np.isin(springs.joint, model.lines.joint)
    return bool((~covered).any())


def fixed_style(run: Filmed, bodies: Iterable[int]) -> Style | None:
    """That of most of the fixed ones among some bodies; None where none of them is seen.

    What is held counts only if nothing else is fixed.
    """
    looks, all_of = styles(run.model), run.mechanism.bodies
    seen = [i for i in bodies if all_of[i].motion == "fixed" and all_of[i].shapes]
    found = Counter(looks[i] for i in seen if all_of[i].role != OBJECT) or Counter(
        looks[i] for i in seen)
    return found.most_common(1)[0][0] if found else None
