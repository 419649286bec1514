"""Friction in the sheaths: how much of the pull reaches the tip, and what it does to adaptation.

Three sweeps (``scenes/studies/sheath_*.json``) and three runs whose whole course is drawn, held
against the closed forms of :mod:`sandbox.findings.sheath_forms`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import astuple, dataclass, fields
from functools import cache
from pathlib import Path

import numpy as np

from sandbox.atomic_files import write_atomic
from sandbox.comma import comma_separated
from sandbox.draw.figure.panels import Curve, Panel, save_panels
from sandbox.engine.simulate import simulate
from sandbox.findings.sheath_forms import (
    SheathedFinger,
    cycle,
    loop_area,
    over_pulleys,
    sheathed_finger,
)
from sandbox.findings.sweeping import run_sweeps
from sandbox.mechanics.closure import force_spread
from sandbox.numeric import Array
from sandbox.scene.read.load import load_scene
from sandbox.sweeps.table import SweepTable

SHARE, HAND, PULLEYS = "sheath_share", "sheath_hand", "sheath_pulleys"
SWEPT = 0.9
"""Of the time that a study takes, about what the sweeps do."""
LOOPS = (0.05, 0.1, 0.2)
"""Friction in the runs whose course is drawn, ..."""
BEND, RADIUS = np.pi, 0.016
"""... the bend of their sheaths [rad]; the disc of the picture of forces [m]."""
NONE = 1e-9
"""Friction that stands for none, so that a cord has its pieces."""
SLID = 1e-3
"""A tip with more than the least that friction leaves it, by this share, is held by the cord."""
PHALANGES = ("proximal", "middle", "distal")
DRAWN, TABLE = (0.05, 0.1, 0.2, 0.3), "sheaths.csv"
LIMIT = 4.0
"""Of the panel of forces, above the largest [N]."""


@dataclass(frozen=True)
class SheathedGrip:
    """What became of one finger; SI."""

    guides: bool
    """Whether the finger's guides rub as its sheath does."""
    radius: float
    bend: float
    """Of the sheath."""
    friction: float
    bend_in_all: float
    """With that at the finger's guides, when it wraps the disc."""
    share: float
    """Of the pull, in the tip."""
    share_closed: float
    """e^(-mu phi)."""
    forces: tuple[float, ...]
    """Of the phalanges, proximal first."""
    forces_closed: tuple[float, ...]
    """Of a cord that slides everywhere; below 0 where a phalanx would have to pull."""
    touching: int

    @property
    def wraps(self) -> bool:
        """Whether all phalanges touch."""
        return self.touching == len(PHALANGES)

    @property
    def held(self) -> bool:
        """Whether the cord no longer slides somewhere in the finger."""
        return self.share > (1 + SLID) * self.share_closed

    @property
    def could(self) -> bool:
        """Whether all phalanges would press, if the cord slid everywhere."""
        return min(self.forces_closed) > 0


UNITS = {"radius": "m", "bend": "rad", "bend_in_all": "rad"}


def run(
    directory: Path, *, progress: Callable[[float], None] | None = None, workers: int = 0,
    cluster: str = "",
) -> str:
    """Run the sweeps, write pictures and tables; a few lines on what came out.

    Raises:
        OutputError: a file cannot be written.
        SandboxError: no workers, or a cluster that cannot be used.
    """
    tables = run_sweeps(
        {name: name for name in (SHARE, HAND, PULLEYS)}, directory,
        progress and (lambda share: progress(SWEPT * share)), workers=workers, cluster=cluster)
    loops = {}
    for friction in LOOPS:
        loops[friction] = loop(friction)
        if progress is not None:
            progress(SWEPT + (1 - SWEPT) * len(loops) / len(LOOPS))
    grips = grips_of(tables[SHARE])
    write_atomic(directory / TABLE, table(grips))
    _draw(directory, grips, loops, tables)
    return summary(grips, loops, tables)


@cache
def finger(radius: float) -> SheathedFinger:
    """The finger of the study round a disc [m]."""
    return sheathed_finger(load_scene("sheathed_finger", overrides={"parameters.radius": radius}))


