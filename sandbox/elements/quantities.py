"""The quantities that a run can be asked for, one row each: unit, where it is kept, one sentence.

Which of them an element has, its kind says (:mod:`sandbox.elements.kinds`); bodies,
tendons, groups and pairs have all of theirs. From here come the catalogue, the
heads of the CSV files, the names that no element may have, and docs/scenes.md.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from sandbox.elements.kinds import DRIVES, JOINTS, NAMED, ON_TENDON, RELEASABLE, SPRINGS


@dataclass(frozen=True)
class Quantity:
    """A number that an element has in every sample."""

    unit: str
    """Empty where the element's kind says it."""
    about: str
    array: str = ""
    """Where it is kept; empty for what is worked out from others."""
    component: int | None = None
    """Which of the array's last axis, where that has several."""
    live: bool = False
    """Whether it can be read while a run goes on; the rest is worked out afterwards."""
    nothing: str = ""
    """When it has no value, if that can be."""
    of_free: bool = False
    """Whether only what moves freely has it."""
    yes_no: bool = False
    """Whether it is 1 or 0 and nothing between."""
    count: bool = False
    """Whether it is a whole number of things."""


def _kept(
    array: str, unit: str, about: str, *, live: bool = False, yes_no: bool = False,
) -> Quantity:
    return Quantity(unit, about, array, None, live, yes_no=yes_no)


def _part(array: str, component: int, unit: str, about: str, *, live: bool = False) -> Quantity:
    return Quantity(unit, about, array, component, live)


