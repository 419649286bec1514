"""The page of a run as a value: a notebook shows it in a frame of its own, and it can be saved."""

from __future__ import annotations

import html
import os
from collections.abc import Sequence
from dataclasses import dataclass
from numbers import Integral

from sandbox.atomic_files import output_path, write_atomic
from sandbox.errors import OutputError
from sandbox.recording.recording import Recording
from sandbox.web.words import FoundOut
from sandbox.web.page import report
from sandbox.wording import quoted

HEIGHT = 760
"""Of the frame [pixels]."""
LOWEST, HIGHEST = 200, 4000


@dataclass(frozen=True, repr=False)
class RunPage:
    """One HTML file that plays a run."""

    text: str
    about: str
    """In a line, for who cannot see it."""
    height: int = HEIGHT
    """Of the frame that it is shown in [pixels]."""

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write it to a file.

        Raises:
            OutputError: another ending than .html or .htm, or it cannot be written.
        """
        file = output_path(path, "a page")
        if file.suffix.lower() not in (".html", ".htm"):
            raise OutputError(f"{file}: a page is an .html file", code="bad-picture")
        write_atomic(file, self.text)

    def __repr__(self) -> str:
        return f"<RunPage of {self.about}, {len(self.text) / 1000:.0f} kB>"

    def _repr_html_(self) -> str:
        """A frame whose script reaches nothing of the notebook: it may run and save, no more."""
        return ('<iframe sandbox="allow-scripts allow-downloads" '
                f'style="width:100%;height:{self.height}px;border:0" '
                f'title="{html.escape(self.about)}" '
                f'srcdoc="{html.escape(self.text, quote=True)}"></iframe>')


def page(run: Recording, quantities: Sequence[str], height: int) -> RunPage:
    """See :meth:`sandbox.Recording.page`."""
    if not isinstance(height, Integral) or not LOWEST <= height <= HIGHEST:
        raise OutputError(f"height={quoted(height)} is no height of a page; pass {LOWEST} to "
                          f"{HIGHEST} pixels", code="bad-picture")
    plots = list(dict.fromkeys(name for each in quantities for name in run.names(each)))
    told = FoundOut(verdicts=run.verdicts, figures=run.audit)
    return RunPage(report([run], [told], plots), f"{run.mechanism.name or 'a run'} in motion",
                height)
