"""The quantities of a run: unit, recorded array, one sentence each.

Those of an element stand with its kind; here are those of bodies, groups and pairs. From here
come the catalogue, the heads of the CSV files, the reserved names and docs/scenes.md.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from sandbox.elements import drives, fluids, joints, loads, springs, tendons
from sandbox.elements.element import NAMED, RELEASABLE, Quantity, computed, live
from sandbox.elements.tendons import NUMBERED

QUANTITIES: Mapping[str, Mapping[str, Quantity]] = {
    "body": {
        "x": live("body_pose", "m", "origin of its frame in the world, x", 0),
        "y": live("body_pose", "m", "the same, upwards", 1),
        "angle": live("body_pose", "rad", "of its frame, counter-clockwise", 2),
        "vx": live("body_velocity", "m/s", "velocity of its centre of mass", 0),
        "vy": live("body_velocity", "m/s", "the same, upwards", 1),
        "omega": live("body_velocity", "rad/s", "angular velocity", 2),
        "ax": live("body_acceleration", "m/s^2", "acceleration of its centre of mass", 0),
        "ay": live("body_acceleration", "m/s^2", "the same, upwards", 1),
        "alpha": live("body_acceleration", "rad/s^2", "angular acceleration", 2),
        "contact.normal": computed("N", "sum of magnitudes of normal forces on it", live=True),
        "contact.tangential": computed("N", "the same of friction forces", live=True),
        "contact.fx": computed("N", "resultant of all contact forces on it"),
        "contact.fy": computed("N", "the same, upwards"),
    },
    "joint": joints.QUANTITIES, "spring": springs.QUANTITIES, "tendon": tendons.QUANTITIES,
    "line": fluids.LINE_QUANTITIES, "valve": fluids.VALVE_QUANTITIES, "load": loads.QUANTITIES,
    "drive": drives.QUANTITIES,
    "solver": {
        "residual": live("solver_residual", "m/s",
                         "largest rate by which a step since the last sample violates the laws of "
                         "contacts, limits, friction and motors; above 1e-8 m/s the step is "
                         "approximate"),
    },
    "group": {
        "contact.count": computed("1", "number of its bodies touched from outside", live=True,
                                  count=True),
        "contact.normal": computed("N", "sum of normal force magnitudes from outside", live=True),
    },
    "pair": {
        "normal": computed("N", "normal force between the two bodies", live=True),
        "tangential": computed("N", "friction on the first body by the second, positive along its "
                                    "normal force turned by +90°; the same of `b/a`", live=True),
    },
}
# the quantity shown first, by kind of element, the most informative kinds first
USUAL: Mapping[str, str] = {"meter": "", "tendon": "tension", "joint": "angle", "drive": "value",
                            "spring": "length", "body": "y"}
# the order in which quantities of one element are shown; others follow
TELLING = ("value", "x", "y", "contact.normal", "force", "torque", "angle", "length", "tension",
           "reaction", "pressure", "flow", "fx", "fy", "power")
# additional quantities of joints, springs and tendons that can be released
BOND_QUANTITIES: Mapping[str, Quantity] = {
    "held": live("held", "1", "of elements that can be released: 1 while engaged", yes_no=True),
}
MAX_PRESSING = 24  # contacts of an object up to which closure, epsilon, isotropy are computed
WINDOW = 0.1  # time [s] at rest in a hand after which an object is held
STRAY = 0.01  # maximum motion and sliding in that time over its size
_MANY = f"more than {MAX_PRESSING} bodies press on it"
NOT_HELD = "it is not held"
_LIMP = (f"{NOT_HELD}, or its stiffness is not defined: with fluids, teeth, loads by laws, tendons "
         "with friction, contacts in a notch")
_NO_HAND = f"no hand presses on it, or more than {MAX_PRESSING} bodies do"
# additional quantities of bodies with the role ``object``; docs/grasp.md
GRASP: Mapping[str, Quantity] = {
    "held": computed("1", "1 while a hand holds it: the hand pressed on it for the last "
                          f"{WINDOW:g} s, it moved and slid by less than {100 * STRAY:g} % of its "
                          "size, nothing else supports it; else 0", of_free=True, yes_no=True),
    "drift": computed("m", "displacement since it was first held, of its farthest point",
                      nothing=NOT_HELD, of_free=True),
    "closure": computed("1", "1 with force closure, else 0: contacts at these points could balance "
                             "any load", nothing=_MANY, yes_no=True),
    "epsilon": computed("1", "Ferrari-Canny measure: minimum load at the limit of contact forces "
                             "of sum 1; 0 without force closure", nothing=_NO_HAND),
    "stiffness": computed("N/m", "force per displacement for a small push at its centre of mass in "
                                 "the softest direction; inf if no push moves it, 0 without "
                                 "restoring force", nothing=_LIMP, of_free=True),
    "stiffness_x": computed("N/m", "the same of a push along x", nothing=_LIMP, of_free=True),
    "stiffness_y": computed("N/m", "the same of a push upwards", nothing=_LIMP, of_free=True),
    "stiffness_turn": computed("N m/rad", "the same of a couple", nothing=_LIMP, of_free=True),
    "isotropy": computed("1", "minimum over maximum singular value of the grasp map: 1 if all "
                              "directions are alike", nothing=_NO_HAND),
    "spread": computed("1", "standard deviation over mean of the normal forces of the fingers on "
                            "it: 0 if equal", nothing="no finger presses on it"),
    "spread_bodies": computed("1", "the same, of all bodies that press on it, such as phalanges",
                              nothing="no finger presses on it"),
}
# quantities that can be read during a run; the one quantity of a meter has no name
LIVE: Mapping[str, tuple[str, ...]] = {
    element: tuple(name for name, quantity in rows.items() if quantity.live)
    for element, rows in QUANTITIES.items()} | {"meter": ("",)}
METER = Quantity("", "", "", live=True)
# columns of ``contacts.csv`` and ``impacts.csv`` with their units
CONTACT_COLUMNS: Mapping[str, str] = {
    "x": "m", "y": "m", "fx": "N", "fy": "N", "normal": "N", "tangential": "N"}
IMPACT_COLUMNS: Mapping[str, str] = {"x": "m", "y": "m", "px": "N s", "py": "N s"}


def numbered(element: str, quantity: str) -> tuple[str, int] | None:
    """``tension_3`` of a tendon as ``("tension", 3)``; None for what has no number."""
    word, _, number = quantity.rpartition("_")
    fits = element == "tendon" and word in NUMBERED and number.isdecimal()
    return (word, int(number)) if fits else None


def row_of(element: str, quantity: str) -> Quantity:
    """The row of a quantity of a ``body``, ``joint``, ...; of a meter one that can be read."""
    if element == "meter":
        return METER
    if found := numbered(element, quantity):
        return NUMBERED[found[0]]
    return QUANTITIES[element].get(quantity) or (
        GRASP if element == "body" else BOND_QUANTITIES)[quantity]


def reserved(kind: str) -> frozenset[str]:
    """What may not follow an element's name and a dot: ``contact.normal`` of a body."""
    names = [*QUANTITIES.get(NAMED[kind].one, {}), *(BOND_QUANTITIES if kind in RELEASABLE else ())]
    return frozenset(".".join(name.split(".")[:count]) for name in names
                     for count in range(1, name.count(".") + 2))


def quantities_of(element: str) -> dict[str, str]:
    """All quantities of a kind such as ``body`` or ``pair``, with units."""
    return {name: quantity.unit for name, quantity in QUANTITIES[element].items()}


def by_telling(quantities: Iterable[str]) -> list[str]:
    """Quantities of an element in the order in which they are shown."""
    return sorted(quantities, key=lambda name: (*TELLING, name).index(name))
