"""The CSV files of a run, and its tables of pandas and data sets of xarray.

CSV files have one row per sample, columns ``time_s,<name>.<quantity>_<unit>``. In a unit a space
becomes ``_``, ``/`` becomes ``_per_``, ``%`` becomes ``percent``, ``^`` and ``1`` vanish. Numbers
have 12 significant digits; zero has no sign; a missing value is ``nan``.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from importlib import import_module
from typing import Any

import numpy as np

from sandbox.audit.bounds import Bounds
from sandbox.elements.arrays import IMPACT
from sandbox.elements.quantities import CONTACT_COLUMNS, IMPACT_COLUMNS
from sandbox.errors import SandboxError
from sandbox.numeric import Array, Integers
from sandbox.samples.samples import TABLES, Samples
from sandbox.values.units import normal_unit

NUMBER = "%.12g"
ALWAYS = ("tendons", "joints", "bodies", "drives")
"""Tables that are written even without a column but the time."""
BLOCK = 250_000  # Numbers that are turned into text at a time


def column(name: str, unit: str) -> str:
    """The name of a column: ``finger1.tendon.tension_N``, ``arm.omega_rad_per_s``, ``held``."""
    unit = normal_unit(unit).replace("/", "_per_").replace("%", "percent").replace(" ", "_")
    unit = re.sub(r"[^\w]", "", "" if unit == "1" else unit).removeprefix("1_").strip("_")
    return "_".join(filter(None, (name, unit)))


def rows(run: Samples, kind: str) -> Iterator[str]:
    """The text of a table (see :meth:`Samples.table`), header first, in large pieces."""
    names, units, _ = run.part(0, 0).table(kind)
    heads = ["time_s", *(column(name, unit) for name, unit in zip(names, units, strict=True))]
    yield ",".join(heads) + "\n"
    line = ",".join([NUMBER] * len(heads)) + "\n"
    size = max(1, BLOCK // len(heads))
    for first in range(0, len(run), size):
        part = run.part(first, first + size)
        # adding 0 takes the sign off a zero
        values = np.column_stack([part.time, part.table(kind).values]) + 0.0
        yield "".join([line % tuple(row) for row in values.tolist()])


def _pair_head(units: Mapping[str, str]) -> str:
    """The first line of a table with a row for two bodies at an instant."""
    return ",".join(["time_s", "body", "other", *(
        column(name, unit) for name, unit in units.items())]) + "\n"


def bound_rows(run: Samples, found: Mapping[int, Sequence[Bounds]]) -> Iterator[str]:
    """The text of ``contact_bounds.csv``: bounds of contact forces, by number of the sample."""
    yield _pair_head({f"{kind}{end}": "N" for kind in ("normal", "tangential")
                      for end in ("", "_low", "_high")})
    for sample in sorted(found):
        if each := found[sample]:
            numbers = np.array([[value for part in (one.normal, one.tangential)
                                 for value in (part.force, part.low, part.high)] for one in each])
            yield _pair_rows(run, np.full(len(each), run.time[sample]),
                             *np.array([(one.body, one.other) for one in each]).T, numbers)


def contact_rows(run: Samples) -> Iterator[str]:
    """The text of ``contacts.csv``: the force on ``body`` by ``other``, row by row."""
    yield _pair_head(CONTACT_COLUMNS)
    contacts = run.mean_contacts
    for first in range(0, len(contacts.point), BLOCK // 8):
        rows = slice(first, first + BLOCK // 8)
        yield _pair_rows(run, run.time[contacts.sample[rows]], contacts.body[rows],
                         contacts.other[rows], contacts.point[rows], contacts.force[rows],
                         contacts.normal[rows], contacts.tangential[rows])


def impact_rows(run: Samples) -> Iterator[str]:
    """The text of ``impacts.csv``: the impulse on ``body`` by ``other``, row by row."""
    yield _pair_head(IMPACT_COLUMNS)
    yield _pair_rows(run, *(run.arrays[key] for key in IMPACT))


def _pair_rows(run: Samples, time: Array, body: Integers, other: Integers, *numbers: Array) -> str:
    """Lines of an instant, the names of two bodies and numbers."""
    names = [body.name for body in run.mechanism.bodies]
    values = np.column_stack([time, *numbers]) + 0.0
    line = ",".join([NUMBER, "%s", "%s", *[NUMBER] * (values.shape[1] - 1)]) + "\n"
    return "".join([line % (row[0], names[one], names[two], *row[1:]) for row, one, two in zip(
        values.tolist(), body.tolist(), other.tolist(), strict=True)])


def chosen(run: Samples, quantities: tuple[str, ...]) -> list[str]:
    """The names that names and patterns stand for, each once; of none all that CSV files have."""
    if quantities:
        return list(dict.fromkeys(name for each in quantities for name in run.names(each)))
    return [name for kind in TABLES for name in run.table(kind).names]


def library(name: str) -> Any:
    """The module of pandas or xarray."""
    try:
        return import_module(name)
    except ImportError:
        raise SandboxError(f"to_{name}() needs the package {name!r}, which is not installed: "
                           f"pip install {name}; run[name] gives plain arrays without it",
                           code="missing-package") from None
