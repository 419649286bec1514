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
ADVICE = {
    "certify": "Use 'sandbox converge SCENE'.",
    "compare": "Use 'sandbox plot RUN --with RUN'.",
    "completion": "Use _SANDBOX_COMPLETE=bash_source sandbox (or zsh_source, fish_source).",
    "expand": "Use 'sandbox check SCENE --expand'.",
    "push": "Use 'sandbox search threshold SCENE' for the force that moves the object.",
    "rest": "Use 'sandbox equilibrium SCENE'.",
    "schema": "Use 'sandbox check --schema'.",
    "study": "Studies are scripts: run 'python docs/studies/guides.py' in a checkout.",
    "verify": "The validation cases are tests: run 'pytest tests/verification' in a checkout.",
    "search best": "Use 'sandbox search optimize SCENE' with --minimize or --maximize.",
    "search robustness": "Use 'sandbox sweep SCENE' with a grid of two --vary.",
    "--duration": "Use --set run.duration=TIME.",
    "--frames": "Use 'sandbox render RUN --out DIR'.",
    "--layers": "Use 'sandbox render RUN --show LAYERS'.",
    "--show": "Use 'sandbox render RUN --show LAYERS'.",
    "--step": "Use --set run.step=TIME.",
    "--steps": "Use --set run.step=TIME, or --limit steps=N for the limit.",
}
"""Commands and options that do not exist, and the ones to use."""


class Commands(click.Group):
    """A group that suggests similar names for unknown commands."""

    noun, nouns = "command", "Commands"

    def resolve_command(
        self, ctx: click.Context, args: list[str],
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Find the command that words name; unknown ones are refused."""
        word, known = args[0], self.list_commands(ctx)
        if word not in known and not word.startswith("-") and not ctx.resilient_parsing:
            full = " ".join([*ctx.command_path.split()[1:], word])
            advice = f" {ADVICE[full]}" if full in ADVICE else \
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
            name, known = error.option_name, [opt for param in (
                error.ctx.command.params if error.ctx else ()) for opt in param.opts]
            advice = f" {ADVICE[name]}" if name in ADVICE else meant(name, known, cutoff=0.75)
            if name.startswith("--max-"):
                limit = name.removeprefix("--max-").replace("-", "_")
                advice = f" Use --limit {limit}=VALUE."
            raise click.UsageError(f"There is no option {name!r}.{advice}", error.ctx) from None
        return code if isinstance(code, int) else Exit.DONE

    if os.environ.get("SANDBOX_DEBUG"):
        return work()
    return guard(work, Console(as_json="--json" in words,
                               quiet=not {"--quiet", "-q"}.isdisjoint(words)))
