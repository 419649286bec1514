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
from click import Choice, IntRange

from sandbox.cli import readers
from sandbox.cli.commands import Commands, commands
from sandbox.cli.options import NAMES, PICTURES, title_of
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


def option(
    words: str, help_text: str, name: str = "", *, read: Callable[[Any], Any] | None = None,
    **settings: Any,
) -> click.Option:
    """An option such as ``--set PATH=VALUE...``, repeatable with dots; a flag without a word.

    ``read`` converts the value, and its errors name the option.
    """
    def convert(ctx: click.Context, param: click.Parameter, value: Any) -> Any:
        try:
            return value if value is None or read is None else read(value)
        except (ValueError, SandboxError) as error:
            raise click.BadParameter(str(error), ctx, param) from error

    names = words.split()
    metavar = "" if names[-1].startswith("-") else names.pop()
    several = metavar.endswith("...")
    return click.Option([*names, *filter(None, [name])], **{
        "help": help_text + " Repeatable." * several, "callback": read and convert,
        "metavar": metavar.removesuffix("...") or None, "multiple": several,
        "is_flag": (not metavar and "type" not in settings) or None,
        "type": OUT if "--out" in names else None,
        "show_default": settings.get("default", "") != "", **settings})


def files(suffixes: Sequence[str], help_text: str) -> click.Option:
    """A repeatable option ``--out FILE`` that accepts some suffixes."""
    def read(paths: tuple[Path, ...]) -> tuple[Path, ...]:
        for path in paths:
            if path.suffix.lower() not in suffixes:
                raise ValueError(f"{str(path)!r} does not end in one of {', '.join(suffixes)}")
        return paths

    return option("--out FILE...", f"{help_text} ({', '.join(suffixes)}).", "files", read=read)


POSITIVE = IntRange(min=1)
TIME = partial(readers.quantity, dimension="time")
RUN = click.Argument(["run"])
LIMIT = option("--limit NAME=VALUE...", "Change a limit, as in 'steps=5e6'; 'sandbox explain "
               "limits' lists them.", "limits", read=readers.limits)
ELEMENTS = option("--elements FILE...", "Run a Python file that registers elements of your own.",
                  is_eager=True, type=click.Path(exists=True, dir_okay=False, path_type=Path),
                  callback=_read_elements, expose_value=False)
SET = option("--set PATH=VALUE...", "Change the scene, as in 'parameters.pull=20 N' or "
             "'run.step=1e-3'.", "overrides", read=readers.overrides)
CHANGES = (SET, ELEMENTS, LIMIT)
SCENE = (click.Argument(["scene"], shell_complete=complete_scene), *CHANGES)
JSON = option("--json", "Print one JSON object and nothing else.", "as_json")
QUIET = option("--quiet -q", "Print errors only.")


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
    option("--out FILE", "File or directory to write to; NAME.json by default."))
start("check", "check", """Validate scenes, and estimate the cost of a run.

    First checks the keys, units, ranges and names of elements. If they are right, looks for unknown
    quantities, joints that are not assembled, bodies that overlap, tendon guides that coincide,
    springs and dampers too strong for the step, and springs that can snap over centre. Exits 2 if a
    scene cannot be run; with --strict on warnings, too.
    """,
    click.Argument(["scenes"], metavar="SCENE...", nargs=-1, shell_complete=complete_scene),
    option("--strict", "Let warnings fail the check."),
    option("--expand", "Print the one SCENE as plain elements, a scene, too."),
    option("--schema [KIND]", "Print the JSON Schema of scenes, or with 'study' of study files.",
           is_flag=False, flag_value="scene", type=Choice(["scene", "study"])),
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
    option("--out DIR", "Directory; renders/NAME by default."),
    option("--solver", "By default the scene's.", type=Choice(["direct", "pymunk"])),
    option("--no-render", "Numbers only, no pictures."),
    option("--format", "Of the film.", "animation", type=Choice(["gif", "mp4"]), default="gif"),
    option("--report", "Also write report.html.", "writes_page"),
    option("--audit", "List all consistency checks.", "lists_checks"),
    *SCENE, JSON, QUIET)
simulate("view", "view", """Open SCENE in the browser: run, pause, pull bodies, move sliders.

    Serves a page on this machine only, until Ctrl-C. The scene is reloaded when its file is saved.
    A session can be saved as a scene that reproduces it exactly. Needs the extra 'view'.
    """,
    option("--port N", "Port of the page; by default a free one.", type=IntRange(0, 65535)),
    option("--no-browser", "Only print the address."),
    *SCENE)

