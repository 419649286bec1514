"""``sandbox search``: what is looked for over many runs of a scene, chosen one after the other."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from sandbox.cli.robustness import robustness
from sandbox.cli.searched import KEEP, SEED, WHERE, searched, with_options
from sandbox.wording import meant


class _Searches(click.Group):
    """Does the search that a study file says, and offers a near miss for one that is none."""

    def resolve_command(
        self, ctx: click.Context, args: list[str],
    ) -> tuple[str | None, click.Command | None, list[str]]:
        if args[0] not in self.commands and not args[0].startswith("-") \
                and not ctx.resilient_parsing:
            known = self.list_commands(ctx)
            if kind := _kind_in(args[0], known, ctx):
                return kind, self.commands[kind], args
            raise click.UsageError(f"There is no search {args[0]!r}.{meant(args[0], known)} "
                                   f"Searches: {', '.join(known)}.", ctx)
        return super().resolve_command(ctx, args)


def _kind_in(word: str, known: list[str], ctx: click.Context) -> str:
    """The search that a study file says that it is; empty for a word that is no file's."""
    from sandbox.search.written import kind_in
    from sandbox.sweeps.plan import study_file

    if not word.endswith(".json") and not study_file(word):
        return ""
    if kind := kind_in(word):
        return kind
    raise click.UsageError(f"{word} does not say which search it is: 'sandbox search best {word}', "
                           f"or a key \"search\" in a study file ({', '.join(known)}).", ctx)


@click.group(cls=_Searches, commands={"robustness": robustness}, invoke_without_command=True)
@click.pass_context
def search(ctx: click.Context) -> None:
    """Look for a threshold, a fit, the best, or what matters, over many runs.

    SCENE is a scene, or a study file that says what is varied and kept; where it
    says which search it is, too, 'sandbox search STUDY.json' does it. Runs that
    are done are not done again: the same command goes on where it was stopped.
    What was found is run again at half the step, to see whether it hangs on it.
    """
    if ctx.invoked_subcommand is None:
        raise click.UsageError(f"Say which search: {', '.join(search.list_commands(ctx))}.", ctx)


@search.command()
@with_options(KEEP, WHERE,
       click.option("--within", metavar="WIDTH", help="How narrow the bracket is to be, as in "
                    "'0.01 N'; a thousandth of the range by default, a twentieth with random "
                    "starts."),
       click.option("--share", type=click.FloatRange(0, 1, min_open=True, max_open=True),
                    default=0.5, show_default=True, help="Of random starts that is to hold."),
       click.option("--runs", type=click.IntRange(min=1), default=200, show_default=True,
                    help="At most so many random starts."), SEED)
def threshold(
    scene: str, where: tuple[str, ...], within: str | None, share: float, runs: int, seed: int,
    **words: Any,
) -> int:
    """Where a condition begins or ceases to hold along one range.

    The condition is --where, or what the scene expects. Paths that are varied by
    a distribution are random starts: then it is where a share of them holds.
    """
    return searched(scene, "threshold", {
        "where": where, "within": _width(within, "--within"), "share": share, "runs": runs,
        "seed": seed}, **words)


@search.command()
@with_options(click.option("--data", type=click.Path(path_type=Path), metavar="FILE.csv",
                    help="What was measured: a column 'time' [s], and columns of quantities, SI "
                         "or as in 'x [mm]'."),
       click.option("--match", multiple=True, metavar="COLUMN=QUANTITY",
                    help="The quantity that a column is, as in 'x=puck.x'; by default columns that "
                         "have a quantity's name."),
       click.option("--noise", multiple=True, metavar="COLUMN=SIZE",
                    help="Standard deviation of a column, as in 'x=0.5 mm'; estimated by default."))
def fit(
    scene: str, data: Path | None, match: tuple[str, ...], noise: tuple[str, ...], **words: Any,
) -> int:
    """The values of paths with which the scene moves as was measured.

    With 95 % intervals, and the directions that the data can't tell.
    """
    pairs = _pairs(match, "--match") or None
    sizes = {name: _width(text, "--noise") or 0.0
             for name, text in _pairs(noise, "--noise").items()} or None
    return searched(scene, "fit", {"data": data, "match": pairs, "noise": sizes}, keep=(), **words)


@search.command()
@with_options(KEEP,
       click.option("--least", multiple=True, metavar="NAME",
                    help="What is kept that is to be least. Several goals have several answers."),
       click.option("--most", multiple=True, metavar="NAME",
                    help="What is kept that is to be most."), WHERE,
       click.option("--sampler", metavar="NAME", default="", help="How points are chosen: cmaes "
                    "(the default for one goal over ranges), tpe (with conditions or lists), gp, "
                    "nsga2 (for several goals), random."),
       click.option("--runs", type=click.IntRange(min=1), default=200, show_default=True,
                    help="How many; more of them go on from what was done."), SEED)
def best(
    scene: str, least: tuple[str, ...], most: tuple[str, ...], where: tuple[str, ...],
    sampler: str, runs: int, seed: int, **words: Any,
) -> int:
    """The values of paths with which something is least or most."""
    return searched(scene, "best", {
        "least": least, "most": most, "where": where, "sampler": sampler, "runs": runs,
        "seed": seed}, **words)


@search.command()
@with_options(KEEP,
       click.option("--method", metavar="NAME", default="sobol", show_default=True,
                    help="sobol (shares of the variance) or morris (screening of many paths)."),
       click.option("--count", type=click.IntRange(min=1), default=64, show_default=True,
                    help="Of points, a power of 2, each of as many runs as there are paths and "
                         "two more; or of Morris' trajectories."), SEED)
def sensitivity(scene: str, method: str, count: int, seed: int, **words: Any) -> int:
    """How much of what is kept comes from which path."""
    return searched(scene, "sensitivity", {"method": method, "count": count, "seed": seed},
                    **words)


def _width(text: str | None, option: str) -> float | None:
    """A quantity of an option, SI."""
    from sandbox.scene.values.units import parse_quantity
    from sandbox.wording import WrongValueError

    try:
        return None if text is None else parse_quantity(text, None)
    except WrongValueError as error:
        raise click.BadParameter(str(error), param_hint=option) from None


def _pairs(words: tuple[str, ...], option: str) -> dict[str, str]:
    """``name=value`` words."""
    found = {}
    for word in words:
        name, equals, value = (part.strip() for part in word.partition("="))
        if not (name and equals and value):
            raise click.BadParameter(f"{word!r} is not of the form name=value", param_hint=option)
        found[name] = value
    return found
