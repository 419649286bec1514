"""A differential against none: four fingers on one bar, rigidly or by springs, and on rockers.

A finger that its section stops has taken up X_j of tendon. On a differential each of n fingers is
pulled with F / n. On one bar that has gone x, T_j = k (x - X_j) with k the spring in series with
the cord, and as all come to F,

    T_j = F / n + k (mean of X - X_j)

So the spread of tensions is k times that of the travels, until the finger that is stopped last
has nothing left. Tied rigidly k is that of cords: the finger that is stopped first takes all but
what the springs over their backs ask of the others, to come as far as it. Tensions and X_j are
held against those of :mod:`sandbox.mechanics.embrace`, from the sections and the way of the bar.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sandbox.atomic_files import write_atomic
from sandbox.comma import comma_separated
from sandbox.draw.figure import style
from sandbox.draw.figure.populations import (
    Agreeing,
    ClassPlane,
    OneSpread,
    SpreadRow,
    save_agreement,
    save_classes,
    save_spreads,
)
from sandbox.draw.film.side_by_side import draw_ends
from sandbox.engine.simulate import simulate
from sandbox.findings.hand_rows import (
    AT_REST,
    FINGERS,
    RAMP,
    HandRows,
    closing_finger,
    doubts,
    hand_rows,
)
from sandbox.findings.sweeping import run_sweeps
from sandbox.mechanics.closure import force_spread
from sandbox.mechanics.embrace import ClosingFinger, Embraced, Pull, close_on_discs
from sandbox.numeric import Array, Flags
from sandbox.scene.read.load import load_scene
from sandbox.sweeps.table import SweepTable
from sandbox.wording import percent

SWEEPS = {"rockers": "differential_rockers", "bar": "differential_bar"}
SCENES = {"rockers": "four_discs", "bar": "four_on_a_bar"}
PULL, CORD = 25.0, 1e5
"""Of the actuator [N]; stiffness of a finger's cord [N/m], which is the default of a scene."""
TIED = 1e5
"""Springs that stiff tie rigidly [N/m]."""
HOLDS = 2
"""Phalanges that press on a section that is held: one alone pushes it away."""
ORDER = ("stopped first", "second", "third", "last")
SHOWN = 5
"""The object of the picture of two hands: the number of its run."""


@dataclass(frozen=True)
class Tie:
    """All objects in one hand; arrays of the fingers of n objects, SI."""

    name: str
    stiffness: float
    """Between bar and fingers [N/m], inf of a differential."""
    rows: HandRows
    """Of those objects with which every tie came to rest."""

    @property
    def tension(self) -> Array:
        """[N], shape [n, 4]."""
        return self.rows.tension.reshape(-1, FINGERS)

    @property
    def force(self) -> Array:
        """Sum of what the phalanges of a finger press with [N], shape [n, 4]."""
        return np.asarray(self.rows.forces.sum(axis=1).reshape(-1, FINGERS))

    @property
    def lost(self) -> Flags:
        """Which sections fewer than two phalanges press on, shape [n, 4]."""
        return np.asarray(self.rows.pressing.sum(axis=1).reshape(-1, FINGERS) < HOLDS)

    @property
    def untouched(self) -> Flags:
        """Which sections nothing presses on, shape [n, 4]."""
        return np.asarray(~self.rows.pressing.any(axis=1).reshape(-1, FINGERS))


def run(directory: Path, *, progress: Callable[[float], None] | None = None, workers: int = 0,
        cluster: str = "") -> str:
    """Run what is missing of both sweeps, write pictures and tables; what came out.

    Raises:
        OutputError: a file cannot be written.
    """
    tables = run_sweeps(SWEEPS, directory, progress, workers=workers, cluster=cluster)
    ties = ties_of(tables)
    finger = closing_finger("four_discs")
    there = [closed(finger, tie) for tie in ties]
    predicted = [closed_tensions(tie, one) for tie, one in zip(ties, there, strict=True)]
    way = finger.tendon.shortening(there[0].theta).reshape(-1, FINGERS)
    _draw(directory, ties, way, predicted)
    draw_ends(
        [simulate(load_scene(SCENES[name], overrides=_object(tables["rockers"], name)))
         for name in SCENES], ["A tree of rockers", "Tied rigidly to one bar"], [{}, {}],
        directory / "hands.png", note=f"the same object, {PULL:g} N for all four in both",
        width=640, columns=1)
    write_atomic(directory / "ties.csv", ties_csv(ties))
    return summary(ties, predicted, tables)


def ties_of(tables: Mapping[str, SweepTable]) -> list[Tie]:
    """The hands by how their fingers are tied, each on the objects that all came to rest with."""
    rows, bar = hand_rows(tables["rockers"]), hand_rows(tables["bar"])
    k = tables["bar"]["parameters.k"]
    found = [("rockers", np.inf, rows)]
    for value in np.unique(k).tolist():
        name = "rigid" if value == TIED else f"springs of {value:g} N/m"
        found.append((name, value, bar.only((k == value)[bar.runs])))
    sound = np.all([each.sound.reshape(-1, FINGERS).all(axis=1) for *_, each in found], axis=0)
    return [Tie(name, value, each.only(np.repeat(sound, FINGERS)))
            for name, value, each in found]


def closed(finger: ClosingFinger, tie: Tie) -> Embraced:
    """Fingers by the closed form: at their tensions on rockers, else from the way of the bar."""
    rows = tie.rows
    if not np.isfinite(tie.stiffness):
        pull = Pull(rows.tension)
    else:
        pull = Pull(rows.drawn + rows.tension / tie.stiffness, _with_cord(tie.stiffness))
    return close_on_discs(finger, rows.centres(finger.radii[0]), rows.radius, pull, RAMP)


