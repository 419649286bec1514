"""The commands, their arguments and options.

The function of a command has its name and stands in another module of this package, which is
imported when the command runs.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sandbox.cli.commands import Commands, commands
from sandbox.cli.options import NAMES, PICTURES, title_of
from sandbox.cli.readers import (
    read_along,
    read_length,
    read_limits,
    read_overrides,
    read_pairs,
    read_quantity,
    read_size,
    read_starts,
    read_workers,
)
from sandbox.errors import SandboxError

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem

DESIGNS = ("grid", "paired", "latin_hypercube", "sobol", "halton", "random")


class _Out(click.Path):
    """A file or directory to write. An empty text is no path, though Python takes it for ``.``."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        if not os.fspath(value).strip():
            self.fail("the path is empty; '.' is the directory that you are in.", param, ctx)
        return super().convert(value, param, ctx)


OUT = _Out(path_type=Path)  # type of every option ``--out``


def _read_elements(ctx: click.Context, param: click.Parameter, paths: Sequence[Path]) -> None:
    """Register the elements of files while the command runs."""
    if paths:
        from sandbox.scene.document import load_elements
        for path in paths:
            ctx.call_on_close(load_elements(path))


def complete_scene(_ctx: object, _param: object, incomplete: str) -> list[CompletionItem]:
    """Complete the names of shipped scenes, and files."""
    from click.shell_completion import CompletionItem

    from sandbox.scene.library import shipped_scenes
    named = [CompletionItem(name, help=title_of(path)) for name, path in shipped_scenes().items()
             if name.startswith(incomplete)]
    return [*named, CompletionItem(incomplete, type="file")]


def option(*names: str, read: Callable[[Any], Any] | None = None, **settings: Any) -> click.Option:
    """An option of a command; ``read`` converts the words, and its errors name the option."""
    def convert(ctx: click.Context, param: click.Parameter, value: Any) -> Any:
        try:
            return value if value is None or read is None else read(value)
        except (ValueError, SandboxError) as error:
            raise click.BadParameter(str(error), ctx, param) from error

    return click.Option(names, **{"callback": read and convert, **settings})


def files(suffixes: Sequence[str], help_text: str) -> click.Option:
    """A repeatable option ``--out FILE`` that accepts some suffixes."""
    def read(paths: tuple[Path, ...]) -> tuple[Path, ...]:
        for path in paths:
            if path.suffix.lower() not in suffixes:
                raise ValueError(f"{str(path)!r} does not end in one of {', '.join(suffixes)}")
        return paths

    return option("--out", "files", multiple=True, type=OUT, metavar="FILE", read=read,
                  help=help_text)


RUN = click.Argument(["run"])
LIMIT = option(
    "--limit", "limits", multiple=True, metavar="NAME=VALUE", read=read_limits,
    help="Change a limit, as in 'steps=5e6'; 'sandbox explain limits' lists them. Repeatable.")
ELEMENTS = option(
    "--elements", multiple=True, metavar="FILE", is_eager=True,
    type=click.Path(exists=True, dir_okay=False, path_type=Path), callback=_read_elements,
    expose_value=False,
    help="Run a Python file that registers elements of your own. Repeatable.")
CHANGES = (option(
    "--set", "overrides", multiple=True, metavar="PATH=VALUE", read=read_overrides,
    help="Change the scene, as in 'parameters.pull=20 N' or 'run.step=1e-3'. Repeatable."),
    ELEMENTS, LIMIT)
SCENE = (click.Argument(["scene"], shell_complete=complete_scene), *CHANGES)
JSON = option("--json", "as_json", is_flag=True, help="Print one JSON object and nothing else.")
QUIET = option("--quiet", "-q", is_flag=True, help="Print errors only.")


class _Searches(Commands):
    """Runs the search of a study file, too."""

    noun = "search"

    def resolve_command(
        self, ctx: click.Context, args: list[str],
    ) -> tuple[str | None, click.Command | None, list[str]]:
        if args[0] not in self.commands and args[0].endswith(".json"):
            from sandbox.cli.sweep import kind_of
            if not (kind := kind_of(args[0])):
                raise click.UsageError(
                    f"{args[0]} is not a search: write 'sandbox search optimize {args[0]}', or add "
                    f"a key \"search\" to the study file ({', '.join(self.commands)}).", ctx)
            name = NAMES.get(kind, kind)
            return name, self.commands[name], args
        return super().resolve_command(ctx, args)


