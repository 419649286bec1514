"""``sandbox equilibrium``: the static equilibria of a scene, and along a parameter."""

from __future__ import annotations

import csv
import io
import itertools
import json
import math
import re
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sandbox.cli.check import refuse_blocking
from sandbox.cli.console import Console, Heartbeat, compilation_notices, table
from sandbox.cli.failures import Exit
from sandbox.cli.options import OUT, limit_option, scene_options
from sandbox.cli.runs import prepare
from sandbox.cli.scenes import complete_scene, load, scene_path

if TYPE_CHECKING:
    from sandbox.equilibria.branches import Branch
    from sandbox.equilibria.rest import AtRest, RestFound
    from sandbox.recording.recording import Recording
    from sandbox.scene.mechanism import Mechanism
    from sandbox.scene.read.limits import Limits

DIRECTORY = Path("renders") / "rest"
MAX_STARTS = 200
"""Combinations of the values of ``--from``."""
MAX_COLUMNS = 5
"""Equilibria side by side in the terminal; files have all."""
DIGITS = 10
"""Decimal places in the terminal [m, rad, N]."""
STIFFNESS = {"x": "N/m", "y": "N/m", "turn": "N m/rad", "least": "N/m"}
_VALUE = re.compile(r"^\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*([^\s\d.].*?)?\s*$")


@click.command()
@click.argument("scene", shell_complete=complete_scene)
@click.option("--from", "starts", multiple=True, metavar="PATH=VALUES",
              help="Start there instead of at the scene's own pose: JOINT.angle, BODY.x, BODY.y or "
                   "BODY.angle, with values separated by commas, as in 'arm.angle=-30 deg,0,30 "
                   "deg'. Several options: all combinations.")
@click.option("--at", type=float, metavar="SECONDS",
              help="Time whose values the drives have; by default the end of the scene.")
@click.option("--stages", type=click.IntRange(min=1), metavar="N",
              help="Steps in which the drives go there from their first values; by default 40, "
                   "with dry friction 200.")
@click.option("--along", metavar="PATH=FROM:TO:COUNT",
              help="Follow equilibria along a value of the scene, as in "
                   "'parameters.pull=0:10:21'.")
@click.option("--plot", "quantity", metavar="QUANTITY",
              help="With --along, the quantity in the figure; by default the one that changes "
                   "most.")
@click.option("--body", metavar="NAME", help="Body whose stiffness is printed; by default the one "
              "body with the role 'object' that moves freely.")
@click.option("--out", type=OUT, metavar="DIR",
              help="Directory of rest.json, rest.csv and rest.png; renders/rest/SCENE by default.")
@scene_options
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object and nothing else.")
@click.option("--quiet", "-q", is_flag=True, help="Print errors only.")
@limit_option
def equilibrium(
    scene: str, starts: tuple[str, ...], at: float | None, stages: int | None, along: str | None,
    quantity: str | None, body: str | None, out: Path | None, overrides: dict[str, Any],
    as_json: bool, quiet: bool, limits: Limits,
) -> int:
    """Find static equilibria of SCENE and their stability.

    The drives go slowly to their values at the end of the scene, or with --from
    have these values from the start. Prints poses, tensions, contact forces,
    residual forces and stability, and the stiffness of a held object. Scenes
    that have no equilibrium are refused, with the reason.
    """
    from sandbox.engine.inspect import inspect

    if along is not None and starts:
        raise click.UsageError("--along starts from the scene's pose; omit --from.")
    if along is not None and body is not None:
        raise click.UsageError("--body gives the stiffness of one equilibrium; omit --along or "
                               "--body.")
    if along is None and quantity is not None:
        raise click.UsageError("--plot needs --along.")
    loaded = load(scene_path(scene), overrides=overrides, limits=limits)
    mechanism = loaded.mechanism
    refuse_blocking(inspect(mechanism), loaded)
    console = Console(as_json=as_json, quiet=quiet)
    folder = out or DIRECTORY / (mechanism.name or "scene")
    prepare(folder)
    if along is None:
        data, lines, files = _find(mechanism, _starts(starts), at, stages, body, folder, console)
    else:
        path, begin, end, unit, count = _range(along)

        def make(value: float) -> Mechanism:
            more = {**overrides, path: f"{value!r} {unit}" if unit else value}
            return load(scene_path(scene), overrides=more, limits=limits).mechanism

        label = f"{path} [{unit}]" if unit else path
        data, lines, files = _follow(make, (begin, end, count), at, stages, label, quantity,
                                     folder, console)
    if as_json:
        console.result_json({"status": "done", "exit_code": int(Exit.DONE),
                             "scene": mechanism.name, **data, "files": list(map(str, files))})
    else:
        console.say(*lines, *map(str, files))
    return Exit.DONE


