"""``sandbox push``: how hard an object that is held can be pushed before it moves."""

from __future__ import annotations

import csv
import io
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sandbox.cli.compiling import compilation_notices
from sandbox.cli.console import Console, table
from sandbox.cli.exits import Exit
from sandbox.cli.inspection import refuse_blocking
from sandbox.cli.options import (
    OUT,
    chosen_limits,
    limit_options,
    override_option,
    read_length,
)
from sandbox.cli.output import prepare
from sandbox.cli.progress import Progress
from sandbox.cli.scenes import complete_scene, load, scene_path

if TYPE_CHECKING:
    from sandbox.numeric import Array, Flags
    from sandbox.scene.mechanism import Mechanism
    from sandbox.study.push import Pushes

RENDERS = Path("renders") / "studies" / "push"
NOTED = 0.02
"""More than this share above the bound is explained."""
ALIKE = 1e-3
"""Forces that differ by a smaller share are one and the same to a reader."""
LEAST = 1e-6
"""No smaller way is advised to look for [m]."""
COLUMNS = ("direction_deg", "bound_N", "moved_at_N", "pushed_to_N")


@click.command()
@click.argument("scene", shell_complete=complete_scene)
@click.option("--body", metavar="NAME", help="What is pushed; by default the one body with the "
              "role 'object' that moves freely.")
@click.option("--at", type=float, metavar="SECONDS",
              help="From when on; by default the end of the scene.")
@click.option("--over", type=click.FloatRange(0, min_open=True), default=2.0, show_default=True,
              metavar="SECONDS", help="How long a push grows evenly, then to twice as much each "
              "time.")
@click.option("--directions", type=click.IntRange(1, 360), default=12, show_default=True,
              help="How many, evenly round.")
@click.option("--limit", metavar="LENGTH", callback=read_length,
              help="How far it may come, as 2mm; by default a hundredth of its size.")
@click.option("--beyond", type=click.FloatRange(1, min_open=True), default=8, show_default=True,
              metavar="TIMES", help="Up to how many times the bound it is pushed.")
@click.option("--out", type=OUT, metavar="DIR",
              help="Where push.csv and push.png go; renders/studies/push/SCENE by default.")
@override_option
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object and nothing else.")
@click.option("--quiet", "-q", is_flag=True, help="Print errors only.")
@limit_options
def push(
    scene: str, body: str | None, at: float | None, over: float, directions: int,
    limit: float | None, beyond: float, out: Path | None, overrides: dict[str, Any],
    as_json: bool, quiet: bool, **limits: Any,
) -> int:
    """Push an object in SCENE until it moves, in many directions.

    Simulations for each direction: a force at its centre of mass that grows from
    a time on, more and more slowly until two paces tell the same, while all else
    goes on as the scene has it; forces on it by the scene's own drives stay as
    they are then. Beside what is found stands the bound: the largest push that
    any forces of contacts and joints could balance with all where it is then.
    From there on it gives, by however little.
    """
    from sandbox.engine.inspect import inspect
    from sandbox.study.push import pushes

    loaded = load(scene_path(scene), overrides=overrides, limits=limits)
    mechanism = loaded.mechanism
    refuse_blocking(inspect(mechanism), loaded)
    chosen_limits(limits)
    if limit == 0:
        raise click.BadParameter("must be greater than 0", param_hint="--limit")
    console = Console(as_json=as_json, quiet=quiet)
    instant = mechanism.run.duration if at is None else at
    if not 0 < instant <= mechanism.run.duration:
        raise click.BadParameter(
            f"{instant:g} s is not within the run, from its start to {mechanism.run.duration:g} s",
            param_hint="--at")
    body = body or _held(mechanism)
    folder = out or RENDERS / (mechanism.name or "scene")
    prepare(folder)
    with (compilation_notices(console),
          Progress("push", shown=console.shows_progress) as progress):
        found = pushes(mechanism, body, at=instant, over=over, count=directions, limit=limit,
                       beyond=beyond, progress=progress)
    files = _save(found, folder, mechanism)
    if as_json:
        console.result_json({"status": "done", "exit_code": int(Exit.DONE), "scene":
                             mechanism.name, **_data(found), "files": [str(f) for f in files]})
        return Exit.DONE
    console.say(*_table(found), "", *_least(found), *_remarks(found), *map(str, files))
    return Exit.DONE


def _held(mechanism: Mechanism) -> str:
    """The one object that a hand can hold.

    Raises:
        BadParameter: none, or several.
    """
    found = [body.name for body in mechanism.bodies
             if body.role == "object" and body.motion == "dynamic" and body.shapes]
    if len(found) != 1:
        which = f"one of {', '.join(found)}" if found else "a body that moves freely"
        raise click.BadParameter(
            f"the scene has {len(found) or 'no'} bodies with the role 'object' that move freely; "
            f"name {which}.", param_hint="--body")
    return found[0]


def _rows(found: Pushes) -> list[tuple[float, float, float, float]]:
    return [(math.degrees(angle), float(bound), float(force), float(most))
            for angle, bound, force, most in zip(
                found.directions, found.bound, found.found, found.most, strict=True)]


