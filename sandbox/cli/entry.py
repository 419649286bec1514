"""The invocation of commands."""

from __future__ import annotations

import os
from collections.abc import Sequence

import click

from sandbox.cli.commands import ADVICE, commands
from sandbox.cli.console import Console, Exit, guard
from sandbox.wording import meant


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
                advice = f" Use --limit {name[6:].replace('-', '_')}=VALUE."
            raise click.UsageError(f"There is no option {name!r}.{advice}", error.ctx) from None
        return code if isinstance(code, int) else Exit.DONE

    if os.environ.get("SANDBOX_DEBUG"):
        return work()
    return guard(work, Console(as_json="--json" in words,
                               quiet=not {"--quiet", "-q"}.isdisjoint(words)))