Answer = tuple[dict[str, Any], list[str], list[Path]]
"""Data for JSON, lines for the terminal, files."""


# -- options -------------------------------------------------------------------------


def _starts(words: tuple[str, ...]) -> list[dict[str, float]]:
    """All combinations of the values of ``--from``."""
    from sandbox.values.numbers import number_from
    from sandbox.wording import WrongValueError

    given: dict[str, list[float]] = {}
    for word in words:
        path, equals, text = (part.strip() for part in word.partition("="))
        if not (path and equals and text):
            raise click.BadParameter(f"{word!r} is not of the form PATH=VALUE,VALUE",
                                     param_hint="--from")
        if path in given:
            raise click.BadParameter(f"{path!r} is given twice; write several values with "
                                     "commas", param_hint="--from")
        dimension = "angle" if path.endswith(".angle") else "length"
        try:
            given[path] = [number_from(_number(each), dimension, {}) for each in text.split(",")]
        except WrongValueError as error:
            raise click.BadParameter(f"{word!r}: {error}", param_hint="--from") from None
    if math.prod(map(len, given.values())) > MAX_STARTS:
        raise click.BadParameter(f"more than {MAX_STARTS} combinations", param_hint="--from")
    return [dict(zip(given, each, strict=True))
            for each in itertools.product(*given.values())] if given else []


def _number(text: str) -> float | str:
    try:
        return float(text)
    except ValueError:
        return text.strip()


def _range(along: str) -> tuple[str, float, float, str, int]:
    """Path, first and last value, their unit and the count of ``PATH=FROM:TO:COUNT``."""
    path, equals, text = along.partition("=")
    parts = text.split(":")
    found = [_VALUE.match(part) for part in parts]
    if not equals or len(parts) != 3 or not all(found) or not parts[2].strip().isdigit():
        raise click.BadParameter(f"{along!r} is not of the form PATH=FROM:TO:COUNT, as in "
                                 "parameters.pull=0:10:21 or 'parameters.pull=0 N:10 N:21'",
                                 param_hint="--along")
    (begin, one), (end, other) = (match.groups() for match in found[:2] if match)
    if one and other and one != other:
        raise click.BadParameter(f"{one!r} and {other!r} are two units", param_hint="--along")
    return path.strip(), float(begin), float(end), one or other or "", int(parts[2])


# -- equilibria ----------------------------------------------------------------------


def _find(
    mechanism: Mechanism, starts: list[dict[str, float]], at: float | None, stages: int | None,
    body: str | None, folder: Path, console: Console,
) -> Answer:
    from sandbox.engine.inspect_control import Checked
    from sandbox.equilibria.rest import known_body, quantities, rest
    from sandbox.picture.stills import save_picture

    if body is None:
        objects = [each.name for each in mechanism.bodies
                   if each.role == "object" and each.motion == "dynamic" and each.shapes]
        body = objects[0] if len(objects) == 1 else ""
    else:
        known_body(mechanism, body)
    with compilation_notices(console):
        found = rest(Checked(mechanism), at=at, starts=starts, stages=stages)
    rests, several = found.rests, len(found.rests) > 1
    stiffness = [_stiffness(each, body) for each in rests]
    data = {
        "rests": [{**_data(each), "stiffness": None if values is None else {
            "body": body, **dict(zip(STIFFNESS, map(_finite, values), strict=True))}}
            for each, values in zip(rests, stiffness, strict=True)],
        "failed": [{"from": start.removeprefix(" from "), "reason": why}
                   for start, why in found.failed],
        "remarks": list(found.remarks)}
    units: dict[str, str] = {}
    for each in rests:
        units |= quantities(each.recording)
    head = ["quantity", "unit", *(f"rest_{i}" for i in range(1, len(rests) + 1))]
    rows = [[name, unit, *(f"{each[name]:.12g}" for each in rests)] for name, unit in units.items()]
    whole = {"status": "done", "exit_code": int(Exit.DONE), "scene": mechanism.name, **data}
    files = _write_numbers(folder, whole, head, rows)
    for i, each in enumerate(rests, 1):
        files.append(folder / (f"rest_{i}.png" if several else "rest.png"))
        save_picture(_titled(each, i if several else 0), files[-1])
    return data, [*_lines(found), *_stiffness_lines(body, stiffness), *found.remarks,
                  *(f"no rest{start}: {why}" for start, why in found.failed)], files