start, simulate, results, questions, exchange = (
    partial(commands.add, section)
    for section in ("Start", "Simulate", "Results", "Questions", "Exchange"))

start("list", "scenes:list_scenes", "List the scenes that come with sandbox, by topic.", JSON)
start("new", "scenes", """Copy the shipped scene NAME, to start from.

    Included scenes and drawings are copied beside it. Nothing is overwritten.
    """,
    click.Argument(["name"], shell_complete=complete_scene),
    option("--out", type=OUT, metavar="FILE",
           help="File or directory to write to; NAME.json by default."))
start("check", "check", """Validate scenes, and estimate the cost of a run.

    First checks the keys, units, ranges and names of elements. If they are right, looks for unknown
    quantities, joints that are not assembled, bodies that overlap, tendon guides that coincide,
    springs and dampers too strong for the step, and springs that can snap over centre. Exits 2 if a
    scene cannot be run; with --strict on warnings, too.
    """,
    click.Argument(["scenes"], metavar="SCENE...", nargs=-1, shell_complete=complete_scene),
    option("--strict", is_flag=True, help="Let warnings fail the check."),
    option("--expand", is_flag=True,
           help="Print the one SCENE as plain elements, a scene, too."),
    option("--schema", is_flag=False, flag_value="scene", metavar="[KIND]",
           type=click.Choice(["scene", "study"]),
           help="Print the JSON Schema of scenes, for editors; 'study' for that of study files."),
    *CHANGES, JSON)
start("explain", "explain", """Explain an element, a field, a quantity or a message.

    NAME is an element such as pin or drives.motor, a list such as joints, a block such as run,
    expect or finger, a field, a quantity such as tension, a consistency check, the code of a
    message, a shipped scene, or limits, layers or functions. Prints fields with units and defaults,
    an example, and the recorded quantities. Without NAME lists all by topic.
    """, click.Argument(["names"], nargs=-1, metavar="[NAME]..."), ELEMENTS)

simulate("run", "run", """Simulate SCENE, write results, check expectations.

    SCENE is a JSON file, or the name of a scene that 'sandbox list' shows. Writes run.json,
    run.npz, the CSV logs and animation.gif into DIR. Prints the expectations of the scene that
    passed and failed, and the warnings of the consistency checks. Exits 1 if an expectation failed.
    """,
    option("--out", type=OUT, metavar="DIR", help="Directory; renders/NAME by default."),
    option("--solver", type=click.Choice(["direct", "pymunk"]), help="By default the scene's."),
    option("--no-render", is_flag=True, help="Numbers only, no pictures."),
    option("--format", "animation", type=click.Choice(["gif", "mp4"]), default="gif",
           show_default=True, help="Of the animation."),
    option("--report", "writes_page", is_flag=True, help="Also write report.html."),
    option("--audit", "lists_checks", is_flag=True, help="List all consistency checks."),
    *SCENE, JSON, QUIET)
simulate("view", "view", """Open SCENE in the browser: run, pause, pull bodies, move sliders.

    Serves a page on this machine only, until Ctrl-C. The scene is reloaded when its file is saved.
    A session can be saved as a scene that reproduces it exactly. Needs the extra 'view'.
    """,
    option("--port", type=click.IntRange(0, 65535), default=0, metavar="N",
           help="Port of the page; by default a free one."),
    option("--no-browser", is_flag=True, help="Only print the address."),
    *SCENE)