results("plot", "plot", """List or plot the quantities of a saved run, or compare runs.

    RUN is the directory of a run, or the name of a scene whose run lies in renders/. A QUANTITY is
    a name such as finger.mcp.angle, or a pattern such as 'finger.*.angle'; without any, those of
    the run are listed. --with compares runs, by default in the quantities that controllers lead to
    targets, and prints overshoot, settling time, errors and effort. Nothing is simulated.
    """,
    RUN,
    click.Argument(["quantities"], nargs=-1, metavar="[QUANTITY]..."),
    option("--with RUN...", "Another run in the same figure, in another colour.", "others"),
    option("--target QUANTITY=VALUE...", "Target, as in 'arm.angle=5deg'; by default the "
           "controller's.", "targets", read=partial(readers.pairs, form="quantity=value")),
    option("--x QUANTITY", "Horizontal axis, not time.", "across", default=""),
    option("--from TIME", "Start, as in '0.5s'; that of the run by default.", "begin", read=TIME),
    option("--to TIME", "End, likewise.", "end", read=TIME),
    option("--width LENGTH", "Width on paper, as in '85mm'; 120 mm by default.",
           read=readers.length),
    option("--no-title", "Omit the scene's title.", "untitled"),
    files((*PICTURES, ".csv"), "A figure, or the table of responses; plot.png in RUN by default"),
    JSON, QUIET)
results("render", "runs", """Draw a saved run as an animation or as stills.

    RUN is the directory of a run, or the name of its scene. Nothing is simulated.
    """,
    RUN,
    option("--out FILE...", "A .gif or .mp4 film, a .png, .svg or .pdf still, or a directory for "
           "PNG frames; RUN/animation.gif by default.", "outs"),
    option("--format", "Of the file written without --out; gif or png by default.", "ending",
           type=Choice(["gif", "mp4", "png", "svg", "pdf"])),
    option("--at TIME...", "Draw a still at a time: '0.8s', 'start' or 'end'."),
    option("--strip [N]", "Draw N moments side by side (5 without N), or those of --at.",
           is_flag=False, flag_value=0, type=IntRange(min=0)),
    option("--size WxH", "Pixels; '2x' for twice the size of the scene's view; of a still on "
           "paper '85mm' or '85mmx70mm'.", read=readers.size),
    option("--labels", "All of title, time and legend, or only scales.",
           type=Choice(["all", "scales", "none"]), default="all"),
    option("--transparent", "Transparent background, except of MP4."),
    option("--show LAYERS", "More layers, as in 'traces,velocity'; '-contacts' hides one; 'all'."),
    option("--follow BODY", "Body that the view follows."),
    option("--fit BODY...", "Bodies or groups to fit the view to, as in 'finger*'.", "bodies"),
    option("--fps", "Frames per second; the view's by default.", type=Choice(["20", "25", "50"])),
    option("--speed FACTOR", "Seconds of motion per second of film; the view's by default.",
           type=click.FloatRange(min=0, min_open=True)),
    LIMIT, QUIET)
results("report", "runs", """Write one HTML page that plays up to four runs.

    RUN is the directory of a run, or the name of a scene whose run lies in renders/. The page works
    offline in any browser. Nothing is simulated.
    """,
    click.Argument(["runs"], nargs=-1, required=True, metavar="RUN..."),
    option("--out FILE", "The page; report.html in the first run's directory by default."),
    option("--plot QUANTITY...", "Quantities to plot first, as in 'finger.*.angle'; by default "
           "the meters, then the expected quantities.", "plots"),
    JSON, QUIET)

KEEP = option("--keep RESULT...",
              "A result of each run: 'max disc.x over last 0.2 s', 'tip=final tip.x', 'ratio==tip "
              "/ pull', a quantity for its last value. By default those of the expectations.")
WHERE = option("--where CONDITION...", "A condition on results: 'slip < 1 mm'. All must hold.")
SEED = option("--seed", "Of random points.", type=IntRange(min=0), default=0)
WORKERS = option("--workers N|ADDRESS", "Processes, by default one per processor; or a Dask "
                 "scheduler.", default="", read=readers.workers)


def study(values: str, directory: str, *own: click.Parameter) -> tuple[click.Parameter, ...]:
    """The parameters of a sweep or search, with its ``own``."""
    return (SCENE[0],
            option("--vary PATH=VALUES...", values,
                   read=partial(readers.pairs, form="path=values")),
            *own, option("--out DIR", directory), WORKERS, *CHANGES, JSON, QUIET)


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
        option("--design", "Arrangement of the points; a grid by default, random where there is a "
               "distribution, else latin_hypercube.", type=Choice(DESIGNS)),
        option("--count N", "Number of points of designs with random points.", type=POSITIVE),
        SEED,
        option("--recordings", "Keep the whole recording of each run, too."),
        option("--no-audit", "Do not audit runs; this halves the time."),
        option("--again", "Repeat finished runs.")))


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
    search.add("Commands", NAMES.get(kind, kind), "sweep:search", help_text, *study(
        "Values of a path: a range, 'parameters.pull=2 N:8 N', with ':log' for even ratios; a list "
        "or a distribution, 'normal(3 N, 0.2 N)', where the search takes them.",
        "Directory of the results and finished runs; by default searches/KIND/NAME, with a number "
        "for another question.", *own), kind=kind)