def grips_of(table: SweepTable) -> list[SheathedGrip]:
    """Each run of the sweep of one finger beside its closed form."""
    paths = ("guides", "radius", "phi", "mu")
    pull, found = 8.0, []
    forces = np.stack([table[name] for name in PHALANGES], axis=1)
    for row in range(len(table)):
        guides, radius, bend, friction = (float(table[f"parameters.{path}"][row])
                                          for path in paths)
        form = finger(radius)
        pieces = form.pieces(pull, bend, friction, guides * friction)
        found.append(SheathedGrip(
            bool(guides), radius, bend, friction, bend + guides * float(form.wraps.sum()),
            float(table["share"][row]), float(pieces[-1] / pull),
            tuple(forces[row].tolist()), tuple(form.forces(pieces).tolist()),
            int(table["touching"][row])))
    return found


def loop(friction: float) -> tuple[Array, Array]:
    """Pull on one finger and tension in it [N], as the pull rises and falls.

    Of the hand whose object does not swell.
    """
    run = simulate(load_scene("sheathed_hand", overrides={
        "parameters.mu": friction, "parameters.phi": BEND, "parameters.grow": 0,
        "parameters.rest": 0.02}))
    return run["actuator.value"] / 4, run["finger2.tendon.tension_0"]


def tensions(table: SweepTable, when: str, count: int = 4) -> Array:
    """Of the fingers [N], shape [runs, count]."""
    return np.stack([table[f"{when}{finger}"] for finger in range(1, count + 1)], axis=1)


def table(grips: Sequence[SheathedGrip]) -> str:
    """All numbers of the sweep of one finger, SI."""
    plain = [field.name for field in fields(SheathedGrip) if not field.name.startswith("forces")]
    names = [*(f"{name}_{UNITS[name]}" if name in UNITS else name for name in plain[:-1]),
             *(f"{name}_N" for name in PHALANGES), *(f"{name}_closed_N" for name in PHALANGES),
             plain[-1]]
    rows: list[list[object]] = []
    for grip in grips:
        *numbers, forces, closed, touching = astuple(grip)
        rows.append([*numbers, *forces, *closed, touching])
    return comma_separated(names, rows)


def _draw(
    directory: Path, grips: Sequence[SheathedGrip], loops: dict[float, tuple[Array, Array]],
    tables: dict[str, SweepTable],
) -> None:
    for ending in ("png", "svg", "pdf"):
        save_panels(directory / f"sheath_share.{ending}", [_arriving(grips), _pressing(grips)])
        save_panels(directory / f"sheath_spread.{ending}", [_spread(tables)])
        save_panels(directory / f"sheath_loop.{ending}", [_loops(loops)])


def _arriving(grips: Sequence[SheathedGrip]) -> Panel:
    bends = np.linspace(0, 8.4, 85)
    curves = []
    for friction in DRAWN:
        curves.append(Curve(f"friction {friction:g}, closed form", np.degrees(bends),
                            np.exp(-friction * bends)))
        some = [grip for grip in grips if grip.friction == friction and not grip.held]
        curves.append(Curve(f"friction {friction:g}, runs",
                            np.degrees([grip.bend_in_all for grip in some]),
                            np.array([grip.share for grip in some]), "points"))
    return Panel("What arrives in the tip", "bend of sheath and guides [deg]",
                 "tension / pull", curves)


def _pressing(grips: Sequence[SheathedGrip]) -> Panel:
    """Forces over friction, of the sheath of 180 deg, with guides that rub."""
    some = [grip for grip in grips
            if grip.guides and grip.radius == RADIUS and np.isclose(grip.bend, BEND)]
    friction = np.array([grip.friction for grip in some])
    curves = []
    for place, name in enumerate(PHALANGES):
        curves.append(Curve(f"{name} phalanx, if the cord slides everywhere", friction,
                            np.array([grip.forces_closed[place] for grip in some])))
        curves.append(Curve(f"{name} phalanx, runs", friction,
                            np.array([grip.forces[place] for grip in some]), "points"))
    return Panel("What the phalanges press with, behind a sheath of 180°",
                 "friction of cord and guides", "contact force [N]", curves)


CORD, PUSHED, UNEVEN, EVEN = (
    "one cord over pulleys", "pushed back by an object", "sheaths of 0° to 180°", "sheaths of 180°")


