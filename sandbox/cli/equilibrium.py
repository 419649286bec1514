"""``sandbox equilibrium``: the static equilibria of a scene, and along a parameter."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import click
import numpy as np

from sandbox.atomic_files import json_text, write_atomic, write_csv
from sandbox.cli.console import Console, Exit, first_of, monitored, table
from sandbox.cli.options import RENDERS, Source, prepare, refuse_blocking, safe_name
from sandbox.engine.inspect import inspect
from sandbox.engine.inspect_control import Checked
from sandbox.equilibria.branches import rest_along
from sandbox.equilibria.rest import AtRest, known_body, places, quantities, rest, verdict
from sandbox.model.catalogue import Catalogue, UnknownQuantityError
from sandbox.scene.mechanism import Mechanism

MAX_COLUMNS = 5  # equilibria side by side in the terminal; files have all
MAX_STICKING = 4  # sticking contacts that are named
DIGITS = 10  # decimal places in the terminal [m, rad, N]
STIFFNESS = {"x": "N/m", "y": "N/m", "turn": "N m/rad", "least": "N/m"}
Answer = tuple[dict[str, Any], list[list[str]], list[Path], list[str]]
"""Data for JSON, rows for CSV with the header first, pictures, and lines for the terminal."""


def equilibrium(
    scene: Source, starts: list[dict[str, float]], at: float | None, stages: int | None,
    along: tuple[str, float, float, str, int] | None, quantity: str | None, body: str | None,
    out: Path | None, console: Console,
) -> int:
    """Find equilibria, or follow them along a value; write and print them."""
    for wrong, why in (
            (along and starts, "--along starts from the scene's pose; omit --from."),
            (along and body, "--body is for one equilibrium; omit --along or --body."),
            (quantity and not along, "--plot needs --along.")):
        if wrong:
            raise click.UsageError(why)
    loaded = scene.load()
    name = loaded.mechanism.name
    refuse_blocking(inspect(loaded.mechanism), loaded)
    folder = out or RENDERS / "rest" / safe_name(name)
    prepare(folder)
    how = {"at": at, "stages": stages}
    data, rows, pictures, lines = \
        _find(loaded.mechanism, starts, body, folder, console, how) if along is None else \
        _follow(scene, along, quantity, folder, console, how)
    whole = {"status": "done", "exit_code": int(Exit.DONE), "scene": name, **data}
    write_atomic(folder / "rest.json", json_text(whole, indent=1) + "\n")
    write_csv(folder / "rest.csv", rows)
    files = [folder / "rest.json", folder / "rest.csv", *pictures]
    return console.finish({"scene": name, **data, "files": files}, [*lines, *files])


def _find(
    mechanism: Mechanism, starts: list[dict[str, float]], body: str | None, folder: Path,
    console: Console, how: dict[str, Any],
) -> Answer:
    from sandbox.picture.film import render
    if body is None:
        objects = [each.name for each in mechanism.bodies
                   if each.role == "object" and each.motion == "dynamic" and each.shapes]
        body = objects[0] if len(objects) == 1 else ""
    else:
        known_body(mechanism, body)
    with monitored(console):
        found = rest(Checked(mechanism), starts=starts, **how)
    rests, several = found.rests, len(found.rests) > 1
    pictures, data, lines, stiffnesses = [], [], list[str](), list[str]()
    for i, each in enumerate(rests, 1):
        pictures.append(folder / (f"rest_{i}.png" if several else "rest.png"))
        render(each.recording, pictures[-1])
        lines.append(f"{f'rest {i}' if several else 'at rest'}"
                     f"{f' (from {each.start})' if each.start else ''}: {verdict(each)}")
        if each.sticking:
            lines.append(f"  friction holds {first_of(each.sticking, MAX_STICKING)}: nearby poses "
                         "are at rest, too")
        data.append({**_data(each), "stiffness": None})
        with contextlib.suppress(ArithmeticError):  # it is unknown
            if body and not each.untold:
                values = [float(value) for value in each.stiffness(body).stiffness()]
                data[-1]["stiffness"] = {"body": body, **dict(zip(STIFFNESS, values, strict=True))}
                x, y, turn, least = (
                    "rigid" if math.isinf(value) else f"{value:.5g} {unit}"
                    for value, unit in zip(values, STIFFNESS.values(), strict=True))
                of = f" in rest {i}" if several else ""
                stiffnesses.append(f"stiffness of {body}{of}: {x} along x, {y} along y, {turn} in "
                                   f"rotation; {least} in the softest direction")
    units, listed = _units(rests), rests[:MAX_COLUMNS]
    rows = [["quantity", "unit", *(f"rest_{i}" for i in range(1, len(rests) + 1))],
            *([name, unit, *(f"{each[name]:.12g}" for each in rests)]
              for name, unit in units.items())]
    heads = [f"rest {i}" for i in range(1, len(listed) + 1)] if several else ["value"]
    lines += ["", *table(["quantity", "unit", *heads], [
        *([name, unit, *(_shown(each[name]) for each in listed)] for name, unit in units.items()),
        ["residual", "N", *(f"{each.left:.2g}" for each in listed)],
    ], right="<<" + ">" * len(listed)), ""]
    if rests[MAX_COLUMNS:]:
        lines.append(f"{len(rests) - MAX_COLUMNS} more are in the files")
    failed = [{"from": start.removeprefix(" from "), "reason": why} for start, why in found.failed]
    lines += [*stiffnesses, *found.remarks,
              *(f"no rest{start}: {why}" for start, why in found.failed)]
    return {"rests": data, "failed": failed, "remarks": found.remarks}, rows, pictures, lines


def _units(rests: Sequence[AtRest]) -> dict[str, str]:
    """The quantities that equilibria are described by, with their units."""
    return {name: unit for each in rests for name, unit in quantities(each.recording).items()}


def _data(rest: AtRest) -> dict[str, Any]:
    return {"from": rest.start, "stability": rest.stability, "untold": rest.untold,
            "modes": rest.modes.tolist(), "loose": rest.loose, "sticking": rest.sticking,
            "left": rest.left, "steps": rest.steps,
            "quantities": {name: {"value": rest[name], "unit": unit}
                           for name, unit in _units([rest]).items()}}


def _shown(value: float) -> str:
    """A number in SI, without rounding errors about 0."""
    return f"{round(value, DIGITS) + 0.0:.6g}"


def _follow(
    scene: Source, along: tuple[str, float, float, str, int], quantity: str | None, folder: Path,
    console: Console, how: dict[str, Any],
) -> Answer:
    from sandbox.figure.sweeps import BranchCurve, save_branches
    path, begin, end, unit, count = along
    label = f"{path} [{unit}]" if unit else path

    def make(value: float) -> Mechanism:
        return scene.load({path: f"{value!r} {unit}" if unit else value}).mechanism

    mechanism = make(begin)
    known = Catalogue(mechanism)
    if quantity is not None and quantity not in known:
        error = UnknownQuantityError(quantity, known.near(quantity), known.lacking(quantity))
        raise click.BadParameter(str(error), param_hint="--plot")
    with monitored(console) as progress:
        branches = rest_along(
            make, begin, end, count, **how, on_point=lambda points, value: progress.note(
                f"{points} points of rest, now at {label} = {value:.6g}"))
    rests = [stop.rest for branch in branches for stop in branch.stops]
    quantity = quantity or max(places(rests[0].recording), key=lambda name: float(
        np.ptp([rest[name] for rest in rests])  # angles times the size of the mechanism
        * (rests[0].size if rests[0].recording.unit(name) == "rad" else 1.0)))
    of = rests[0].recording.unit(quantity)
    units = {quantity: of, **_units(rests)}
    data, curves, lines = [], [], list[str]()
    rows = [["branch", label, "stability", "fold",
             *(f"{name}_{each}" if each else name for name, each in units.items())]]
    for i, branch in enumerate(branches, 1):
        stops = branch.stops
        data.append({"ends": branch.ends, "points": [
            {"value": stop.value, "fold": stop.fold, **_data(stop.rest)} for stop in stops]})
        rows += [[str(i), f"{stop.value:.12g}", stop.rest.stability, str(int(stop.fold)),
                  *(f"{stop.rest[name]:.12g}" for name in units)] for stop in stops]
        curves.append(BranchCurve(*(np.array(column) for column in zip(*(
            (stop.value, stop.rest[quantity], stop.rest.stability == "stable", stop.fold)
            for stop in stops), strict=True))))
        shown = [[_shown(stop.value), _shown(stop.rest[quantity]),
                  "fold" if stop.fold else stop.rest.stability] for stop in stops]
        name = f"branch {i}" if len(branches) > 1 else "branch"
        lines += [f"{name}{f': {branch.ends}' if branch.ends else ''}",
                  *table([label, f"{quantity} [{of}]", ""], shown, right=">>"), ""]
    save_branches(folder / "rest.png", curves, along=label, quantity=quantity, unit=of,
                  title=f"Rest along {path}: {mechanism.title or mechanism.name}")
    return ({"along": label, "quantity": quantity, "unit": of, "branches": data}, rows,
            [folder / "rest.png"], lines)