results("plot", "plot", """List or plot the quantities of a saved run, or compare runs.

    RUN is the directory of a run, or the name of a scene whose run lies in renders/. A QUANTITY is
    a name such as finger.mcp.angle, or a pattern such as 'finger.*.angle'; without any, the
    quantities of the run are listed. --with compares runs, by default in the quantities that
    controllers lead to targets, and prints overshoot, settling time, errors and effort. Nothing is
    simulated.
    """,
    RUN,
    click.Argument(["quantities"], nargs=-1, metavar="[QUANTITY]..."),
    option("--with", "others", multiple=True, metavar="RUN",
           help="Another run in the same figure, in another colour. Repeatable."),
    option("--target", "targets", multiple=True, metavar="QUANTITY=VALUE",
           read=partial(read_pairs, form="quantity=value"),
           help="Target, as in 'finger.mcp.angle=5deg'; by default the controller's. Repeatable."),
    option("--x", "across", metavar="QUANTITY", default="", help="Horizontal axis, not time."),
    option("--from", "begin", metavar="TIME", read=partial(read_quantity, dimension="time"),
           help="Start of the plot, as in '0.5s'; that of the run by default."),
    option("--to", "end", metavar="TIME", read=partial(read_quantity, dimension="time"),
           help="End, likewise."),
    option("--width", metavar="LENGTH", read=read_length,
           help="Width of the figure on paper, as in '85mm'; 120 mm by default."),
    option("--no-title", "untitled", is_flag=True, help="Omit the scene's title."),
    files((*PICTURES, ".csv"), "A figure (.png, .svg, .pdf) or the table of responses (.csv); "
                               "plot.png in RUN by default. Repeatable."),
    JSON, QUIET)
results("render", "runs", """Draw a saved run as an animation or as stills.

    RUN is the directory of a run, or the name of its scene. Nothing is simulated.
    """,
    RUN,
    option("--out", "outs", type=OUT, multiple=True, metavar="FILE",
           help="A .gif or .mp4 film, a .png, .svg or .pdf still, or a directory for PNG frames; "
                "RUN/animation.gif by default. Repeatable."),
    option("--format", "ending", type=click.Choice(["gif", "mp4", "png", "svg", "pdf"]),
           help="Of the file in RUN that is written without --out; gif or png by default."),
    option("--at", multiple=True, metavar="TIME",
           help="Draw a still at a time: '0.8s', 'start' or 'end'. Repeatable."),
    option("--strip", is_flag=False, flag_value=0, type=click.IntRange(min=0), metavar="[N]",
           help="Draw N moments side by side (5 without N), or those of --at."),
    option("--size", read=read_size, metavar="WxH",
           help="Pixels of the picture; '2x' for twice the size of the scene's view; of a still on "
                "paper '85mm' or '85mmx70mm'."),
    option("--labels", type=click.Choice(["all", "scales", "none"]), default="all",
           show_default=True, help="All of title, time and legend, or only scales."),
    option("--transparent", is_flag=True, help="Transparent background, except of MP4."),
    option("--show", metavar="LAYERS",
           help="More layers, as in 'traces,velocity'; '-contacts' hides one; 'all'."),
    option("--follow", metavar="BODY", help="Body that the view follows."),
    option("--fit", "bodies", multiple=True, metavar="BODY",
           help="Bodies or groups that the view is fitted to, as in 'finger*'. Repeatable."),
    option("--fps", type=click.Choice(["20", "25", "50"]),
           help="Frames per second; the view's by default."),
    option("--speed", type=click.FloatRange(min=0, min_open=True), metavar="FACTOR",
           help="Seconds of motion per second of film; the view's by default."),
    LIMIT, QUIET)
results("report", "runs", """Write one HTML page that plays up to four runs.

    RUN is the directory of a run, or the name of a scene whose run lies in renders/. The page works
    offline in any browser. Nothing is simulated.
    """,
    click.Argument(["runs"], nargs=-1, required=True, metavar="RUN..."),
    option("--out", type=OUT, metavar="FILE",
           help="The page; report.html in the first run's directory by default."),
    option("--plot", "plots", multiple=True, metavar="QUANTITY",
           help="Quantities to plot first, as in 'finger.*.angle'; by default the meters, then the "
                "expected quantities. Repeatable."),
    JSON, QUIET)

KEEP = option(
    "--keep", multiple=True, metavar="RESULT",
    help="A result of each run: 'max disc.x over last 0.2 s', 'tip=final tip.x', 'ratio==tip / "
         "pull', a quantity for its last value. By default those of the expectations.")
WHERE = option("--where", multiple=True, metavar="CONDITION",
               help="A condition on results: 'slip < 1 mm'. Several must all hold.")
SEED = option("--seed", type=click.IntRange(min=0), default=0, show_default=True,
              help="Of random points.")
