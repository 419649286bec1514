"""Cards, pictures, films and plots of scenes and runs for notebooks.

Texts of a scene never become markup; there is no script. Colours are those of the page, light or
dark.
"""

from __future__ import annotations

import base64
import html
import math
import os
import tempfile
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from numbers import Integral
from pathlib import Path
from typing import Any

import numpy as np

from sandbox.atomic_files import atomic_file, output_path
from sandbox.errors import OutputError, SandboxError
from sandbox.figure import signals
from sandbox.model.compile import compile_mechanism
from sandbox.model.joints import apart, place_in_slot
from sandbox.picture.film import instants, render
from sandbox.recording.builder import RecordingBuilder
from sandbox.recording.recording import Recording
from sandbox.samples.cables import lengths_at_start
from sandbox.samples.outcome import planned
from sandbox.samples.samples import TIME
from sandbox.samples.targets import initial, targets
from sandbox.scene.document import Scene
from sandbox.scene.expand import expand
from sandbox.scene.mechanism import Mechanism
from sandbox.values.numbers import number_from
from sandbox.wording import WrongValueError, counted, quoted

FILM_SIZE = (640, 480)  # default size of a film [pixels]: fits a cell of a notebook, some 100 kB
MIN_HEIGHT, MAX_HEIGHT = 200, 4000  # of the frame of a page [pixels]


