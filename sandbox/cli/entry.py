"""The group of commands, and the one place where they are run."""

from __future__ import annotations

import os
from collections.abc import Sequence
from importlib import import_module

import click

import sandbox
from sandbox.cli.console import Console
from sandbox.cli.exits import Exit
from sandbox.cli.failures import guard
from sandbox.wording import meant

COMMANDS = {
    **{name: name for name in (
        "bounds", "certify", "check", "compare", "completion", "equilibrium", "expand", "export",
        "new", "plot", "push", "render", "report", "run", "schema", "search", "sweep", "verify",
        "view")},
    "list": "scenes",
}
"""The module of each command in this package, which has it under the name that users type."""
REMOVED = {
    "rest": "Use 'sandbox equilibrium SCENE'.",
    "study": "Use the scripts in docs/studies; of 'study robustness', a sweep over a grid.",
}
"""Commands of earlier versions, and what replaces each."""


class _Commands(click.Group):
    """A group whose commands are imported when they are asked for, or help for all of them.

    For a command that it does not know it offers a near miss, on any click 8.
    """

    def list_commands(self, ctx: click.Context) -> list[str]:
        """The names of all commands, sorted."""
        return sorted(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """The command of a name."""
        if cmd_name not in COMMANDS:
            return None
        members = vars(import_module(f"sandbox.cli.{COMMANDS[cmd_name]}")).values()
        return next(each for each in members
                    if isinstance(each, click.Command) and each.name == cmd_name)

    def resolve_command(
        self, ctx: click.Context, args: list[str],
    ) -> tuple[str | None, click.Command | None, list[str]]:
        name = args[0]
        if name not in COMMANDS and not name.startswith("-") and not ctx.resilient_parsing:
            known = self.list_commands(ctx)
            advice = REMOVED.get(name) or \
                f"{meant(name, known).lstrip()} Commands: {', '.join(known)}."
            raise click.UsageError(f"No such command {name!r}. {advice}", ctx)
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


def invoke(words: Sequence[str]) -> int:
    """Run a command; its exit code. Prints what it has to say and never raises."""
    def work() -> int:
        code = commands.main(list(words), prog_name="sandbox", standalone_mode=False)
        return code if isinstance(code, int) else Exit.DONE

    if os.environ.get("SANDBOX_DEBUG"):
        return work()
    return guard(work, Console(as_json="--json" in words,
                               quiet=not {"--quiet", "-q"}.isdisjoint(words)))