QUANTITIES: Mapping[str, Mapping[str, Quantity]] = {
    "body": {
        "x": _part("body_pose", 0, "m", "where its frame's origin is in the world", live=True),
        "y": _part("body_pose", 1, "m", "the same, upwards", live=True),
        "angle": _part("body_pose", 2, "rad", "of its frame, counter-clockwise", live=True),
        "vx": _part("body_velocity", 0, "m/s", "velocity of its centre of mass", live=True),
        "vy": _part("body_velocity", 1, "m/s", "the same, upwards", live=True),
        "omega": _part("body_velocity", 2, "rad/s", "angular velocity", live=True),
        "ax": _part("body_acceleration", 0, "m/s^2", "acceleration of its centre of mass",
                    live=True),
        "ay": _part("body_acceleration", 1, "m/s^2", "the same, upwards", live=True),
        "alpha": _part("body_acceleration", 2, "rad/s^2", "angular acceleration", live=True),
        "contact.normal": Quantity(
            "N", "sum of the sizes of the normal forces of all that touches it", live=True),
        "contact.tangential": Quantity(
            "N", "sum of the sizes of the friction forces of all that touches it", live=True),
        "contact.fx": Quantity("N", "resultant of all contact forces on it"),
        "contact.fy": Quantity("N", "the same, upwards"),
    },
    "joint": {
        "angle": _kept("joint_angle", "rad", "of `b` against `a`, in the hinge's positive sense",
                       live=True),
        "rate": _kept("joint_rate", "rad/s", "of the angle", live=True),
        "length": _kept("joint_length", "m", "of an actuator, between its two points", live=True),
        "speed": _kept("joint_speed", "m/s", "at which an actuator grows longer", live=True),
        "reaction": _kept("joint_reaction", "N",
                          "size of the force that it carries", live=True),
        "reaction_x": _part("joint_force", 0, "N",
                            "force on its body `b` by its body `a`, in the world", live=True),
        "reaction_y": _part("joint_force", 1, "N", "the same, upwards", live=True),
        "tension": Quantity(
            "N", "of rods and ropes: the reaction with its sign, positive where it pulls its two "
            "points together, negative where it pushes", live=True),
        "tangential": Quantity(
            "N", "of wheels: force on `b` along their circles where they meet, positive as `a` "
            "pushes by turning counter-clockwise"),
        "radial": Quantity(
            "N", "of wheels: force across that, positive where it presses the two apart"),
        "gap": Quantity(
            "m", "of teeth with play: way along the pitch circles until they meet, on the nearer "
            "side"),
        "damping": _kept("joint_damping", "N m", "torque of all its dampers, in the hinge's sense"),
        "damping_work": _kept("joint_damping_work", "J", "done by all its dampers since t = 0"),
        "stop": _kept("joint_stop", "N m", "torque of its hard stop, in the hinge's sense"),
        "friction": _kept("joint_friction", "", "dry friction: of a pin the torque on `b`, in the "
                          "hinge's sense; of a slot the force on `b`, positive towards the "
                          "groove's `end`", live=True),
        "friction_work": _kept("joint_friction_work", "J", "done by dry friction since t = 0: what "
                               "became heat, as a number below 0"),
        "sticks": _kept("joint_sticks", "1", "1 while dry friction keeps it from moving, 0 while "
                        "it slips", live=True, yes_no=True),
    },
    "spring": {
        "length": _kept("spring_length", "m", "between its two points", live=True),
        "force": _kept("spring_force", "N", "positive when it pulls; damper included", live=True),
        "angle": _kept("spring_length", "rad", "of its hinge, in the hinge's positive sense",
                       live=True),
        "torque": _kept("spring_force", "N m",
                        "positive against a positive angle; damper included"),
        "work": _kept("spring_work", "J", "done on the bodies since t = 0"),
    },
    "tendon": {
        "length": _kept("tendon_length", "m",
                        "along its path; what wheels at its ends have wound up since t = 0 counts",
                        live=True),
        "shortening": Quantity(
            "m", "its path at t = 0 less that of now, from where it leaves the wheels at its ends: "
            "positive where it is wound up", live=True),
        "tension": _kept("tendon_tension", "N", "along the whole path, never below 0; where guides "
                         "hold it by friction, that of its last straight piece", live=True),
        "work": _kept("tendon_work", "J", "done on the bodies since t = 0"),
    },
    "line": {
        "pressure": _kept("line_pressure", "Pa", "above the surroundings", live=True),
        "volume": _kept("line_volume", "m^3", "of its chambers and hoses", live=True),
        "flow": _kept("line_flow", "m^3/s", "into it, through valves and by drives; of a gas as it "
                      "would be at the pressure of the surroundings", live=True),
        "spilled": _kept("line_spilled", "m^3", "let out by its relief since t = 0"),
        "work": _kept("line_work", "J", "done on the bodies since t = 0"),
    },
    "valve": {
        "flow": _kept("valve_flow", "m^3/s", "from its `a` to its `b`", live=True),
        "loss": _kept("valve_loss", "J", "throttled since t = 0"),
    },
    "load": {
        "fx": _part("load_force", 0, "N", "force on the body, in the world", live=True),
        "fy": _part("load_force", 1, "N", "the same, upwards", live=True),
        "torque": _kept("load_torque", "N m", "about the body's centre of mass", live=True),
        "work": _kept("load_work", "J", "done on the body since t = 0"),
    },
    "drive": {
        "value": _kept("drive_value", "", "the value in force", live=True),
        "work": _kept("drive_work", "J", "done on the bodies, or on the fluid, since t = 0"),
        "flow": _kept("drive_flow", "m^3/s", "what it gave its line", live=True),
        "torque": _kept("drive_torque", "N m", "what it gave its hinge, in the hinge's sense",
                        live=True),
        "force": _kept("drive_torque", "N", "what it gave its actuator; positive pushes apart",
                       live=True),
        "power": Quantity("W", "what it gives times the rate of its hinge or actuator, positive "
                          "where it works on the bodies; of a surface that runs friction on what "
                          "touches it, times its speed"),
    },
    "group": {
        "contact.count": Quantity("1", "how many of its bodies are touched from outside",
                                  live=True, count=True),
        "contact.normal": Quantity("N", "sum of the sizes of all normal forces on it from outside",
                                   live=True),
    },
    "pair": {
        "normal": Quantity("N", "normal force between the two", live=True),
        "tangential": Quantity(
            "N", "friction force on the first by the second, positive in the direction of the "
            "normal force on the first turned by +90°; with `b/a` the same number", live=True),
    },
}
"""By what an element is called (:class:`sandbox.elements.kinds.Named`), then by name."""
USUAL: Mapping[str, str] = {"meter": "", "tendon": "tension", "joint": "angle", "drive": "value",
                            "spring": "length", "body": "y"}
"""What is looked at first of a run, by kind of element, the kinds that tell most first."""
TELLING = ("value", "x", "y", "contact.normal", "force", "torque", "angle", "length", "tension",
           "reaction", "pressure", "flow", "fx", "fy", "power")
"""What is looked at first of one element, in this order; then comes all else that it has."""
TIED: Mapping[str, Quantity] = {
    "held": _kept("held", "1", "of what may be let go: 1 while it holds, 0 while it is let go",
                  live=True, yes_no=True),
}
"""What a joint, a spring or a tendon has besides if an event or its load may let it go."""
MOST_PRESSING = 24
"""Contacts of an object beyond which closure, epsilon and isotropy are not worked out."""
WINDOW = 0.1
"""So long [s] an object has to be at rest in a hand to be held."""
STRAY = 0.01
"""By less than so much of its size it moves and slides meanwhile."""
_MANY = f"more than {MOST_PRESSING} bodies press on it"
NOT_HELD = "it is not held"
_LIMP = (f"{NOT_HELD}, or stiffness can't be told: with fluids, teeth, loads by laws, cords "
         "that rub, contacts in a notch")
