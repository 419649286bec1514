"""Figure 2d: elastic tendons from one bar against a differential, on the same fingers and objects.

Fingers that wrap their sections without friction have poses of geometry, whatever pulls them, and
so take up travels x_j that do not hang on the hand. On a differential each of n is pulled with
T = F / n. On one bar, which has gone x, spring j pulls with T_j = k (x - x_j); and as all of them
come to the bar's pull F,

    T_j = F / n + k (mean of x_j - x_j)

with the finger's own cord in series with its spring. What a finger presses with in all is the sum
of f = J^-T tau. The runs are held against all three.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import astuple, dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np

from sandbox.atomic_files import write_atomic
from sandbox.comma import comma_separated
from sandbox.draw.figure.panels import Curve, Panel, save_panels
from sandbox.draw.film.side_by_side import draw_ends
from sandbox.engine.simulate import simulate
from sandbox.mechanics.closure import force_spread
from sandbox.mechanics.grasp import DiscGrasp, disc_grasp
from sandbox.mechanics.statics import contact_forces, contact_jacobian
from sandbox.numeric import Array
from sandbox.paper.hand_stiffness import FreeFinger, free_fingers
from sandbox.recording.recording import Recording
from sandbox.scene.document import Scene
from sandbox.scene.read.load import load_scene

SOFT, ADAPTIVE = "elastic_tendons", "sliding_pulleys"
PULL = 20.0
"""F, shared by the fingers of either hand [N]."""
STIFFNESS = (300.0, 600.0)
"""Of the springs [N/m]."""
OBJECTS: Mapping[str, Mapping[str, float]] = {
    "bottle": {"parameters.object": 1}, "cone": {"parameters.object": 2},
    "bottle, finger3 stopped early": {"parameters.object": 1, "parameters.blocked": 3}}
"""What is held, and what the scenes call it."""
HANDS, TENSIONS, NUMBERS, TABLE = (
    "soft_hands.png", "soft_tensions", "soft_vs_adaptive.csv", "soft_vs_adaptive.md")
SHOWN, HIGHEST = "bottle, finger3 stopped early", 9.0
"""The object of the picture of both hands; the top of the panels [N]."""


@dataclass(frozen=True)
class Wrapped:
    """A finger round its section, from geometry alone."""

    finger: FreeFinger
    lengths: Array
    """[m], shape [n]."""
    grasp: DiscGrasp
    cord: float
    """Stiffness of its own cord [N/m]."""

    @property
    def travel(self) -> float:
        """What the finger takes up until it is wrapped, x_j of a cord without stretch [m]."""
        return float(self.finger.tendon.shortening(self.grasp.theta))

    def force(self, tension: float) -> float:
        """The sum of what its phalanges press with at a tension [N]."""
        torques = self.finger.net_torque(self.grasp.theta, tension)
        jacobian = contact_jacobian(self.grasp.theta, self.lengths, self.grasp.distances)
        return float(contact_forces(jacobian, torques).sum())


@dataclass(frozen=True)
class FingerShare:
    """One finger of one hand on one object; SI."""

    object: str
    finger: str
    stiffness: float
    """Of the springs, inf of the differential."""
    travel: float
    travel_closed: float
    tension: float
    tension_closed: float
    force: float
    force_closed: float


UNITS = {"stiffness": "N_per_m", "travel": "m", "tension": "N", "force": "N"}


def wrapped(scene: Scene, run: Recording) -> dict[str, Wrapped]:
    """The fingers of a hand that each have the section of their number to wrap, by name.

    Raises:
        ValueError: a section that lies where a phalanx does not reach it.
    """
    parts: dict[str, Any] = {part.name: part for part in scene.parts}
    cords = {tendon.name: tendon.stiffness for tendon in run.mechanism.tendons}
    found = {}
    for name, finger in free_fingers(run.model).items():
        spec, section = parts[name], parts[name.replace("finger", "section")]
        grasp = disc_grasp(np.subtract(section.at, spec.at), section.circle, spec.lengths,
                           spec.radii)
        found[name] = Wrapped(finger, spec.lengths, grasp, cords[f"{name}.tendon"])
    return found


def closed_tensions(fingers: Sequence[Wrapped], stiffness: float) -> Array:
    """T_j = F / n + k (mean of x_j - x_j) [N], shape [n]; F / n where ``stiffness`` is inf.

    Args:
        fingers: of one hand, wrapped.
        stiffness: of each spring [N/m].
    """
    share = PULL / len(fingers)
    if not np.isfinite(stiffness):
        return np.full(len(fingers), share)
    k = np.array([1.0 / (1.0 / stiffness + 1.0 / finger.cord) for finger in fingers])
    x = np.array([finger.travel for finger in fingers])
    return np.asarray(k * ((PULL + (k * x).sum()) / k.sum() - x))


def hand(name: str, stiffness: float) -> tuple[Scene, Recording]:
    """The scene and the run of one hand on an object by name; a differential for inf."""
    soft = bool(np.isfinite(stiffness))
    given = {"parameters.pull": PULL if soft else PULL / 10, **OBJECTS[name]}
    scene = load_scene(SOFT if soft else ADAPTIVE,
                       overrides=given | ({"parameters.k": stiffness} if soft else {}))
    return scene, simulate(scene)


def rows_of(name: str, stiffness: float, scene: Scene, run: Recording) -> list[FingerShare]:
    """What every finger of a run ended with, and its closed form."""
    fingers = wrapped(scene, run)
    rows = []
    for (finger, closed), tension in zip(
            fingers.items(), closed_tensions(list(fingers.values()), stiffness), strict=True):
        found = float(run[f"{finger}.tendon.tension"][-1])
        rows.append(FingerShare(
            name, finger, stiffness, float(run[f"x{finger[-1]}"][-1]),
            closed.travel + tension / closed.cord, found, float(tension),
            float(run[f"{finger}.contact.normal"][-1]), closed.force(float(tension))))
    return rows


def spreads(rows: Sequence[FingerShare]) -> tuple[float, float]:
    """Standard deviation over mean of the tensions, and of what the fingers press with."""
    tensions, forces = force_spread([[row.tension for row in rows], [row.force for row in rows]])
    return float(tensions), float(forces)


def run(directory: Path, *, progress: Callable[[float], None] | None = None) -> str:
    """Run both hands on all objects, write pictures and tables; a few lines on what came out.

    Raises:
        OutputError: a file cannot be written.
    """
    tried = [(name, k) for name in OBJECTS for k in (np.inf, *STIFFNESS)]
    found: dict[tuple[str, float], list[FingerShare]] = {}
    shown: dict[float, Recording] = {}
    for i, (name, stiffness) in enumerate(tried):
        scene, recording = hand(name, stiffness)
        found[name, stiffness] = rows_of(name, stiffness, scene, recording)
        if name == SHOWN and stiffness in (np.inf, STIFFNESS[-1]):
            shown[stiffness] = recording
        if progress is not None:
            progress((i + 1) / len(tried))
    draw_ends([shown[STIFFNESS[-1]], shown[np.inf]],
              [f"One bar and springs of {STIFFNESS[-1]:g} N/m", "One cord over sliding pulleys"],
              [{}, {}], directory / HANDS,
              note=f"the same fingers and sections ({SHOWN}), {PULL:g} N for all five in both",
              width=720, columns=1)
    for ending in ("png", "svg", "pdf"):
        save_panels(directory / f"{TENSIONS}.{ending}", [_panel(name, found) for name in OBJECTS])
    rows = [row for group in found.values() for row in group]
    write_atomic(directory / NUMBERS, _csv(rows))
    write_atomic(directory / TABLE, markdown(found))
    return summary(found)


def _panel(name: str, found: Mapping[tuple[str, float], list[FingerShare]]) -> Panel:
    """The tensions of one object over the fingers, all hands, with the closed form in all."""
    hands = [(stiffness, rows) for (who, stiffness), rows in found.items() if who == name]
    number = np.arange(1.0, 1.0 + len(hands[0][1]))
    curves = [Curve(_called(stiffness), number, np.array([row.tension for row in rows]), "joined")
              for stiffness, rows in hands]
    closed = Curve("closed form", np.tile(number, len(hands)), np.array(
        [row.tension_closed for _, rows in hands for row in rows]), "points")
    return Panel(name, "finger", "tension [N]", [*curves, closed], top=HIGHEST)


def _called(stiffness: float) -> str:
    return f"springs of {stiffness:g} N/m" if np.isfinite(stiffness) else "differential"


def _percent(*shares: float) -> str:
    return ", ".join(f"{100 * share:.0f} %" for share in shares)


def _csv(rows: Sequence[FingerShare]) -> str:
    """All numbers in SI."""
    units = [UNITS.get(field.name.partition("_")[0], "") for field in fields(FingerShare)]
    return comma_separated(
        [f"{field.name}_{unit}" if unit else field.name
         for field, unit in zip(fields(FingerShare), units, strict=True)], map(astuple, rows))


def markdown(found: Mapping[tuple[str, float], list[FingerShare]]) -> str:
    """The table to read: travels of the differential, then tension and contact force by hand."""
    hands = (np.inf, *STIFFNESS)
    lines = ["| object | finger | x [mm] | "
             + " | ".join(f"{_called(k)}: T, Σ f [N]" for k in hands) + " |",
             "|" + "---|" * (3 + len(hands))]
    for name in OBJECTS:
        columns = [found[name, k] for k in hands]
        for i, row in enumerate(columns[0]):
            cells = [f"{rows[i].tension:.2f}, {rows[i].force:.2f}" for rows in columns]
            lines.append(f"| {name} | {row.finger} | {1e3 * row.travel:.2f} | "
                         + " | ".join(cells) + " |")
        lines.append(f"| {name} | spread | | "
                     + " | ".join(_percent(*spreads(rows)) for rows in columns) + " |")
    return "\n".join(lines) + "\n"


def summary(found: Mapping[tuple[str, float], list[FingerShare]]) -> str:
    """What came out: how unequal each hand is on each object, how far closed forms are off."""
    hands, lines = (np.inf, *STIFFNESS), []
    for name in OBJECTS:
        tensions, forces = zip(*(spreads(found[name, k]) for k in hands), strict=True)
        lines.append(f"{name}: the tensions spread by {_percent(*tensions)}, "
                     f"the contact forces by {_percent(*forces)}.")
    lines.append(f"(In this order: {', '.join(_called(k) for k in hands)}.)")
    rows = [row for group in found.values() for row in group]
    tension = max(abs(row.tension - row.tension_closed) for row in rows)
    force = max(abs(row.force - row.force_closed) for row in rows)
    return "\n".join([*lines, "Largest difference from T = F / n and T = k (x - x_j): "
                      f"{tension:.2g} N; of contact forces from J^-T tau: {force:.2g} N."])