def tensions_closed(frictions: Array) -> dict[str, Array]:
    """By closed form, over a pull of 1 on each finger's cord, or on the one over pulleys.

    Shapes [frictions, 4], of one cord over pulleys [frictions, 5]. The third finger is the one
    that is pushed back, the fourth has the sheath that bends most.
    """
    turned = frictions[:, None] * BEND
    return {
        CORD: np.array([over_pulleys(1.0, mu, 5) for mu in frictions]),
        PUSHED: np.exp(turned * np.array([-1, -1, 1, -1])),
        UNEVEN: np.exp(-turned * np.arange(4) / 3),
        EVEN: np.exp(-turned * np.ones(4))}


def _spread(tables: dict[str, SweepTable]) -> Panel:
    hand, pulleys = tables[HAND], tables[PULLEYS]
    frictions = np.linspace(0, 0.3, 61)
    even, uneven = (np.isclose(hand["parameters.phi"], BEND) & (hand["parameters.uneven"] == k)
                    for k in (0, 1))
    found = {
        CORD: (pulleys["parameters.mu"], tensions(pulleys, "closed", 5)),
        PUSHED: (hand["parameters.mu"][even], tensions(hand, "swollen")[even]),
        UNEVEN: (hand["parameters.mu"][uneven], tensions(hand, "closed")[uneven]),
        EVEN: (hand["parameters.mu"][even], tensions(hand, "closed")[even])}
    curves = []
    for name, closed in tensions_closed(frictions).items():
        curves.append(Curve(f"{name}, closed form", frictions, force_spread(closed)))
        curves.append(Curve(f"{name}, runs", found[name][0], force_spread(found[name][1]),
                            "points"))
    return Panel("How unequally the fingers are pulled", "friction of the cord",
                 "standard deviation / mean", curves)


def _loops(loops: dict[float, tuple[Array, Array]]) -> Panel:
    curves = []
    for friction, (pull, tension) in loops.items():
        closed = cycle(pull, friction * BEND)
        curves.append(Curve(f"friction {friction:g}, run", pull, tension))
        curves.append(Curve(f"friction {friction:g}, closed form", pull[::60], closed[::60],
                            "points"))
    return Panel("Pulled, then let go: a sheath of 180°", "pull of the actuator on a finger [N]",
                 "tension in the finger [N]", curves)


def summary(
    grips: Sequence[SheathedGrip], loops: dict[float, tuple[Array, Array]],
    tables: dict[str, SweepTable],
) -> str:
    """What came out, in a few lines."""
    rubbing = [grip for grip in grips if grip.guides]
    plain = [grip for grip in grips if not grip.guides]
    wrapped = [grip for grip in plain if grip.wraps]
    slid = [grip for grip in grips if grip.wraps and not grip.held]
    off = max(abs(grip.share / grip.share_closed - 1) for grip in wrapped)
    force = max(abs(np.subtract(grip.forces, grip.forces_closed)).max() for grip in slid)
    hand = tables[HAND]
    pushed = (hand["parameters.uneven"] == 0) & (hand["touching3"] == len(PHALANGES))
    loss = (hand["parameters.mu"] * hand["parameters.phi"])[pushed]
    back = np.abs(tensions(hand, "swollen")[pushed, 2] / (8 * np.exp(loss)) - 1).max()
    areas = ", ".join(
        f"{-np.trapezoid(tension, pull):.2f} ({loop_area(8.0, mu * BEND):.2f})"
        for mu, (pull, tension) in loops.items())
    return "\n".join([
        f"A sheath leaves e^(-mu phi) of the pull: largest difference {100 * off:.2g} % in "
        f"{len(wrapped)} grips.",
        f"Forces of phalanges where the cord slides everywhere: within {force:.2g} N of J^-T tau "
        f"in {len(slid)} grips.",
        f"With guides that rub {sum(g.wraps for g in rubbing)} of {len(rubbing)} fingers wrap "
        f"their disc, without {sum(g.wraps for g in plain)} of {len(plain)}; of the former "
        f"{sum(g.wraps and g.held for g in rubbing)} are held by their cord.",
        f"A finger that is pushed back carries e^(mu phi) of its pull: within {100 * back:.2g} % "
        f"in {np.count_nonzero(pushed)} hands.",
        f"Area of the loop of friction {', '.join(f'{mu:g}' for mu in loops)} [N^2], closed form "
        f"in brackets: {areas}.",
    ])
