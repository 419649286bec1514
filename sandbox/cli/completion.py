"""``sandbox completion``: the script that makes a shell complete commands, options and scenes."""

from __future__ import annotations

import click
from click.shell_completion import get_completion_class

SHELLS = ("bash", "zsh", "fish")


@click.command()
@click.argument("shell", type=click.Choice(SHELLS))
@click.pass_context
def completion(ctx: click.Context, shell: str) -> None:
    r"""Print the completion script of a shell.

    \b
    bash:  eval "$(sandbox completion bash)"       in ~/.bashrc
    zsh:   eval "$(sandbox completion zsh)"        in ~/.zshrc
    fish:  sandbox completion fish | source        in ~/.config/fish/config.fish
    """
    from sandbox.cli.console import Console

    writer = get_completion_class(shell)
    assert writer is not None  # click knows these three
    script = writer(ctx.find_root().command, {}, "sandbox", "_SANDBOX_COMPLETE").source()
    Console().document(script)
