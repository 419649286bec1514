"""``sandbox rest``: where a scene comes to rest, without waiting for it."""

from __future__ import annotations

import itertools
import math
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sandbox.cli.check import refuse_blocking
from sandbox.cli.console import Console, Heartbeat, compilation_notices, table
from sandbox.cli.failures import Exit
from sandbox.cli.options import OUT, limit_option, override_option
from sandbox.cli.rest_files import branch_files, rest_data, rest_files
from sandbox.cli.runs import prepare
from sandbox.cli.scenes import complete_scene, load, scene_path

if TYPE_CHECKING:
    from sandbox.equilibria.branches import Branch
    from sandbox.equilibria.rest import AtRest, RestFound
    from sandbox.scene.mechanism import Mechanism
    from sandbox.scene.read.limits import Limits

RENDERS = Path("renders") / "rest"
MOST_STARTS = 200
"""Combinations of the values of ``--from``."""
MOST_COLUMNS = 5
"""Equilibria side by side in the terminal; files have all."""
ROUNDED = 10
"""Places after the point that the terminal shows, at most [m, rad, N]."""
_VALUE = re.compile(r"^\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*([^\s\d.].*?)?\s*$")


@click.command()
@click.argument("scene", shell_complete=complete_scene)
@click.option("--from", "starts", multiple=True, metavar="PATH=VALUES",
              help="Begin there in place of the scene's own pose: JOINT.angle, BODY.x, BODY.y or "
                   "BODY.angle, values apart by commas, as in 'arm.angle=-30 deg,0,30 deg'. "
                   "Several options: all combinations.")
@click.option("--at", type=float, metavar="SECONDS",
              help="Drives have the values of this time; by default the end of the scene.")
@click.option("--stages", type=click.IntRange(min=1), metavar="N",
              help="In how many the drives go there from their first values; by default 40, with "
                   "dry friction 200.")
@click.option("--along", metavar="PATH=FROM:TO:COUNT",
              help="Follow rest along a value of the scene, as in 'parameters.pull=0:10:21'.")
@click.option("--plot", "quantity", metavar="QUANTITY",
              help="With --along, what is drawn over it; by default what moves most.")
@click.option("--body", metavar="NAME", help="Whose stiffness is told; by default the one body "
              "with the role 'object' that moves freely.")
@click.option("--out", type=OUT, metavar="DIR",
              help="Where rest.json, rest.csv and rest.png go; renders/rest/SCENE by default.")
@override_option
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object and nothing else.")
@click.option("--quiet", "-q", is_flag=True, help="Print errors only.")
@limit_option
def rest(
    scene: str, starts: tuple[str, ...], at: float | None, stages: int | None, along: str | None,
    quantity: str | None, body: str | None, out: Path | None, overrides: dict[str, Any],
    as_json: bool, quiet: bool, limits: Limits,
) -> int:
    """Find where SCENE comes to rest, and whether it stays there.

    The drives go slowly to the values that they have at the end of the scene,
    or with --from stand there from the start; dampers are not waited for. Tells
    poses, tensions and contact forces at rest, what is left of all forces, how
    fast a small push dies or grows, and how stiffly an object is held. What can
    not rest is refused, and why is said.
    """
    from sandbox.engine.inspect import inspect

    loaded = load(scene_path(scene), overrides=overrides, limits=limits)
    mechanism = loaded.mechanism
    refuse_blocking(inspect(mechanism), loaded)
    console = Console(as_json=as_json, quiet=quiet)
    _go_together(starts, along, quantity, body)
    folder = out or RENDERS / (mechanism.name or "scene")
    prepare(folder)
    if along is not None:
        return _follow(scene, along, overrides, limits, console,
                       at=at, stages=stages, quantity=quantity, folder=folder)
    from sandbox.engine.inspect_control import Checked
    from sandbox.equilibria.rest import known_body
    from sandbox.equilibria.rest import rest as find

    if body is not None:
        known_body(mechanism, body)
    with compilation_notices(console):
        found = find(Checked(mechanism), at=at, starts=_starts(starts), stages=stages)
    body = body or _held(mechanism)
    stiff = [_stiffness(each, body) for each in found.rests]
    data = {"status": "done", "exit_code": int(Exit.DONE), "scene": mechanism.name,
            **rest_data(found, body, stiff)}
    files = rest_files(found, data, folder, mechanism)
    if as_json:
        console.result_json({**data, "files": [str(file) for file in files]})
        return Exit.DONE
    console.say(*_told(found), *_stiffness_lines(body, stiff), *_remarks(found), *map(str, files))
    return Exit.DONE


def _go_together(
    starts: tuple[str, ...], along: str | None, quantity: str | None, body: str | None,
) -> None:
    """See that no option is given that another one makes meaningless.

    Raises:
        UsageError: one is.
    """
    if along is not None and starts:
        raise click.UsageError("--along begins at the scene's own pose; --from can't go with it.")
    if along is not None and body is not None:
        raise click.UsageError("--body tells the stiffness at one rest; --along can't go with it.")
    if along is None and quantity is not None:
        raise click.UsageError("--plot says what --along draws, and there is no --along.")


