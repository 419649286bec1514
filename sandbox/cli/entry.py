"""The group of commands, and the one place where they are run."""

from __future__ import annotations

import difflib
import os
from collections.abc import Sequence

import click

import sandbox
from sandbox.cli.bounds import bounds
from sandbox.cli.certify import certify
from sandbox.cli.check import check
from sandbox.cli.compare import compare
from sandbox.cli.completion import completion
from sandbox.cli.console import Console
from sandbox.cli.exits import Exit
from sandbox.cli.expand import expand
from sandbox.cli.export import export
from sandbox.cli.failures import guard
from sandbox.cli.new import new
from sandbox.cli.plot import plot
from sandbox.cli.push import push
from sandbox.cli.render import render
from sandbox.cli.report import report
from sandbox.cli.run import run
from sandbox.cli.scenes import list_scenes
from sandbox.cli.schema import schema
from sandbox.cli.study import study
from sandbox.cli.verify import verify
from sandbox.cli.view import view


class _Commands(click.Group):
    """A group that offers a near miss for a command it does not know, on any click 8."""

    def resolve_command(
        self, ctx: click.Context, args: list[str],
    ) -> tuple[str | None, click.Command | None, list[str]]:
        name = args[0]
        if name not in self.commands and not name.startswith("-") and not ctx.resilient_parsing:
            near = difflib.get_close_matches(name, self.commands, n=1)
            hint = f" Did you mean {near[0]!r}?" if near else ""
            known = ", ".join(self.list_commands(ctx))
            raise click.UsageError(f"No such command {name!r}.{hint} Commands: {known}.", ctx)
        return super().resolve_command(ctx, args)


@click.group(
    cls=_Commands,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
)
@click.version_option(sandbox.__version__, message="sandbox %(version)s")
def commands() -> None:
    """Simulate planar mechanisms and underactuated hands from JSON scenes.

    Exit codes: 0 done and every expectation held, 1 an expectation failed,
    2 wrong input, 3 the simulation diverged, 130 interrupted, 70 a fault of
    sandbox itself.
    """


for _command in (
    run, check, certify, verify, expand, export, schema, list_scenes, new, render, report, plot,
    compare, bounds, push, study, view, completion,
):
    commands.add_command(_command)


def invoke(words: Sequence[str]) -> int:
    """Run a command; its exit code. Prints what it has to say and never raises."""
    def work() -> int:
        code = commands.main(list(words), prog_name="sandbox", standalone_mode=False)
        return code if isinstance(code, int) else Exit.DONE

    if os.environ.get("SANDBOX_DEBUG"):
        return work()
    return guard(work, Console(as_json="--json" in words))
