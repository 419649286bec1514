"""The Recording: samples that can be saved with a verdict and an audit, and loaded again."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from functools import cached_property
from typing import Any, Self

from sandbox.atomic_files import output_path
from sandbox.audit.audit import Figure, audit
from sandbox.errors import OutputError, optional
from sandbox.recording import store
from sandbox.recording.new_run import writing
from sandbox.samples.expectations import Verdict, verdicts
from sandbox.samples.samples import TABLES, Samples


class Recording(Samples):
    """A run: the mechanism, its samples read by name, its files, its pictures."""

    @cached_property
    def verdicts(self) -> list[Verdict]:
        """The verdicts on the scene's expectations, in their order, then that of a stop."""
        return verdicts(self)

    @cached_property
    def audit(self) -> list[Figure]:
        """The figures of the audit, in the order of docs/audit.md."""
        return audit(self)

    def save(
        self, directory: str | os.PathLike[str], *, parameters: Mapping[str, float] | None = None
    ) -> None:
        """Judge and audit the run and write all its files; see :mod:`sandbox.recording.store`.

        An earlier run in the directory stays whole until all of this one is on the disk.

        Raises:
            OutputError: no path, or it cannot be written, or another run is being written there.
        """
        folder = output_path(directory, "a recording")
        verdicts, figures = self.verdicts, self.audit
        with writing(folder) as new:
            store.save_data(self, new.aside)
            store.save_summary(self, new.aside, verdicts=verdicts, figures=figures,
                               parameters=parameters)
            new.publish()

    @classmethod
    def load(cls, directory: str | os.PathLike[str]) -> Self:
        """The recording that was saved into ``directory``; incomplete if it has no ``run.json``.

        Raises:
            OutputError: no path, or there is none, it cannot be read, or its files are of two runs.
        """
        folder = output_path(directory, "a recording")
        try:
            return cls(*store.load(folder))
        except ValueError as error:  # arrays that do not fit the mechanism
            raise OutputError(f"{folder} is damaged: {error}", code="run-damaged") from None

    def to_pandas(self, *quantities: str) -> Any:
        """A ``pandas.DataFrame``: a column for each quantity, SI, the index ``time`` [s].

        ``attrs["units"]`` has the unit of each column.

        Args:
            quantities: names and patterns; by default all but pairs and how well objects are held.

        Raises:
            SandboxError: pandas is not installed.
            UnknownQuantityError: what fits nothing; with a near miss.
        """
        pandas, names = optional("pandas", "pandas"), self._chosen(quantities)
        table = pandas.DataFrame({name: self[name] for name in names},
                                 index=pandas.Index(self.time, name="time"))
        table.attrs["units"] = {name: self.unit(name) for name in names}
        return table

    def to_xarray(self, *quantities: str) -> Any:
        """An ``xarray.Dataset``: a variable over ``time`` for each quantity, SI, with its unit.

        Arguments and errors are those of :meth:`to_pandas`.
        """
        return optional("xarray", "xarray").Dataset(
            {name: ("time", self[name], {"units": self.unit(name)})
             for name in self._chosen(quantities)},
            coords={"time": ("time", self.time, {"units": "s"})},
            attrs={"scene": self.mechanism.name, "title": self.mechanism.title})

    def _chosen(self, quantities: tuple[str, ...]) -> list[str]:
        """Names that names and patterns stand for, each once; of none all that CSV files have."""
        if quantities:
            return list(dict.fromkeys(name for each in quantities for name in self.names(each)))
        return [name for kind in TABLES for name in self.table(kind).names]

    def plot(
        self, *quantities: str, x: str = "", begin: float | str = 0.0,
        end: float | str = math.inf, width: float | str | None = None, title: bool = True,
    ) -> Any:
        """A ``matplotlib.figure.Figure`` of quantities, by default against time; a panel a unit.

        Targets are dashed. A notebook shows it; ``savefig`` writes it.

        Args:
            quantities: names and patterns such as ``finger.*.angle``.
            x: the quantity that they are drawn against; time by default.
            begin: first instant that is shown [s], or a text such as ``"0.8 s"``.
            end: last instant.
            width: of the figure [m], or a text such as ``"85 mm"``; 120 mm by default.
            title: whether the scene's title stands above.

        Raises:
            OutputError: no quantities, an invalid time or width, too few samples, or too many
                curves for one panel.
            UnknownQuantityError: what fits nothing; with a near miss.
        """
        from sandbox.notebook import plot

        return plot(self, quantities, x, begin, end, width, title)

    def picture(self, at: float | str = "end", *, size: tuple[int, int] | None = None) -> Any:
        """A PNG of one moment, which a notebook shows; ``save`` writes it to a file.

        Args:
            at: the instant: seconds, a time such as ``"0.8 s"``, ``"start"`` or ``"end"``.
            size: width and height [pixels]; the scene's view by default.

        Raises:
            OutputError: nothing was recorded, or an instant that is not in the run.
        """
        from sandbox.notebook import picture

        return picture(self, at, size)

    def film(self, **options: Any) -> Any:
        """A GIF of the run, which a notebook shows; ``save`` writes it to a file.

        Args:
            options: those of :func:`sandbox.render`, such as ``speed=0.5``, ``size=(640, 480)``.

        Raises:
            OutputError: nothing was recorded, or what no view can have.
        """
        from sandbox.notebook import film

        return film(self, options)

    def page(self, *quantities: str, height: int = 760) -> Any:
        """A page that plays the run, as ``sandbox report`` does.

        A notebook shows it in a frame; ``save`` writes it to a file.

        Args:
            quantities: names and patterns that are plotted at once; by default what the scene
                expects.
            height: of the frame [pixels], 200 to 4000.

        Raises:
            OutputError: nothing was recorded, or an invalid height.
            UnknownQuantityError: what fits nothing; with a near miss.
        """
        from sandbox.notebook import page

        return page(self, quantities, height)

    def __repr__(self) -> str:
        samples = f"{len(self)} sample{'s' * (len(self) != 1)}"
        until = f" to t = {self.time[-1]:.6g} s" if len(self) else ""
        return (f"<Recording of {self.mechanism.name!r}: {samples}{until}, the run "
                f"{self.info.status.value}>")

    def _repr_html_(self) -> str:
        from sandbox.notebook import card_of_run

        return card_of_run(self)