_NO_HAND = f"no hand presses on it, or more than {MOST_PRESSING} bodies do"
GRASP: Mapping[str, Quantity] = {
    "held": Quantity("1", "1 while a hand holds it: something of the hand pressed on it for the "
                     f"last {WINDOW:g} s, it moved and slid by less than {100 * STRAY:g} % of its "
                     "size, nothing else carries it; else 0", of_free=True, yes_no=True),
    "drift": Quantity("m", "how far it has come since it began to be held, at its farthest point",
                      nothing=NOT_HELD, of_free=True),
    "closure": Quantity("1", "1 with force closure, else 0: whether contacts where these are could "
                        "balance any load",
                        nothing=_MANY, yes_no=True),
    "epsilon": Quantity("1", "Ferrari and Canny's measure: the least load that forces of sum 1 can "
                        "balance at most; 0 without force closure",
                        nothing=_NO_HAND),
    "stiffness": Quantity("N/m", "force over way of a small push at its centre of mass in the "
                          "direction in which it gives way most; inf where no push moves it, 0 "
                          "where nothing brings it back", nothing=_LIMP, of_free=True),
    "stiffness_x": Quantity("N/m", "of a small push along x: force over way along x",
                            nothing=_LIMP, of_free=True),
    "stiffness_y": Quantity("N/m", "the same of a push upwards", nothing=_LIMP, of_free=True),
    "stiffness_turn": Quantity("N m/rad", "of a small couple: moment over turn", nothing=_LIMP,
                               of_free=True),
    "isotropy": Quantity("1", "least over largest singular value of the grasp map: 1 if contacts "
                         "act alike in all directions", nothing=_NO_HAND),
    "spread": Quantity("1", "standard deviation over mean of the normal forces of the fingers that "
                       "press on it: 0 if they press alike", nothing="no finger presses on it"),
    "spread_bodies": Quantity("1", "the same of the bodies that press on it, such as phalanges",
                              nothing="no finger presses on it"),
}
"""What a body with the role ``object`` has besides; docs/grasp.md."""
NUMBERED: Mapping[str, Quantity] = {
    "tension": Quantity("N", "`tension_0` and so on: of its straight pieces one by one, in order",
                        live=True),
    "slip": Quantity("m", "`slip_1` and so on: cord that has slid over such a guide since t = 0, "
                     "towards the last one; guides are counted from 0", live=True),
    "lifted": Quantity("1", "`lifted_1` and so on: 1 while the cord is off that guide's wheel and "
                       "goes straight past it, else 0; guides are counted from 0", live=True,
                       yes_no=True),
}
"""What tendons have besides, with a number each: where guides hold them by friction the tensions of
their pieces and what slid over such a guide; ``lifted`` of each wheel that one can lift off."""
LIVE: Mapping[str, tuple[str, ...]] = {
    element: tuple(name for name, quantity in rows.items() if quantity.live)
    for element, rows in QUANTITIES.items()} | {"meter": ("",)}
"""What can be read while a run goes on; the one quantity of a meter has no name."""
CONTACT_COLUMNS: Mapping[str, str] = {
    "x": "m", "y": "m", "fx": "N", "fy": "N", "normal": "N", "tangential": "N"}
"""The numbers of a contact's row in ``contacts.csv`` and their units."""
IMPACT_COLUMNS: Mapping[str, str] = {"x": "m", "y": "m", "px": "N s", "py": "N s"}
"""The numbers of a row in ``impacts.csv`` and their units."""


def numbered(element: str, quantity: str) -> tuple[str, int] | None:
    """``tension_3`` of a tendon as ``("tension", 3)``; None for what has no number."""
    word, _, number = quantity.rpartition("_")
    return (word, int(number)) if element == "tendon" and word in NUMBERED and (
        number.isdecimal()) else None


def about(element: str, quantity: str) -> str:
    """The sentence on a quantity of a ``body``, ``joint``, ..., without its last number."""
    if found := numbered(element, quantity):
        return NUMBERED[found[0]].about
    rows = QUANTITIES.get(element, {})
    held = GRASP if element == "body" else TIED
    return (rows.get(quantity) or held[quantity]).about


