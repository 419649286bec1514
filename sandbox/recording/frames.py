"""A recording as a table of pandas or a data set of xarray, where these are installed."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from sandbox.errors import SandboxError
from sandbox.samples.samples import TABLES, Samples


def chosen(run: Samples, quantities: tuple[str, ...]) -> list[str]:
    """The names that names and patterns stand for, each once; of none all that CSV files have.

    Raises:
        UnknownQuantityError: what fits nothing; with a near miss.
    """
    if quantities:
        return list(dict.fromkeys(name for each in quantities for name in run.names(each)))
    return [name for kind in TABLES for name in run.table(kind).names]


def to_pandas(run: Samples, quantities: tuple[str, ...]) -> Any:
    """See :meth:`sandbox.Recording.to_pandas`."""
    pandas = _library("pandas")
    names = chosen(run, quantities)
    table = pandas.DataFrame({name: run[name] for name in names},
                             index=pandas.Index(run.time, name="time"))
    table.attrs["units"] = {name: run.unit(name) for name in names}
    return table


def to_xarray(run: Samples, quantities: tuple[str, ...]) -> Any:
    """See :meth:`sandbox.Recording.to_xarray`."""
    xarray = _library("xarray")
    return xarray.Dataset(
        {name: ("time", run[name], {"units": run.unit(name)}) for name in chosen(run, quantities)},
        coords={"time": ("time", run.time, {"units": "s"})},
        attrs={"scene": run.mechanism.name, "title": run.mechanism.title})


def _library(name: str) -> Any:
    try:
        return import_module(name)
    except ImportError:
        raise SandboxError(f"to_{name}() needs the package {name!r}, which is not installed: "
                           f"pip install {name}; run[name] gives plain arrays without it",
                           code="missing-package") from None
