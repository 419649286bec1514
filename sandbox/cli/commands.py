"""The group of commands, and how one of them is run.

The commands are declared in :mod:`sandbox.cli.declarations`, imported when one is looked up:
``--version`` needs click only.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from importlib import import_module
from typing import Any

import click

import sandbox
from sandbox.cli.console import Console, Exit, StdoutError, report
from sandbox.wording import meant

ADVICE = {
    "compare": "Use 'sandbox plot RUN --with RUN'.",
    "completion": "Use _SANDBOX_COMPLETE=bash_source sandbox (or zsh_source, fish_source).",
    "expand": "Use 'sandbox check SCENE --expand'.",
    "rest": "Use 'sandbox equilibrium SCENE'.",
    "schema": "Use 'sandbox check --schema'.",
    "search best": "Use 'sandbox search optimize SCENE' with --minimize or --maximize.",
    "--duration": "Use --set run.duration=TIME.",
    "--frames": "Use 'sandbox render RUN --out DIR'.",
    "--show": "Use 'sandbox render RUN --show LAYERS'.",
    "--step": "Use --set run.step=TIME.",
}
"""Commands and options that do not exist, and the ones to use."""


class Commands(click.Group):
    """A group that suggests similar names for unknown commands, and lists commands by section."""

    noun = "command"

    def __init__(self, *words: Any, **settings: Any) -> None:
        super().__init__(*words, **settings)
        self.sections: dict[str, list[str]] = {}

    def add(
        self, section: str, name: str, home: str, help_text: str, *params: click.Parameter,
        **more: Any,
    ) -> None:
        """Add a command whose function is ``name`` in a module, or ``module:name``."""
        module, _, function = home.partition(":")

        def run(**given: Any) -> Any:
            if "scene" in given:
                from sandbox.cli.options import Source
                given["scene"] = Source(*map(given.pop, ("scene", "overrides", "limits")))
            if {"as_json", "quiet"} & {*given}:
                given["console"] = Console(given.pop("as_json", False), given.pop("quiet", False))
            work = getattr(import_module(f"sandbox.cli.{module}"), function or name)
            return work(**given, **more)

        self.add_command(click.Command(name, callback=run, params=[*params], help=help_text))
        self.sections.setdefault(section, []).append(name)

    def resolve_command(
        self, ctx: click.Context, args: list[str],
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Find the command that words name; unknown ones are refused."""
        word, known = args[0], self.list_commands(ctx)
        if word not in known and not word.startswith("-") and not ctx.resilient_parsing:
            full = " ".join([*ctx.command_path.split()[1:], word])
            advice = f" {ADVICE[full]}" if full in ADVICE else \
                f"{meant(word, known)} Choose from {', '.join(known)}."
            raise click.UsageError(f"There is no {self.noun} {word!r}.{advice}", ctx)
        return super().resolve_command(ctx, args)

    def list_commands(self, ctx: click.Context) -> list[str]:
        """All names, section by section."""
        import_module("sandbox.cli.declarations")
        return [name for names in self.sections.values() for name in names]

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write each section with the first sentence of each command."""
        width = max(map(len, self.list_commands(ctx)))
        for title, names in self.sections.items():
            with formatter.section(title):
                formatter.write_dl([
                    (name.ljust(width), self.commands[name].get_short_help_str(formatter.width))
                    for name in names])


@click.group(
    cls=Commands,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
)
@click.version_option(sandbox.__version__, message="sandbox %(version)s")
def commands() -> None:
    """Simulate planar mechanisms and underactuated hands from JSON scenes.

    Exit codes: 0 done, 1 an expectation failed, 2 wrong input, 3 the simulation diverged, 130
    interrupted, 70 internal error.
    """


def invoke(words: Sequence[str]) -> int:
    """Run a command, print its output or error, and return its exit code."""
    console = Console(as_json="--json" in words, quiet=not {"--quiet", "-q"}.isdisjoint(words))
    try:
        code = commands.main(list(words) or ["--help"], prog_name="sandbox", standalone_mode=False)
        return code if isinstance(code, int) else Exit.DONE
    except (Exception, KeyboardInterrupt) as raised:
        if os.environ.get("SANDBOX_DEBUG"):
            raise
        error: BaseException = raised
        if isinstance(raised, click.NoSuchOption) and raised.option_name in ADVICE:
            error = click.UsageError(f"There is no option {raised.option_name!r}. "
                                     f"{ADVICE[raised.option_name]}", raised.ctx)
        try:
            return report(error, console)
        except StdoutError as failure:
            return report(failure, console)