def _data(rest: AtRest) -> dict[str, Any]:
    from sandbox.equilibria.rest import quantities

    return {"from": rest.start, "stability": rest.stability, "untold": rest.untold,
            "modes": [float(value) for value in rest.modes], "loose": list(rest.loose),
            "sticking": list(rest.sticking), "left": rest.left, "steps": rest.steps,
            "quantities": {name: {"value": _finite(rest[name]), "unit": unit}
                           for name, unit in quantities(rest.recording).items()}}


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _stiffness(rest: AtRest, body: str) -> list[float] | None:
    """Of a body, along x, y, in rotation and the least; None where it is unknown."""
    if not body or rest.untold:
        return None
    try:
        return [float(value) for value in rest.stiffness(body).stiffness()]
    except ArithmeticError:
        return None


def _titled(rest: AtRest, number: int) -> Recording:
    """A recording whose title has the number of several equilibria, and the stability."""
    from sandbox.recording.recording import Recording

    mechanism = rest.recording.mechanism
    stability = rest.stability if rest.stability != "not told" else ""
    if not number and stability != "unstable":
        return rest.recording
    words = ", ".join(filter(None, (f"rest {number}" if number else "", stability))).capitalize()
    title = f"{words}: {mechanism.title or mechanism.name}"
    return Recording(mechanism.model_copy(update={"title": title}), rest.recording.arrays,
                     rest.recording.info)


def _lines(found: RestFound) -> list[str]:
    """The stability of each equilibrium, then the numbers of all side by side."""
    from sandbox.equilibria.rest import quantities, verdict

    rests, lines = found.rests, []
    for i, each in enumerate(rests, 1):
        name = f"rest {i}" if len(rests) > 1 else "at rest"
        lines.append(f"{name}{f' (from {each.start})' if each.start else ''}: {verdict(each)}")
        if each.sticking:
            more = len(each.sticking) - 4
            names = ", ".join(each.sticking[:4]) + (f" and {more} more" if more > 0 else "")
            lines.append(f"  friction holds {names}: rest nearby, too; this is "
                         f"{'where it stuck from there' if each.start else 'that of a slow load'}")
    shown = rests[:MAX_COLUMNS]
    units: dict[str, str] = {}
    for each in shown:
        units |= quantities(each.recording)
    rows = [[name, unit, *(_shown(each[name]) for each in shown)] for name, unit in units.items()]
    rows.append(["left over", "N", *(f"{each.left:.2g}" for each in shown)])
    heads = [f"rest {i}" if len(rests) > 1 else "value" for i in range(1, len(shown) + 1)]
    lines += ["", *table(["quantity", "unit", *heads], rows, right="<<" + ">" * len(shown)), ""]
    if len(rests) > len(shown):
        lines.append(f"{len(rests) - len(shown)} more are in the files")
    return lines


def _shown(value: float) -> str:
    """A number in SI, without rounding errors about 0."""
    return f"{round(value, DIGITS) + 0.0:.6g}"


def _stiffness_lines(body: str, stiffness: list[list[float] | None]) -> list[str]:
    lines = []
    for i, each in enumerate(stiffness, 1):
        if each is not None:
            x, y, turn, least = ("rigid" if math.isinf(value) else f"{value:.5g} {unit}"
                                 for value, unit in zip(each, STIFFNESS.values(), strict=True))
            of = f" in rest {i}" if len(stiffness) > 1 else ""
            lines.append(f"stiffness of {body}{of}: {x} along x, {y} along y, {turn} in turn; "
                         f"{least} at least")
    return lines