def is_yes_no(element: str, quantity: str) -> bool:
    """Whether an element's quantity is 1 or 0 and nothing between."""
    if found := numbered(element, quantity):
        return NUMBERED[found[0]].yes_no
    row = QUANTITIES.get(element, {}).get(quantity) or (
        GRASP if element == "body" else TIED).get(quantity)
    return row is not None and row.yes_no


def is_count(element: str, quantity: str) -> bool:
    """Whether an element's quantity is a whole number of things."""
    row = QUANTITIES.get(element, {}).get(quantity)
    return row is not None and row.count


def is_live(element: str, quantity: str) -> bool:
    """Whether an element's quantity can be read while a run goes on."""
    if found := numbered(element, quantity):
        return NUMBERED[found[0]].live
    return quantity in LIVE[element] or (quantity in TIED and element != "body")


def reserved(kind: str) -> frozenset[str]:
    """What may not follow the name of an element of a list and a dot in another's name.

    ``contact`` and ``contact.normal``, of bodies: whole names of quantities, and what
    those begin with.
    """
    names = [*QUANTITIES.get(NAMED[kind].one, {}),
             *(TIED if kind in RELEASABLE else ())]
    return frozenset(".".join(name.split(".")[:count]) for name in names
                     for count in range(1, name.count(".") + 2))


def joint_quantities(
    kind: str, *, stops: bool, play: bool = False, rubs: bool = False,
) -> dict[str, str]:
    """Quantity to unit of a joint of a kind, with or without stops, play of its teeth, friction."""
    row = JOINTS[kind]
    return {name: QUANTITIES["joint"][name].unit or row.rubs for name in (
        *row.records, *(row.stopped if stops else ()), *(row.loose if play else ()),
        *(row.rubbed if rubs else ()))}


def needed(element: str, kind: str, quantity: str) -> str:
    """What an element of a kind has to be given to have a quantity; empty where nothing helps."""
    if element == "joint":
        row = JOINTS[kind]
        for names, field in ((row.stopped, "'limits'"), (row.loose, "'backlash'"),
                             (row.rubbed, "'friction' or 'friction_coefficient'")):
            if quantity in names:
                return field
    if at := numbered(element, quantity):
        return {"tension": "'friction' at one of its guides",
                "slip": f"'friction' at its guide {at[1]}, between its ends",
                "lifted": f"a 'radius' of its guide {at[1]}, between its ends, and neither "
                          "'friction' nor 'turns' there"}[at[0]]
    if quantity in TIED and element in ("joint", "spring", "tendon"):
        return "'breaks_at', or an event that lets go of it"
    return ""


def spring_quantities(kind: str) -> dict[str, str]:
    """Quantity to unit of a spring of a kind."""
    return {name: QUANTITIES["spring"][name].unit for name in SPRINGS[kind].records}


def drive_quantities(kind: str, *, spring: str = "") -> dict[str, str]:
    """Quantity to unit of a drive of a kind; ``spring`` is the kind of the one it sets, if any."""
    row = DRIVES[kind]
    own = row.unit or (SPRINGS[spring] if spring else ON_TENDON[kind]).unit
    return {name: QUANTITIES["drive"][name].unit or own for name in row.records}


def tendon_quantities(
    pieces: int, gripping: Iterable[int], lifting: Iterable[int],
) -> dict[str, str]:
    """Quantity to unit of a tendon of so many straight pieces.

    Guides ``gripping`` hold it by friction, wheels ``lifting`` it can lift off.
    """
    found, held = quantities_of("tendon"), tuple(gripping)
    if held:
        found |= {f"tension_{k}": NUMBERED["tension"].unit for k in range(pieces)}
        found |= {f"slip_{k}": NUMBERED["slip"].unit for k in held}
    return found | {f"lifted_{k}": NUMBERED["lifted"].unit for k in lifting}


def grasp_quantities(*, free: bool) -> dict[str, str]:
    """Quantity to unit of what an object has besides; ``free`` where it moves freely."""
    return {name: row.unit for name, row in GRASP.items() if free or not row.of_free}


def quantities_of(element: str) -> dict[str, str]:
    """Quantity to unit of a ``body``, ``tendon``, ``group`` or ``pair``: of all of its kind."""
    return {name: quantity.unit for name, quantity in QUANTITIES[element].items()}


def by_telling(quantities: Iterable[str]) -> list[str]:
    """Quantities of an element, those first that are looked at first."""
    rank = {name: place for place, name in enumerate(TELLING)}
    return sorted(quantities, key=lambda name: rank.get(name, len(rank)))
