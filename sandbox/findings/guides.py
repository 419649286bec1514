"""Where to put the guides: phalanges that press alike over a range of discs, and what that costs.

Two searches move three guides and three springs of one finger: one looks at one pull, the other at
three. What they find is held against other discs, places, pulls and squares, beside the guides of
the paper's section 5 and the finger of Set G; docs/studies/guides.md tells what came out.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from sandbox.atomic_files import write_atomic
from sandbox.comma import comma_separated
from sandbox.draw.figure.panels import Curve, Panel, save_panels
from sandbox.draw.film.side_by_side import draw_ends
from sandbox.engine.simulate import simulate
from sandbox.errors import SandboxError
from sandbox.findings.guide_statics import (
    GuideDesign,
    best_design,
    design_of,
    mean_spread,
    numbers_of,
    poses,
    spread,
)
from sandbox.findings.sweeping import run_sweeps
from sandbox.numeric import Array, Flags
from sandbox.scene.library import shipped_studies
from sandbox.scene.read.load import load_scene
from sandbox.search.asking import Where
from sandbox.search.optimum import Chosen
from sandbox.search.written import read_search
from sandbox.study.reference_fingers import SET_G
from sandbox.sweeps.table import SweepTable

SEARCHED = {"one pull": ("guides_one_pull", (3.75,)),
            "three pulls": ("guides_any_pull", (2.5, 3.75, 7.5))}
"""What each search is called, its study, and at which pulls it looks [N]."""
DESIGNS = ("one height", "Set G", *SEARCHED)
"""Of the sweeps, in their order."""
SHORT = {"one height": "one height", "Set G": "Set G", "one pull": "best at one pull",
         "three pulls": "best at three pulls"}
TITLES = {"Set G": "Set G at 3.75 N", "one pull": "best at one pull, 3.75 N: at that pull",
          "three pulls": "best at 2.5, 3.75 and 7.5 N: at 3.75 N"}
"""What designs are called in a legend and above a panel."""
PHALANGES = ("proximal", "middle", "distal")
DISCS, PLACES, SQUARES = "guides_discs", "guides_places", "guides_squares"
TRAINED = (12e-3, 16e-3, 20e-3)
"""Radii of the discs that the searches look at [m]."""
PULL, PULLS = 3.75, (2.5, 3.75, 7.5, 15.0)
"""Of the pictures, and of the sweep over discs [N]."""
MIDDLE = 16e-3
"""Radius of the disc on which costs are told [m]."""
PRESSES = 1e-3
"""Of the pull: what counts as pressing."""
TABLE, COSTS, FOUND = "guides.csv", "guides_costs.csv", "guides_found.csv"
FORCES, OVER_PULLS, WAY, FINGERS = (
    "guides_forces.png", "guides_pulls.png", "guides_search.png", "guides_fingers.png")
PATHS = tuple(f"parameters.{part}_{axis}" for part in PHALANGES for axis in "xy") + tuple(
    f"parameters.{part}_k" for part in PHALANGES)
"""What a search varies, as :func:`sandbox.findings.guide_statics.numbers_of` has it."""
PALM = ("parameters.palm_x", "parameters.palm_y")
SHARES = (0.35, 0.35, 0.3)
"""Of the work, for progress: two searches, all sweeps."""


@dataclass(frozen=True)
class SoughtGuides:
    """What a search found, and the closed form beside it."""

    pulls: tuple[float, ...]
    """At which it looks [N]."""
    chosen: Chosen
    design: GuideDesign
    """What it found."""
    closed: float
    """The spread of this design by the closed form."""
    best: GuideDesign
    """The best of the closed form, in the same ranges."""
    least: float
    """Its spread."""


def run(
    directory: Path, *, progress: Callable[[float], None] | None = None, workers: int = 0,
    cluster: str = "",
) -> str:
    """Search, sweep, draw; a few lines on what came out.

    Args:
        directory: rows are kept in it and found again; pictures and tables go there.
        progress: is told how far it is, 0 to 1.
        workers: processes; as many as there are processors by default.
        cluster: address of a Dask scheduler to be used in their place.

    Raises:
        OutputError: a file cannot be written.
        SandboxError: packages of searches that are not installed.
    """
    crew: dict[str, Any] = {"workers": workers, "cluster": cluster}

    def part(k: int) -> Callable[[float], None]:
        return lambda share: progress(sum(SHARES[:k]) + SHARES[k] * share) if progress else None

    found = {name: sought(study, pulls, directory / study, part(k), crew)
             for k, (name, (study, pulls)) in enumerate(SEARCHED.items())}
    tables = run_sweeps({study: study for study in (DISCS, PLACES, SQUARES)}, directory, part(2),
                        **crew)
    designs = designs_of(tables[DISCS])
    rows, costs = summary(tables), costs_of(designs)
    write_atomic(directory / TABLE, _table(rows))
    write_atomic(directory / COSTS, _table(costs))
    write_atomic(directory / FOUND, _table(told_of(found)))
    save_panels(directory / FORCES, [
        forces_panel(tables[DISCS], name, designs[name], k)
        for k, name in enumerate(DESIGNS) if k])  # the first never has three that press
    save_panels(directory / OVER_PULLS, [pulls_panel(tables[DISCS], designs)])
    save_panels(directory / WAY, [way_panel(found)])
    draw_fingers(directory / FINGERS, tables[DISCS])
    return said(rows, found)


def sought(
    study: str, pulls: tuple[float, ...], directory: Path, progress: Callable[[float], None],
    crew: Mapping[str, Any],
) -> SoughtGuides:
    """What a shipped search finds; runs that are done in the directory are not done again.

    Raises:
        SandboxError: it is no search for the best.
    """
    search = read_search(shipped_studies()[study])
    count, most = 0, int(search.words["runs"])

    def heard(row: object) -> None:
        nonlocal count
        count += 1
        progress(min(count / most, 1.0))

    chosen = search.run(Where(directory, heard=heard, **crew))
    if not isinstance(chosen, Chosen):
        raise SandboxError(f"{study} is no search for the best")
    values = chosen.best[0].values
    design = design_of(np.array(SET_G.guides[0]), np.array([float(values[path]) for path in PATHS]))
    low, high = (search.question.space.numbers([[end] * len(PATHS)])[0] for end in (0.0, 1.0))
    order = [search.question.space.paths.index(path) for path in PATHS]
    here = poses(TRAINED)
    best, least = best_design(design, low[order], high[order], here, pulls)
    return SoughtGuides(pulls, chosen, design, mean_spread(design, here, pulls), best, least)


def designs_of(table: SweepTable) -> dict[str, GuideDesign]:
    """The designs of a sweep, by name."""
    columns = [table.varied[path] for path in (*PALM, *PATHS)]
    numbers = list(dict.fromkeys(zip(*columns, strict=True)))
    return {name: design_of(np.array(each[:2]), np.array(each[2:]))
            for name, each in zip(DESIGNS, numbers, strict=True)}


def forces_of(table: SweepTable) -> Array:
    """Normal forces of the phalanges [N], shape [designs, runs of each, 3]."""
    return np.stack([table[name] for name in PHALANGES], axis=-1).reshape(len(DESIGNS), -1, 3)


def column(table: SweepTable, path: str) -> Array:
    """A path's values in the runs of one design, SI."""
    return np.array(table[path], dtype=float)[:len(table) // len(DESIGNS)]


def summary(tables: Mapping[str, SweepTable]) -> list[dict[str, Any]]:
    """How alike phalanges press, a row for each design and set of objects."""
    discs = tables[DISCS]
    radius, pull = column(discs, "parameters.radius"), column(discs, "parameters.pull")
    trained = (radius > TRAINED[0] - 1e-6) & (radius < TRAINED[-1] + 1e-6)
    sets: list[tuple[str, str, float, Flags]] = [
        ("discs of 12 to 20 mm", DISCS, each, trained & (pull == each)) for each in PULLS]
    sets += [("thinner discs", DISCS, PULL, (radius < TRAINED[0] - 1e-6) & (pull == PULL)),
             ("thicker discs", DISCS, PULL, (radius > TRAINED[-1] + 1e-6) & (pull == PULL))]
    sets += [(words, study, PULL, np.ones(len(tables[study]) // len(DESIGNS), dtype=bool))
             for words, study in (("discs elsewhere", PLACES), ("squares", SQUARES))]
    rows = []
    for k, design in enumerate(DESIGNS):
        for words, study, each, which in sets:
            forces = forces_of(tables[study])[k, which]
            rows.append({
                "design": design, "objects": words, "pull_N": each, "runs": int(which.sum()),
                "spread": float(spread(forces).mean()),
                "all_press": float((forces > PRESSES * each).all(axis=1).mean()),
                "force_N": float(forces.mean()), "largest_N": float(forces.max())})
    return rows


def costs_of(designs: Mapping[str, GuideDesign]) -> list[dict[str, Any]]:
    """What designs ask for on one disc, by the closed form, a row for each."""
    here = poses([MIDDLE])
    rows = []
    for name, design in designs.items():
        least, most = here.pulls(design)
        forces = here.forces(design, PULL)[0]
        turns = design.free / design.free.sum()
        rows.append({
            "design": name, "travel_mm": 1e3 * float(design.travel(here.theta)[0]),
            "least_pull_N": float(least[0]) if least < most else np.nan,
            "largest_pull_N": float(most[0]) if least < most else np.nan,
            "forces_per_pull": float(forces.sum() / PULL) if (forces >= 0).all() else np.nan,
            **{f"{joint}_turns_first": float(turn)
               for joint, turn in zip(("mcp", "pip", "dip"), turns, strict=True)}})
    return rows


def told_of(found: Mapping[str, SoughtGuides]) -> list[dict[str, Any]]:
    """What searches found beside the best of the closed form, two rows for each."""
    rows = []
    for name, each in found.items():
        for who, design, value, closed in (
                ("search", each.design, next(iter(each.chosen.best[0].objectives.values())),
                 each.closed), ("closed form", each.best, each.least, each.least)):
            numbers = dict(zip((path.removeprefix("parameters.") for path in PATHS),
                               numbers_of(design).tolist(), strict=True))
            rows.append({"search": name, "by": who, "runs": each.chosen.runs if who == "search"
                         else 0, "spread": value, "spread_closed": closed, **numbers})
    return rows


def _table(rows: Sequence[Mapping[str, Any]]) -> str:
    return comma_separated(rows[0], (row.values() for row in rows), digits=6)


def forces_panel(table: SweepTable, name: str, design: GuideDesign, k: int) -> Panel:
    """Forces of one design over the radius of the disc, closed form and runs."""
    radius, pull = column(table, "parameters.radius"), column(table, "parameters.pull")
    which = pull == PULL
    shown = np.linspace(radius.min(), radius.max(), 89)
    closed = poses(shown).forces(design, PULL)
    curves = [Curve(f"{part}, closed form", 1e3 * shown, closed[:, i])
              for i, part in enumerate(PHALANGES)]
    curves += [Curve(f"{part}, simulated", 1e3 * radius[which], forces_of(table)[k, which, i],
                     "points") for i, part in enumerate(PHALANGES)]
    return Panel(TITLES[name], "radius of the disc [mm]", "normal force [N]", curves, top=2.5,
                 band=(1e3 * TRAINED[0], 1e3 * TRAINED[-1]))


def pulls_panel(table: SweepTable, designs: Mapping[str, GuideDesign]) -> Panel:
    """How unlike forces are over the pull, on the disc of 16 mm."""
    radius, pull = column(table, "parameters.radius"), column(table, "parameters.pull")
    which = np.isclose(radius, MIDDLE)
    shown, here = np.linspace(PULLS[0], PULLS[-1], 126), poses([MIDDLE])
    curves = []
    for k, (name, design) in enumerate(designs.items()):
        closed = np.array([here.forces(design, each)[0] for each in shown])
        values = np.where((closed < 0).any(axis=1), np.nan, spread(closed))
        if np.isfinite(values).any():
            curves.append(Curve(f"{SHORT[name]}, closed form", shown, values))
        curves.append(Curve(f"{SHORT[name]}, simulated", pull[which],
                            spread(forces_of(table)[k, which]), "points"))
    return Panel("Standard deviation over mean of the three forces, disc of 16 mm", "pull [N]",
                 "spread of the forces", curves, band=(2.5, 7.5))


def way_panel(found: Mapping[str, SoughtGuides]) -> Panel:
    """The best so far of both searches, and the best of the closed form."""
    curves = []
    for name, each in found.items():
        history = np.fmin.accumulate(each.chosen.history[:, 0])
        curves += [Curve(f"{SHORT[name]}, search", np.arange(1.0, 1.0 + len(history)), history),
                   Curve(f"{SHORT[name]}, closed form", np.array([1.0, len(history)]),
                         np.full(2, each.least))]
    return Panel("The best so far, and the best of the closed form", "run",
                 "spread of the forces", curves, top=0.5)


def draw_fingers(path: Path, table: SweepTable) -> None:
    """Set G and the best at three pulls, on the thinnest and the thickest disc of the searches."""
    recordings, labels = [], []
    each = len(table) // len(DESIGNS)
    for k, name in ((1, "Set G"), (3, "best at three pulls")):
        for radius in (TRAINED[0], TRAINED[-1]):
            values = {path: table.varied[path][k * each] for path in (*PALM, *PATHS)}
            scene = load_scene("guided_finger", overrides={
                **values, "parameters.radius": radius})
            run = simulate(scene)
            recordings.append(run.part(len(run) - 1, len(run)))  # on its way it needs more room
            labels.append(f"{name}, disc of {1e3 * radius:g} mm")
    draw_ends(recordings, labels, [{}] * len(recordings), path, width=640, columns=2, words=2.0,
              note=f"{PULL:g} N on each cord")


def said(rows: Sequence[Mapping[str, Any]], found: Mapping[str, SoughtGuides]) -> str:
    """A few lines on what came out."""
    lines = []
    for design in DESIGNS:
        own = {(row["objects"], row["pull_N"]): row["spread"] for row in rows
               if row["design"] == design}
        lines.append(f"{design}: spread of the forces " + ", ".join(
            f"{own['discs of 12 to 20 mm', pull]:.2f}" for pull in PULLS)
            + f" at {', '.join(f'{pull:g}' for pull in PULLS)} N on discs of 12 to 20 mm; "
            + ", ".join(f"{own[words, PULL]:.2f} on {words}" for words in (
                "thinner discs", "thicker discs", "discs elsewhere", "squares")))
    lines += [f"search at {name}: {told['spread']:.4f} after {each.chosen.runs} runs, by the "
              f"closed form {each.closed:.4f}; the least of the closed form is {each.least:.4f}"
              for (name, each), told in zip(found.items(), told_of(found)[::2], strict=True)]
    return "\n".join(lines) + "\n"