def _write_numbers(
    folder: Path, data: dict[str, Any], head: Sequence[str], rows: Sequence[Sequence[str]],
) -> list[Path]:
    from sandbox.atomic_files import write_atomic

    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows([head, *rows])
    paths = [folder / "rest.json", folder / "rest.csv"]
    write_atomic(paths[0], json.dumps(data, indent=1, ensure_ascii=False, allow_nan=False) + "\n")
    write_atomic(paths[1], text.getvalue())
    return paths


# -- along a value -------------------------------------------------------------------


def _follow(
    make: Any, along: tuple[float, float, int], at: float | None, stages: int | None, label: str,
    quantity: str | None, folder: Path, console: Console,
) -> Answer:
    from sandbox.equilibria.branches import rest_along
    from sandbox.model.catalogue import Catalogue

    mechanism = make(along[0])
    if quantity is not None and quantity not in Catalogue(mechanism):
        raise click.BadParameter(f"{quantity!r} is no quantity of the scene; 'sandbox plot' lists "
                                 "those of a run", param_hint="--plot")
    when = Heartbeat()

    def on_point(points: int, value: float) -> None:
        if when.due():
            console.warn(f"{points} points of rest, now at {label} = {value:.6g}")

    with compilation_notices(console):
        branches = rest_along(make, *along, at=at, stages=stages, heard=on_point)
    return _branch_files(branches, folder, mechanism, label, quantity)


def _branch_files(
    branches: list[Branch], folder: Path, mechanism: Mechanism, label: str, quantity: str | None,
) -> Answer:
    import numpy as np

    from sandbox.equilibria.rest import quantities
    from sandbox.figure.sweeps import BranchCurve, save_branches

    stops = [stop for branch in branches for stop in branch.stops]
    quantity = quantity or _moving_most([stop.rest for stop in stops])
    unit = stops[0].rest.recording.unit(quantity)
    units = {quantity: unit}
    for stop in stops:
        units |= quantities(stop.rest.recording)
    data: dict[str, Any] = {
        "along": label, "quantity": quantity, "unit": unit,
        "branches": [{"ends": branch.ends, "points": [
            {"value": stop.value, "fold": stop.fold, **_data(stop.rest)} for stop in branch.stops]}
            for branch in branches]}
    head = ["branch", label, "stability", "fold", *(f"{name}_{of}" if of else name
                                                    for name, of in units.items())]
    rows = [[str(i), f"{stop.value:.12g}", stop.rest.stability, str(int(stop.fold)),
             *(f"{stop.rest[name]:.12g}" for name in units)]
            for i, branch in enumerate(branches, 1) for stop in branch.stops]
    files = [*_write_numbers(folder, data, head, rows), folder / "rest.png"]
    save_branches(files[-1], [BranchCurve(
        np.array([stop.value for stop in branch.stops]),
        np.array([stop.rest[quantity] for stop in branch.stops]),
        np.array([stop.rest.stability == "stable" for stop in branch.stops]),
        np.array([stop.fold for stop in branch.stops])) for branch in branches],
        title=f"Rest along {label.partition(' ')[0]}: {mechanism.title or mechanism.name}",
        along=label, quantity=quantity, unit=unit)
    lines = []
    for i, branch in enumerate(branches, 1):
        shown = [[_shown(stop.value), _shown(stop.rest[quantity]),
                  "fold" if stop.fold else stop.rest.stability] for stop in branch.stops]
        name = f"branch {i}" if len(branches) > 1 else "branch"
        lines += [f"{name}{f': {branch.ends}' if branch.ends else ''}",
                  *table([label, f"{quantity} [{unit}]", ""], shown, right=">>"), ""]
    return data, lines, files


def _moving_most(rests: list[AtRest]) -> str:
    """The angle or position that changes most; angles times the size of the mechanism."""
    from sandbox.equilibria.rest import places

    def change(name: str) -> float:
        values = [rest[name] for rest in rests]
        scale = rests[0].size if rests[0].recording.unit(name) == "rad" else 1.0
        return scale * (max(values) - min(values))

    return max(places(rests[0].recording), key=change)