def _table(found: Pushes) -> list[str]:
    rows = [[f"{angle:.4g}", _shown(bound), f"{force:.4g}" if math.isfinite(force)
             else f"not up to {most:.4g}"] for angle, bound, force, most in _rows(found)]
    return table(["push along [deg]", "bound [N]", f"moved by {_mm(found.limit)} at [N]"], rows,
                 right="<>>")


def _mm(way: float) -> str:
    return f"{1e3 * way:.4g} mm"


def _shown(bound: float) -> str:
    return "none" if math.isinf(bound) else "not at rest" if math.isnan(bound) else f"{bound:.4g}"


def _along(found: Pushes, forces: Array) -> str:
    """The least of some forces, and along which direction, the first of those that are alike."""
    import numpy as np

    least = float(forces.min())
    angle = math.degrees(found.directions[np.argmax(forces <= (1 + ALIKE) * least)])
    return f"{least:.4g} N, along {angle:.4g} deg"


def _least(found: Pushes) -> list[str]:
    """When it gives, and when it has come as far as the limit."""
    import numpy as np

    told, bound = [], np.where(np.isnan(found.bound), np.inf, found.bound)
    if (bound == 0).any():
        told.append(f"{found.body} gives to any push along {_degrees(found, bound == 0)} deg")
    elif np.isfinite(bound).any():
        told.append(f"{found.body} gives first at {_along(found, bound)} (bound)")
    if np.isinf(found.found).all():
        told.append(f"{found.body} has not moved by {_mm(found.limit)} under any push")
    else:
        told.append(f"{found.body} has moved by {_mm(found.limit)} first at "
                    f"{_along(found, found.found)}, from t = {found.at:.6g} s on")
    return told


def _remarks(found: Pushes) -> list[str]:
    """What a reader of the table should know of it."""
    import numpy as np

    from sandbox.study.push import AGREE

    remarks = []
    if not found.held:
        remarks.append(f"no hand holds {found.body} at t = {found.at:.6g} s: what is told is how "
                       "it rests on all that touches it")
    remarks += [f"drive {name!r}, which pushes {found.body} and changes from {since:.3g} s on, "
                f"stays at {force:.4g} N here" for name, since, force in found.own.stayed]
    if found.own.way > found.limit:
        remarks.append(f"{found.body} moves by {_mm(found.own.way)} in {found.own.lasts:.4g} s "
                       "without a push: what is told is how far it is from there at the same "
                       f"time, the bound is that of t = {found.at:.6g} s")
    if not found.settled.all():
        remarks.append(f"along {_degrees(found, ~found.settled)} deg a slower push tells another "
                       f"force, by more than {100 * AGREE:g} %: it lags, or moves at any push that "
                       "lasts; a larger --over tells more")
    if np.isinf(found.found).any():
        remarks.append("'not up to' is where the search ended; --beyond looks further")
    if np.isinf(found.bound).any():
        remarks += [f"'none': {one!r} and {other!r} touch with several normals, of which the sum "
                    "alone is known, and are taken to carry anything; a body for each shape that "
                    "touches has a bound" for one, other in found.blurred]
    bounded = np.isfinite(found.bound) & np.isfinite(found.found) & (found.bound > 0)
    above = float((found.found[bounded] / found.bound[bounded]).max(initial=1.0)) - 1
    if above > NOTED:
        smaller = max(LEAST, found.limit / 100)
        remarks.append(
            f"up to {100 * above:.0f} % above the bound: from the bound on {found.body} gives, and "
            "what holds it may tighten on the way to the limit"
            + (f"; --limit {smaller:.2g} tells when it begins to" if smaller < found.limit else ""))
    return remarks


def _degrees(found: Pushes, which: Flags) -> str:
    return ", ".join(f"{math.degrees(angle):.4g}" for angle in found.directions[which])


def _data(found: Pushes) -> dict[str, Any]:
    return {"body": found.body, "at": found.at, "held": found.held, "limit": found.limit,
            "own": {"stayed": [dict(zip(("drive", "from", "at"), each, strict=True))
                               for each in found.own.stayed],
                    "way": found.own.way, "lasts": found.own.lasts},
            "blurred": found.blurred, "pushes": [
        dict(zip(("direction", "bound", "moved_at", "pushed_to", "settled"), (
            angle, *(each if math.isfinite(each) else None for each in forces), settled),
            strict=True))
        for angle, settled, (_, *forces) in zip(
            found.directions.tolist(), found.settled.tolist(), _rows(found), strict=True)]}


def _save(found: Pushes, folder: Path, mechanism: Mechanism) -> list[Path]:
    """The table and the picture; their paths."""
    from sandbox.atomic_files import write_atomic
    from sandbox.draw.figure.polar import save_pushes

    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    writer.writerows([f"{value:.9g}" for value in row] for row in _rows(found))
    paths = [folder / "push.csv", folder / "push.png"]
    write_atomic(paths[0], text.getvalue())
    save_pushes(paths[1], title=f"Pushes of {found.body}: {mechanism.title or mechanism.name}",
                around=found.around, bounds=found.bounds, directions=found.directions,
                found=found.found, most=found.most, limit=f"{1e3 * found.limit:.3g} mm")
    return paths