WORKERS = option("--workers", metavar="N|ADDRESS", default="", read=read_workers,
                 help="Processes, by default one per processor; or a Dask scheduler.")


def study(values: str, directory: str, *own: click.Parameter) -> tuple[click.Parameter, ...]:
    """The parameters of a sweep or search, with its ``own``."""
    return (SCENE[0],
            option("--vary", multiple=True, metavar="PATH=VALUES",
                   read=partial(read_pairs, form="path=values"), help=values),
            *own, option("--out", type=OUT, metavar="DIR", help=directory), WORKERS,
            *CHANGES, JSON, QUIET)


questions("sweep", "sweep", """Run SCENE many times with values varied.

    SCENE is a scene, or a study file that defines what is varied and kept. Writes table.csv (and
    table.parquet where pyarrow is installed) with a row for each run, and sweep.png; of a grid of
    two paths a map. Finished runs are not repeated: the same command resumes an interrupted sweep.
    """, *study(
        "Values of a path: from:to:count, as in 'parameters.pull=2 N:8 N:7', with ':log' even "
        "ratios; a list, '1,2,5'; a distribution, 'normal(3 N, 0.2 N)'; from:to, of designs with a "
        "count. Several make a grid.",
        "Directory of the table, and of finished runs; sweeps/NAME by default.",
        KEEP,
        option("--design", type=click.Choice(DESIGNS), help="Arrangement of the points; a grid by "
               "default, random where there is a distribution, else latin_hypercube."),
        option("--count", type=click.IntRange(min=1), metavar="N",
               help="Number of points, of designs other than grid and paired."),
        SEED),
    option("--recordings", is_flag=True, help="Keep the whole recording of each run, too."),
    option("--no-audit", is_flag=True, help="Do not audit runs; this halves the time."),
    option("--again", is_flag=True, help="Repeat finished runs."))


@click.group(cls=_Searches, invoke_without_command=True)
@click.pass_context
def search(ctx: click.Context) -> None:
    """Find thresholds, fits, optima or sensitivities.

    SCENE is a scene, or a study file that defines what is varied and kept; if it has a key
    "search", 'sandbox search STUDY.json' runs that. Finished runs are not repeated: the same
    command resumes an interrupted search. The result is checked by runs at half the time step.
    """
    if ctx.invoked_subcommand is None:
        raise click.UsageError(f"Say which search: {', '.join(search.list_commands(ctx))}.", ctx)


def _search(kind: str, help_text: str, *own: click.Parameter) -> None:
    """Add a search, by its name in a study file."""
    search.add("Commands", NAMES.get(kind, kind), "sweep:search", help_text, *study(
        "Values of a path: a range, 'parameters.pull=2 N:8 N', with ':log' for even ratios; a list "
        "or a distribution, 'normal(3 N, 0.2 N)', where the search takes them.",
        "Directory of the results and finished runs; by default searches/KIND/NAME, with a number "
        "for another question.", *own), kind=kind)


_search("fit", """The values with which the scene reproduces a measurement.

    With 95 % intervals, and the directions that the data do not determine.
    """,
    option("--data", type=click.Path(path_type=Path), metavar="FILE.csv",
           help="Columns 'time' [s], and quantities in SI or as in 'x [mm]'."),
    option("--match", multiple=True, metavar="COLUMN=QUANTITY",
           read=partial(read_pairs, form="column=quantity"),
           help="Quantity of a column, as in 'x=puck.x'; its name by default."),
    option("--noise", multiple=True, metavar="COLUMN=SIZE", read=lambda words: {
        name: read_quantity(text) for name, text in read_pairs(words, "column=size").items()},
           help="Standard deviation, as in 'x=0.5 mm'; estimated by default."))
_search("best", "The values that minimise or maximise results.",
    KEEP,
    option("--minimize", "least", multiple=True, metavar="NAME",
           help="A result to minimise. Several goals have several solutions."),
    option("--maximize", "most", multiple=True, metavar="NAME", help="A result to maximise."),
    WHERE,
    option("--sampler", metavar="NAME",
           help="cmaes (the default for one goal over ranges), tpe (with conditions or lists), gp, "
                "nsga2 (for several goals), random."),
    option("--runs", type=click.IntRange(min=1), default=200, show_default=True,
           help="Number of runs; more continue the search."),
    SEED)