@dataclass(frozen=True, repr=False)
class Media:
    """A picture, a film or a page as the bytes of a file, which a notebook shows."""

    data: bytes
    about: str  # alternative text
    ending: str  # of the file
    height: int = 0  # of the frame of a page [pixels]

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write it to a file with its own ending; OutputError if that fails."""
        file = output_path(path, "a picture")
        if file.suffix.lower() != self.ending:
            raise OutputError(f"{file}: this is a {self.ending} file", code="bad-picture")
        with atomic_file(file) as aside:
            aside.write_bytes(self.data)

    def __repr__(self) -> str:
        return f"<{self.ending[1:].upper()} of {self.about}, {len(self.data) / 1000:.0f} kB>"

    def _repr_html_(self, style: str = "max-width:100%") -> str:
        """An HTML element that needs no other file; scripts of a page do not reach the notebook."""
        if self.ending == ".html":
            return ('<iframe sandbox="allow-scripts allow-downloads" '
                    f'style="width:100%;height:{self.height}px;border:0" '
                    f'title="{html.escape(self.about)}" '
                    f'srcdoc="{html.escape(self.data.decode(), quote=True)}"></iframe>')
        return (f'<img style="{style}" alt="{html.escape(self.about)}" '
                f'src="data:image/{self.ending[1:]};base64,'
                f'{base64.b64encode(self.data).decode()}">')


def picture(run: Recording, at: float | str = "end", size: tuple[int, int] | None = None) -> Media:
    """See :meth:`sandbox.Recording.picture`."""
    if not len(run):
        raise OutputError("nothing was recorded, so there is nothing to draw", code="bad-time")
    found = instants(run, at)
    if len(found) != 1:
        raise OutputError(f"a picture shows one moment, at={quoted(at)} are {len(found)}; "
                          "sandbox.render draws several", code="bad-picture")
    when = found[0].time
    return _rendered(run, ".png", f"at t = {when:.6g} s", at=when, size=size)


def film(run: Recording, options: Mapping[str, Any]) -> Media:
    """See :meth:`sandbox.Recording.film`."""
    return _rendered(run, ".gif", f"up to t = {run.time[-1]:.6g} s",
                     **{"size": FILM_SIZE, **options})


def _rendered(run: Recording, ending: str, when: str, **options: Any) -> Media:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, f"run{ending}")
        render(run, path, **options)
        return Media(path.read_bytes(), f"{run.mechanism.name or 'a run'} {when}", ending)


def page(run: Recording, quantities: Sequence[str], height: int) -> Media:
    """See :meth:`sandbox.Recording.page`."""
    from sandbox.web.page import FoundOut, report

    if not isinstance(height, Integral) or not MIN_HEIGHT <= height <= MAX_HEIGHT:
        raise OutputError(f"height={quoted(height)} is no height of a page; pass {MIN_HEIGHT} to "
                          f"{MAX_HEIGHT} pixels", code="bad-picture")
    plots = list(dict.fromkeys(name for each in quantities for name in run.names(each)))
    text = report([run], [FoundOut(verdicts=run.verdicts, figures=run.audit)], plots)
    return Media(text.encode(), f"{run.mechanism.name or 'a run'} in motion", ".html", height)


def plot(
    run: Recording, quantities: tuple[str, ...], x: str = "", begin: float | str = 0.0,
    end: float | str = math.inf, width: float | str | None = None, title: bool = True,
) -> Any:
    """See :meth:`sandbox.Recording.plot`."""
    if not quantities:
        some = next(iter(run.names()), "finger.mcp.angle")
        raise OutputError(f"plot() needs quantities, such as {some!r} or '*.angle'; run.names() "
                          "lists them", code="bad-picture")
    names = list(dict.fromkeys(name for each in quantities for name in run.names(each)))
    label = run.mechanism.title or run.mechanism.name
    if x := "" if x == TIME else x:
        run.catalogue.find(x)
    return signals.draw(
        [signals.Plotted(label, run, targets(run))], names, x=x, titled=title,
        window=(_number("begin", begin, "time"), _number("end", end, "time")),
        width=None if width is None else _number("width", width, "length"))


def _number(name: str, value: float | str, dimension: str) -> float:
    """A number in SI."""
    if isinstance(value, float | int):
        return float(value)
    try:
        return number_from(value, dimension, {})
    except WrongValueError as error:
        raise OutputError(f"{name}={quoted(value)}: {error}", code="bad-picture") from None


SIZE = (440, 330)  # of the picture [pixels]
MAX_ROWS = 8  # rows of a table; failed expectations come first
MAX_LETTERS = 300  # of the description of a scene
CELL = "padding:2px 12px 2px 0;text-align:left;vertical-align:top"
QUIET = "opacity:.7"
GOOD, BAD = "#3d8b5f", "#c8505f"  # readable on white and on black


def card_of_run(run: Recording) -> str:
    """The card of a run: how it ended, its expectations, its audit."""
    judged, checks, rows = run.verdicts, run.audit, []
    for verdict in sorted(judged, key=lambda verdict: verdict.ok):
        unit = "" if verdict.unit == "1" else f" {verdict.unit}"
        value = f"{verdict.value:.6g}{unit}" if math.isfinite(verdict.value) else "–"
        allowed = "; ".join(filter(None, (verdict.allowed, "" if verdict.ok else verdict.reason)))
        rows.append([
            f'<span style="color:{GOOD}">pass</span>' if verdict.ok else
            f'<b style="color:{BAD}">FAIL</b>',
            *map(html.escape, (verdict.quantity, f"{verdict.statistic} {value}", allowed))])
    passed = f"{sum(check.verdict == 'pass' for check in checks)} checks passed"
    looks = [check.name for check in checks if check.verdict == "look"]
    warnings = f", {counted(len(looks), 'warning')}: {', '.join(looks)}" if looks else ""
    held, ended = sum(verdict.ok for verdict in judged), repr(run)[1:-1].partition(": ")[2]
    return _card(run.mechanism, [ended, run.info.reason], _drawn(run), [
        _line(f"<b>{held} of {len(judged)} expectations passed</b>",
              f"color:{GOOD if held == len(judged) else BAD}") if judged else
        _line("the scene expects nothing", QUIET),
        _line(html.escape(passed + warnings), f"color:{BAD}" if looks else QUIET),
        _table(["", "expectation of", "value", "range"], rows),
        *(_line(html.escape(note), QUIET) for note in run.notes)])


def card_of_scene(scene: Mechanism) -> str:
    """The card of a scene or a mechanism: its picture at the start, its elements."""
    lines = [scene.counted or "nothing in it"]
    parameters = scene.parameters if isinstance(scene, Scene) else {}
    try:
        mechanism = expand(scene) if isinstance(scene, Scene) else scene
        if isinstance(scene, Scene) and scene.parts:
            lines.append(f"with its parts spelled out: {mechanism.counted}")
        # forces are 0 at the start: a meter would show a wrong value
        view = mechanism.view.model_copy(update={"meters": ()})
        drawn = _drawn(at_start(mechanism.model_copy(update={"view": view})))
    except (SandboxError, ValueError, KeyError) as error:  # one that is built, and not sound
        drawn = _line(html.escape(f"no picture: {error}"), QUIET)
    lines.append(f"to run for {scene.run.duration:g} s in steps of {1e3 * scene.run.step:g} ms")
    about = scene.about if len(scene.about) <= MAX_LETTERS else f"{scene.about[:MAX_LETTERS]}…"
    return _card(scene, lines, drawn, [
        _line(html.escape(about)), _table(["parameter", "value (SI)"], [
            [html.escape(name), f"{value:.6g}"] for name, value in parameters.items()])])


def _card(mechanism: Mechanism, lines: Iterable[str], drawn: str, below: Iterable[str]) -> str:
    title = html.escape(mechanism.title or mechanism.name or "A scene without a name")
    name = html.escape(mechanism.name) if mechanism.title else ""
    head = _line(f"<b>{title}</b> <span style=\"{QUIET}\">{name}</span>")
    text = "".join(_line(html.escape(line), QUIET) for line in lines if line)
    return (f'<div style="max-width:960px;line-height:1.4">{head}{text}'
            f'<div style="display:flex;flex-wrap:wrap;gap:4px 20px">'
            f'<div style="flex:0 1 {SIZE[0]}px;min-width:0">{drawn}</div>'
            f'<div style="flex:1 1 320px;min-width:0;overflow-x:auto">{"".join(below)}</div>'
            "</div></div>")


def _line(content: str, style: str = "") -> str:
    return f'<div style="{style}">{content}</div>'


def _drawn(run: Recording) -> str:
    """The picture of a run's end, or why there is none."""
    try:
        return picture(run, size=SIZE)._repr_html_("max-width:100%;height:auto;border-radius:4px")
    except SandboxError as error:
        return _line(html.escape(f"no picture: {error}"), QUIET)


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A table of cells that are markup already, with the first rows."""
    if not rows:
        return ""
    head_cells = "".join(f'<th style="{CELL};{QUIET};font-weight:normal">{each}</th>'
                         for each in head)
    # the last cell may hold a sentence
    body = "".join("<tr>" + "".join(
        f'<td style="{CELL}{";white-space:nowrap" * (k < len(row) - 1)}">{cell}</td>'
        for k, cell in enumerate(row)) + "</tr>" for row in rows[:MAX_ROWS])
    more = len(rows) - MAX_ROWS
    return (f'<table style="border-collapse:collapse;margin:6px 0;font:inherit">'
            f"<thead><tr>{head_cells}</tr></thead><tbody>{body}</tbody></table>"
            + (_line(f"and {more} more", QUIET) if more > 0 else ""))


def at_start(mechanism: Mechanism) -> Recording:
    """A recording with one sample at t = 0, without forces; nothing is simulated."""
    model = compile_mechanism(mechanism)
    lengths = lengths_at_start(model)
    builder = RecordingBuilder(mechanism, 1, {
        "body_centre": model.bodies.centre, "body_mass": model.bodies.mass,
        "body_inertia": model.bodies.inertia, "tendon_initial": lengths, "tendon_rest": lengths,
    }, model=model)
    arrays = {key: np.zeros_like(array) for key, array in builder.blank(1).items()}
    arrays["body_pose"][0] = model.bodies.pose
    arrays["tendon_length"][0] = lengths
    joints = np.arange(len(model.joints.name))
    arrays["joint_length"][0] = np.hypot(*apart(model, joints, model.bodies.pose))
    for j, path in enumerate(model.joints.path):
        if path is not None:
            arrays["joint_length"][0, j] = place_in_slot(model, j, model.bodies.pose).along
    arrays["held"][0] = [not each.released for each in mechanism.holding
                         if each.name in mechanism.releasable]
    builder.put(0, arrays)
    run = builder.finish(np.zeros(1), planned(mechanism.run, complete=False))
    values = np.array([[initial(run, drive.name) for drive in mechanism.drives]])
    return Recording(mechanism, {**run.arrays, "drive_value": values.reshape(1, -1)}, run.info,
                     model=model)