_search("fit", """The values with which the scene reproduces a measurement.

    With 95 % intervals, and the directions that the data do not determine.
    """,
    option("--data FILE.csv", "Columns 'time' [s], and quantities in SI or as in 'x [mm]'.",
           type=click.Path(path_type=Path)),
    option("--match COLUMN=QUANTITY...", "Quantity of a column, as in 'x=puck.x'; its name by "
           "default.", read=partial(readers.pairs, form="column=quantity")),
    option("--noise COLUMN=SIZE...", "Standard deviation, as in 'x=0.5 mm'; estimated by default.",
           read=lambda words: {name: readers.quantity(text) for name, text in
                               readers.pairs(words, "column=size").items()}))
_search("best", "The values that minimise or maximise results.",
    KEEP,
    option("--minimize NAME...", "A result to minimise; several have several optima.", "least"),
    option("--maximize NAME...", "A result to maximise.", "most"),
    WHERE,
    option("--sampler NAME", "cmaes (the default for one goal over ranges), tpe (with conditions "
           "or lists), gp, nsga2 (for several goals), random."),
    option("--runs", "Number of runs; more continue the search.", type=POSITIVE, default=200),
    SEED)
_search("sensitivity", "The influence of each path on each result.",
    KEEP,
    option("--method NAME", "sobol (shares of variance) or morris (screening).", default="sobol"),
    option("--count", "Base points, a power of 2, each with a run per path and two more; or "
           "Morris' trajectories.", type=POSITIVE, default=64),
    SEED)
_search("threshold", """The value at which a condition begins or ceases to hold.

    The condition is --where, or the expectations of the scene.
    """,
    KEEP, WHERE,
    option("--within WIDTH", "Of the bracket; range / 1000 by default.", read=readers.quantity))
commands.add_command(search)
commands.sections["Questions"].append("search")

questions("equilibrium", "equilibrium", """Find static equilibria of SCENE and their stability.

    The drives go slowly to their values at the end of the scene, or with --from have these values
    from the start. Prints poses, tensions, contact forces, residual forces and stability, and the
    stiffness of a held object. Scenes that have no equilibrium are refused, with the reason.
    """,
    option("--from PATH=VALUES...", "Start there: values of JOINT.angle, BODY.x, BODY.y or "
           "BODY.angle, as in 'arm.angle=-30 deg,0,30 deg'; by default the scene's pose. Values "
           "of several are combined.", "starts", read=readers.starts),
    option("--at SECONDS", "Time of the drives' values; by default the end.", type=float),
    option("--stages N", "Steps of the load; by default 40, with friction 200.", type=POSITIVE),
    option("--along PATH=FROM:TO:COUNT", "Follow equilibria along a value, as in "
           "'parameters.pull=0:10:21'.", read=readers.along),
    option("--plot QUANTITY", "Quantity over --along; by default that changing most.", "quantity"),
    option("--body NAME", "Body whose stiffness is printed; by default the one free 'object'."),
    option("--out DIR", "Of rest.json, rest.csv and rest.png; renders/rest/SCENE by default."),
    *SCENE, JSON, QUIET)
questions("converge", "accuracy", """Check SCENE for convergence: run it at steps h, h/2, h/4.

    Prints, for every expected quantity, its value at each step, the order of convergence, the
    estimated and the allowed error, and the result; the warnings of the consistency checks; and
    what to change. Exits 1 if the scene has not converged, 3 if a run diverged. Writes no files.
    """, *SCENE, JSON)
questions("bounds", "accuracy", """Bound indeterminate contact forces of a saved run.

    RUN is the directory of a run, or the name of a scene whose run lies in renders/. With friction,
    single contact forces depend on the history of a grasp. Balance, friction and unilateral contact
    leave an interval for each. Exits 1 if a recorded force is outside its interval.
    """,
    RUN,
    option("--at SECONDS...", "Time of a sample; by default the last.", "instants", type=float),
    option("--near LENGTH", "Maximum gap of a contact, as in '10um'; by default that of a step "
           "(docs/audit.md).", read=readers.length),
    option("--push BODY", "Also print the largest push at this body's centre of mass, in 12 "
           "directions.", "pushed"),
    files((".csv",), "The table; contact_bounds.csv in RUN by default"),
    JSON, QUIET)

exchange("export", "scenes", """
    Export SCENE as a MuJoCo model (MJCF), or as a Python script for pymunk.

    Elements without a counterpart are named, and nothing is written unless --without leaves them
    out. Other differences are printed to stderr.
    """,
    option("--format --to", "A model for MuJoCo, or a script in Python for pymunk.", "form",
           type=Choice(["mjcf", "pymunk"]), default="mjcf"),
    option("--out FILE", "File to write; stdout by default."),
    option("--without NAME...", "Leave out elements and all that depends on them, as in 'tree.*'."),
    *SCENE)