_search("sensitivity", "The influence of each path on each result.",
    KEEP,
    option("--method", metavar="NAME", default="sobol", show_default=True,
           help="sobol (shares of the variance) or morris (screening)."),
    option("--count", type=click.IntRange(min=1), default=64, show_default=True,
           help="Base points, a power of 2, each with a run per path and two more; or Morris' "
                "trajectories."),
    SEED)
_search("threshold", """The value at which a condition begins or ceases to hold.

    The condition is --where, or the expectations of the scene.
    """,
    KEEP, WHERE,
    option("--within", metavar="WIDTH", read=read_quantity,
           help="Width of the bracket; a thousandth of the range by default."))
commands.add_command(search)
commands.sections["Questions"].append("search")

questions("equilibrium", "equilibrium", """Find static equilibria of SCENE and their stability.

    The drives go slowly to their values at the end of the scene, or with --from have these values
    from the start. Prints poses, tensions, contact forces, residual forces and stability, and the
    stiffness of a held object. Scenes that have no equilibrium are refused, with the reason.
    """,
    option("--from", "starts", multiple=True, metavar="PATH=VALUES", read=read_starts,
           help="Start there: values of JOINT.angle, BODY.x, BODY.y or BODY.angle, as in "
                "'arm.angle=-30 deg,0,30 deg'; by default the scene's pose. Several options: all "
                "combinations."),
    option("--at", type=float, metavar="SECONDS",
           help="Time of the drives' values; the end of the scene by default."),
    option("--stages", type=click.IntRange(min=1), metavar="N",
           help="Steps of the slow load; by default 40, with dry friction 200."),
    option("--along", metavar="PATH=FROM:TO:COUNT", read=read_along,
           help="Follow equilibria along a value, as in 'parameters.pull=0:10:21'."),
    option("--plot", "quantity", metavar="QUANTITY",
           help="Quantity in the figure of --along; by default the one that changes most."),
    option("--body", metavar="NAME",
           help="Body whose stiffness is printed; by default the one free 'object'."),
    option("--out", type=OUT, metavar="DIR",
           help="Directory of rest.json, rest.csv and rest.png; renders/rest/SCENE by default."),
    *SCENE, JSON, QUIET)
questions("converge", "accuracy", """Check SCENE for convergence: run it at steps h, h/2, h/4.

    Prints, for every expected quantity, its value at each step, the order of convergence, the
    estimated and the allowed error, and the result; the warnings of the consistency checks; and
    what to change. Exits 1 if the scene has not converged, 3 if a run diverged. Writes no files.
    """, *SCENE, JSON)
questions("bounds", "accuracy", """Bound indeterminate contact forces of a saved run.

    RUN is the directory of a run, or the name of a scene whose run lies in renders/. With friction,
    single contact forces depend on the history of a grasp. Balance, friction and unilateral contact
    leave an interval for each. Contacts without force count, too. Exits 1 if a recorded force is
    outside its interval.
    """,
    RUN,
    option("--at", "instants", multiple=True, type=float, metavar="SECONDS",
           help="Time of the sample; the last one by default. Repeatable."),
    option("--near", metavar="LENGTH", read=read_length,
           help="Maximum gap of a contact, as 10um; that of a step by default (docs/audit.md)."),
    option("--push", "pushed", metavar="BODY",
           help="Also print the largest push at this body's centre of mass, in 12 directions."),
    files((".csv",), "A .csv file; contact_bounds.csv in RUN by default. Repeatable."),
    JSON, QUIET)

exchange("export", "scenes", """
    Export SCENE as a MuJoCo model (MJCF), or as a Python script for pymunk.

    Elements without a counterpart are named, and nothing is written unless --without leaves them
    out. Other differences are printed to stderr.
    """,
    option("--format", "--to", "form", type=click.Choice(["mjcf", "pymunk"]), default="mjcf",
           show_default=True, help="A model for MuJoCo, or a script in Python for pymunk."),
    option("--out", type=OUT, metavar="FILE", help="File to write; stdout by default."),
    option("--without", multiple=True, metavar="NAME",
           help="Leave out elements and all that depends on them, as in 'tree.*'. Repeatable."),
    *SCENE)