def closed_tensions(tie: Tie, there: Embraced) -> Array:
    """Of every finger [N], shape [n, 4]: F / n on rockers; nan where no rest was found."""
    if not np.isfinite(tie.stiffness):
        return np.full(tie.tension.shape, PULL / FINGERS)
    return np.where(there.residual < AT_REST, there.tension, np.nan).reshape(-1, FINGERS)


def _with_cord(stiffness: float) -> float:
    return 1.0 / (1.0 / stiffness + 1.0 / CORD)


def _object(table: SweepTable, scene: str) -> dict[str, float]:
    """What the scene of a tie is given for the object that is shown."""
    return {path: float(table[path][SHOWN]) for path in table.varied} | (
        {"parameters.k": TIED} if scene == "bar" else {})


def _draw(directory: Path, ties: Sequence[Tie], way: Array,
          predicted: Sequence[Array]) -> None:
    order = np.argsort(way, axis=1, kind="stable")
    save_spreads(directory / "tensions.png", [SpreadRow(_called(tie), [
        _spread(name if place == 0 else "", np.take_along_axis(tie.tension, order, 1)[:, i])
        for i, name in enumerate(ORDER)]) for place, tie in enumerate(ties)],
        x="tension [N]", y="objects", right=PULL,
        band=(0.95 * PULL / FINGERS, 1.05 * PULL / FINGERS),
        footnote=f"Shaded: a quarter of the pull of {PULL:g} N, and 5 % about it. Fingers in the "
        "order in which their sections stop them, by the tendon that they take up on rockers.")
    uneven = way.std(axis=1)
    numbers = np.repeat(np.arange(len(ties)), len(uneven))
    planes = []
    for title, values in (("tension", [tie.tension for tie in ties]),
                          ("sum of contact forces", [tie.force for tie in ties])):
        shown = np.concatenate([100 * force_spread(each) for each in values])
        planes.append(ClassPlane(title, np.tile(1e3 * uneven, len(ties)), shown, numbers,
                                 _lines(ties, uneven) if title == "tension" else ()))
    save_classes(directory / "spread.png", [planes],
                 [(tie.name, colour) for tie, colour in zip(ties, style.COLOURS, strict=False)],
                 x="spread of the travels [mm]", y="spread over the fingers [%]",
                 top=180.0, footnote="Spread: standard deviation over the four fingers, that "
                 "of forces as a share of their mean. Travel: the tendon that a finger takes up on "
                 "rockers. Lines: k times the spread of travels. 173 %: one finger has all.")
    save_agreement(directory / "closed_form.png", [
        Agreeing(tie.name, there[np.isfinite(there)], tie.tension[np.isfinite(there)])
        for tie, there in zip(ties, predicted, strict=True)],
        x="tension by the closed form [N]", y="tension of the simulation [N]",
        difference="difference [N]", least=1e-9)


def _lines(ties: Sequence[Tie], uneven: Array) -> list[tuple[Array, Array, str]]:
    x = np.linspace(0.0, float(uneven.max()), 50)
    return [(1e3 * x, 100 * _with_cord(tie.stiffness) * x / (PULL / FINGERS), colour)
            for tie, colour in zip(ties, style.COLOURS, strict=False) if tie.stiffness < TIED]


def _called(tie: Tie) -> str:
    return f"{tie.name[0].upper()}{tie.name[1:]}: {percent(tie.lost.mean())} of sections lost"


def _spread(title: str, values: Array) -> OneSpread:
    return OneSpread(title, values, f"median\n{np.median(values):.2f} N")


def ties_csv(ties: Sequence[Tie]) -> str:
    """A line for each tie: spreads, largest and least tension, what is lost."""
    rows: list[list[object]] = []
    for tie in ties:
        tensions, forces = force_spread(tie.tension), force_spread(tie.force)
        cells = [*np.percentile(tensions, [50, 95]).tolist(),
                 *np.percentile(forces, [50, 95]).tolist(),
                 float(np.median(tie.tension.max(axis=1))),
                 float(np.median(tie.tension.min(axis=1))),
                 float(np.percentile(tie.rows.forces.max(axis=1), 95)),
                 float(tie.lost.mean()), float(tie.untouched.mean()),
                 float(tie.lost.any(axis=1).mean())]
        rows.append([tie.name, len(tie.tension), *cells])
    return comma_separated(
        ["tie", "objects", "tension_spread_median", "tension_spread_95_percent",
         "force_spread_median", "force_spread_95_percent", "largest_tension_median_N",
         "least_tension_median_N", "largest_phalanx_force_95_percent_N", "sections_lost",
         "sections_untouched", "objects_with_a_section_lost"], rows)


def summary(ties: Sequence[Tie], predicted: Sequence[Array],
            tables: Mapping[str, SweepTable]) -> str:
    """What came out: spreads, what is lost, how far the closed form is off."""
    lines = []
    for tie, there in zip(ties, predicted, strict=True):
        tensions, forces = force_spread(tie.tension), force_spread(tie.force)
        off = np.abs(tie.tension - there)[np.isfinite(there)]
        lines.append(
            f"{tie.name}: tensions spread by {percent(np.median(tensions))} (median of "
            f"{len(tensions)} objects), contact forces by {percent(np.median(forces))}; "
            f"{percent(tie.lost.mean())} of sections lost, {percent(tie.untouched.mean())} "
            f"not touched, {percent(tie.lost.any(axis=1).mean())} of objects with one lost; "
            f"closed form within {np.percentile(off, 95):.1g} N for 95 %, {off.max():.1g} N "
            f"for all {len(off)} of which it finds a rest.")
    return "\n".join([*lines, doubts(tables)])
