"""The script and the styles of page, view and notebook, put together from the files in ``script/``.

The files of :data:`MODULES` follow each other in one scope; there is nothing else to build. They
and the styles hold ASCII letters only: a page that is shown in another encoding keeps its hashes.
"""

from __future__ import annotations

import base64
import hashlib
from functools import cache
from importlib.resources import files

from sandbox.figure import strands
from sandbox.figure.style import MANY_MM

UPLOT = "1.6.32"
"""The version of uPlot (https://github.com/leeoniya/uPlot, MIT) in ``script/uplot/``."""
HASHES = {
    "uPlot.iife.min.js":
        "19c8d4c6ad88929a79f4ae49d6f7161566dfd0ba3d15cc495e974f787eb78f1f",
    "uPlot.min.css":
        "df630c6a8d6f8eeaff264b50f73ce5b114f646ffd9a0bb74f049b0a00135fa04",
    "uPlot.LICENSE":
        "8f989229699b4fe2f1a0432d0e9edc338a8a911e250e2d1b01ecd770a5f5b1bd",
}
"""SHA-256 of its files, as registry.npmjs.org has them in uplot-1.6.32.tgz."""
MODULES = ("data.js", "names.js", "units.js", "stage.js", "strands.js", "plots.js", "camera.js",
           "shell.js", "taking.js", "report.js", "meters.js", "facts.js")
"""In this order: each uses those before it."""
LIVE = ("scroll.js", "live.js", "controls.js")
"""Those that a live view has besides."""


CONSTANTS = (f"const MANY_MM = {MANY_MM}, AS_ONE = {strands.NEAR}, CROSSING = {strands.SHORT}, "
             f"TURN = {strands.STROKE};")
"""Constants that the script shares with figures."""


@cache
def text_of(name: str) -> str:
    """A file of ``script/``."""
    return files("sandbox.web").joinpath("script", *name.split("/")).read_text(encoding="utf-8")


@cache
def script(*more: str) -> str:
    """The whole module: uPlot, constants, :data:`MODULES`, then ``more`` files of ``script/``."""
    return "\n".join([text_of("uplot/uPlot.iife.min.js"), CONSTANTS,
                      *(text_of(name) for name in (*MODULES, *more))])


@cache
def styles() -> str:
    """The style sheet."""
    return text_of("uplot/uPlot.min.css") + "\n" + text_of("sandbox.css")


def source_hash(text: str) -> str:
    """A source of a Content-Security-Policy that allows just this script or style sheet."""
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"
