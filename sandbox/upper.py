"""What lower floors show of themselves, and upper ones make: cards, plots, pictures, films, pages.

A recording offers ``plot()``, a scene a card for notebooks; who draws them stands above both. This
is the one place where a lower floor calls an upper one, and :data:`HOMES` all that it may call.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

HOMES = {
    "card_of_run": "sandbox.notebook.cards",
    "card_of_scene": "sandbox.notebook.cards",
    "film": "sandbox.notebook.media",
    "page": "sandbox.show.inline",
    "picture": "sandbox.notebook.media",
    "plot": "sandbox.notebook.figures",
}
"""The module of each function."""


def upper(name: str) -> Any:
    """A function of :data:`HOMES`, loaded when it is first asked for."""
    return getattr(import_module(HOMES[name]), name)
