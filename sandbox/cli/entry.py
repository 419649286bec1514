"""The group of commands and their invocation."""

from __future__ import annotations

import os
from collections.abc import Sequence
from importlib import import_module

import click

import sandbox
from sandbox.cli.console import Console, Exit, guard
from sandbox.wording import meant

GROUPS = {
    "Start": {"list": "scenes", "new": "scenes", "check": "scenes", "explain": "explain"},
    "Simulate": {"run": "run", "view": "run"},
    "Results": {"plot": "plot", "render": "runs", "report": "runs"},
    "Questions": {
        "sweep": "sweep", "search": "sweep", "equilibrium": "equilibrium", "converge": "accuracy",
        "bounds": "accuracy"},
    "Exchange": {"export": "scenes"},
}
"""The commands by group, each with its module in this package."""
COMMANDS = {name: module for group in GROUPS.values() for name, module in group.items()}
REMOVED = {
    "certify": "Use 'sandbox converge SCENE'.",
    "compare": "Use 'sandbox plot RUN --with RUN'.",
    "completion": "Use _SANDBOX_COMPLETE=bash_source sandbox (or zsh_source, fish_source).",
    "expand": "Use 'sandbox check SCENE --expand'.",
    "push": "Search for the force that moves the object with 'sandbox search threshold SCENE'.",
    "rest": "Use 'sandbox equilibrium SCENE'.",
    "robustness": "Use 'sandbox sweep SCENE --vary …' with a grid of values.",
    "schema": "Use 'sandbox check --schema'.",
    "study": "Studies are scripts: run 'python docs/studies/guides.py' in a checkout.",
    "verify": "The validation cases are tests: run 'pytest tests/verification' in a checkout.",
    "search best": "Use 'sandbox search optimize SCENE' with --minimize or --maximize.",
    "search robustness": "Use 'sandbox sweep SCENE' with two --vary: on a grid it draws a map of "
                         "where the expectations of the scene hold.",
    "--bare": "Use --labels none.",
    "--centre": "Use --fit, or set view.centre in the scene.",
    "--figure": "Name the quantities.",
    "--frames": "Use 'sandbox render RUN --out DIR'.",
    "--meter": "Set view.meters in the scene.",
    "--no-audit": "Every run is checked.",
    "--scales": "Use --labels scales.",
    "--show": "Use 'sandbox render RUN --show LAYERS'.",
    "--width": "Use --fit, or set view.width in the scene.",
}
"""Commands, searches and options of earlier versions, and what replaces each."""


class Commands(click.Group):
    """A group that names the replacement of a former command, and suggests similar names."""

    noun = "command"
    nouns = "Commands"

    def resolve_command(
        self, ctx: click.Context, args: list[str],
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Find the command that words name; unknown ones are refused."""
        word, known = args[0], self.list_commands(ctx)
        if word not in known and not word.startswith("-") and not ctx.resilient_parsing:
            former = " ".join([*ctx.command_path.split()[1:], word])
            advice = f" {REMOVED[former]}" if former in REMOVED else \
                f"{meant(word, known)} {self.nouns}: {', '.join(known)}."
            raise click.UsageError(f"There is no {self.noun} {word!r}.{advice}", ctx)
        return super().resolve_command(ctx, args)


class _Main(Commands):
    """The group of all commands, which imports them on demand."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in COMMANDS:
            return None
        members = vars(import_module(f"sandbox.cli.{COMMANDS[cmd_name]}")).values()
        return next(each for each in members
                    if isinstance(each, click.Command) and each.name == cmd_name)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        width = max(map(len, COMMANDS))
        for title, names in GROUPS.items():
            commands = {name: self.get_command(ctx, name) for name in names}
            with formatter.section(title):
                formatter.write_dl([
                    (name.ljust(width), command.get_short_help_str(formatter.width))
                    for name, command in commands.items() if command is not None])


@click.group(
    cls=_Main,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
)
@click.version_option(sandbox.__version__, message="sandbox %(version)s")
def commands() -> None:
    """Simulate planar mechanisms and underactuated hands from JSON scenes.

    Exit codes: 0 done, 1 an expectation failed, 2 wrong input, 3 the simulation
    diverged, 130 interrupted, 70 internal error.
    """


def invoke(words: Sequence[str]) -> int:
    """Run a command, print its output, and return its exit code; never raises."""
    def work() -> int:
        try:
            code = commands.main(list(words), prog_name="sandbox", standalone_mode=False)
        except click.NoSuchOption as error:
            raise _replaced(error) from None
        return code if isinstance(code, int) else Exit.DONE

    if os.environ.get("SANDBOX_DEBUG"):
        return work()
    return guard(work, Console(as_json="--json" in words,
                               quiet=not {"--quiet", "-q"}.isdisjoint(words)))


def _replaced(error: click.NoSuchOption) -> click.UsageError:
    """The error, with the option that replaces the one of an earlier version."""
    name, advice = error.option_name, REMOVED.get(error.option_name, "")
    if name.startswith("--max-"):
        limit = name.removeprefix("--max-").replace("-", "_")
        advice = f"Use --limit {limit}=VALUE."
    return click.UsageError(f"No such option {name!r}. {advice}", error.ctx) if advice else error