def _follow(
    scene: str, along: str, overrides: dict[str, Any], limits: Limits, console: Console, *,
    at: float | None, stages: int | None, quantity: str | None, folder: Path,
) -> int:
    """``--along``."""
    from sandbox.equilibria.branches import rest_along
    from sandbox.model.catalogue import Catalogue

    path, begin, end, unit, count = _range(along)

    def make(value: float) -> Mechanism:
        more = {**overrides, path: f"{value!r} {unit}" if unit else value}
        return load(scene_path(scene), overrides=more, limits=limits).mechanism

    mechanism = make(begin)
    if quantity is not None and quantity not in Catalogue(mechanism):
        raise click.BadParameter(f"{quantity!r} is no quantity of the scene; 'sandbox plot' lists "
                                 "those of a run", param_hint="--plot")
    when = Heartbeat()

    def heard(points: int, value: float) -> None:
        if when.due():
            console.warn(f"{points} points of rest, now at {path} = {value:.6g} {unit}".rstrip())

    with compilation_notices(console):
        branches = rest_along(make, begin, end, count, at=at, stages=stages, heard=heard)
    label = f"{path} [{unit}]" if unit else path
    data, files = branch_files(branches, folder, mechanism, label, quantity)
    if console.as_json:
        console.result_json({"status": "done", "exit_code": int(Exit.DONE),
                             "scene": mechanism.name, **data,
                             "files": [str(file) for file in files]})
        return Exit.DONE
    console.say(*_branch_lines(branches, label, data["quantity"], data["unit"]),
                *map(str, files))
    return Exit.DONE


def _starts(words: tuple[str, ...]) -> list[dict[str, float]]:
    """All combinations of what ``--from`` gives."""
    from sandbox.scene.values.numbers import number_from
    from sandbox.wording import WrongValueError

    given: dict[str, list[float]] = {}
    for word in words:
        path, equals, text = word.partition("=")
        if not equals or not path.strip() or not text.strip():
            raise click.BadParameter(f"{word!r} is not of the form PATH=VALUE,VALUE",
                                     param_hint="--from")
        if path.strip() in given:
            raise click.BadParameter(f"{path.strip()!r} is given twice; several values stand apart "
                                     "by commas", param_hint="--from")
        dimension = "angle" if path.strip().endswith(".angle") else "length"
        try:
            given[path.strip()] = [number_from(_number(each), dimension, {})
                                   for each in text.split(",")]
        except WrongValueError as error:
            raise click.BadParameter(f"{word!r}: {error}", param_hint="--from") from None
    if math.prod(map(len, given.values())) > MOST_STARTS:
        raise click.BadParameter(f"more than {MOST_STARTS} combinations", param_hint="--from")
    return [dict(zip(given, each, strict=True)) for each in itertools.product(*given.values())
            ] if given else []


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


def _held(mechanism: Mechanism) -> str:
    """The one object that moves freely; empty without one."""
    found = [body.name for body in mechanism.bodies
             if body.role == "object" and body.motion == "dynamic" and body.shapes]
    return found[0] if len(found) == 1 else ""


def _stiffness(rest: AtRest, body: str) -> list[float] | None:
    """Of a body, along x, y, in turn and the least; None where it is not told."""
    if not body or rest.untold:
        return None
    try:
        return [float(value) for value in rest.stiffness(body).stiffness()]
    except ArithmeticError:
        return None


def _told(found: RestFound) -> list[str]:
    """Each equilibrium in a sentence, then the numbers of all, side by side."""
    from sandbox.equilibria.told import quantities, verdict

    rests, lines = found.rests, []
    for i, each in enumerate(rests, 1):
        name = f"rest {i}" if len(rests) > 1 else "at rest"
        lines.append(f"{name}{f' (from {each.start})' if each.start else ''}: {verdict(each)}")
        if each.sticking:
            lines.append(f"  friction holds {_few(each.sticking)}: rest nearby, too; this is "
                         f"{'where it stuck from there' if each.start else 'that of a slow load'}")
    shown = rests[:MOST_COLUMNS]
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
    """A number in SI; what rounding leaves of none is none."""
    return f"{round(value, ROUNDED) + 0.0:.6g}"


def _few(names: tuple[str, ...], most: int = 4) -> str:
    more = len(names) - most
    return ", ".join(names[:most]) + (f" and {more} more" if more > 0 else "")


def _stiffness_lines(body: str, stiff: list[list[float] | None]) -> list[str]:
    lines = []
    for i, each in enumerate(stiff, 1):
        if each is not None:
            x, y, turn, least = (
                "rigid" if math.isinf(value) else f"{value:.5g} {unit}"
                for value, unit in zip(each, ("N/m", "N/m", "N m/rad", "N/m"), strict=True))
            of = f" in rest {i}" if len(stiff) > 1 else ""
            lines.append(f"stiffness of {body}{of}: {x} along x, {y} along y, {turn} in turn; "
                         f"{least} at least")
    return lines


def _remarks(found: RestFound) -> list[str]:
    return [*found.remarks, *(f"no rest{words}: {why}" for words, why in found.failed)]


def _branch_lines(
    branches: list[Branch], label: str, quantity: str, unit: str,
) -> list[str]:
    """Every point of every branch."""
    lines = []
    for i, branch in enumerate(branches, 1):
        rows = [[_shown(stop.value), _shown(stop.rest[quantity]),
                 "fold" if stop.fold else stop.rest.stability] for stop in branch.stops]
        head = f"branch {i}" if len(branches) > 1 else "branch"
        lines += [f"{head}{f': {branch.ends}' if branch.ends else ''}",
                  *table([label, f"{quantity} [{unit}]", ""], rows, right=">>"), ""]
    return lines
