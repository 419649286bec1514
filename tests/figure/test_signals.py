"""Quantities against time or one another: the right samples, events where they were."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from sandbox.errors import OutputError
from sandbox.figure import style
from sandbox.figure.signals import MAX_EVENTS, MAX_PANELS, Plotted, draw
from sandbox.model.catalogue import UnknownQuantityError
from sandbox.recording.recording import Recording
from sandbox.samples.outcome import Happened
from tests.figure.written import clashes, texts, written
from tests.samples.controlled import recording, scene

MCP = "finger.mcp.angle"


def happening(*times: float) -> Recording:
    """A run with an event at each of these times [s]."""
    events = [{"name": f"event{i}", "at": at, "set": {"pull": 15}} for i, at in enumerate(times)]
    return recording(scene(events=events), info={
        "events": tuple(Happened(event["name"], event["at"]) for event in events)})


def plotted(*runs: Recording) -> list[Plotted]:
    return [Plotted(f"run {i}", run, {}) for i, run in enumerate(runs)]


def test_a_window_holds_its_samples_and_no_others() -> None:
    run = recording()
    axes, = draw(plotted(run), [MCP], window=(0.5, 1.25)).axes
    time, shown = axes.lines[0].get_data()
    inside = (run.time >= 0.5) & (run.time <= 1.25)
    assert time == pytest.approx(run.time[inside])
    assert shown == pytest.approx(np.degrees(run[MCP][inside]))
    assert axes.get_xlim() == (0.5, 1.25)
    low, high = axes.get_ylim()  # as high as what is seen, and not as all of it
    assert high - low == pytest.approx(1.14 * np.ptp(shown))


def drawn(figure: Any) -> list[float]:
    """What a millimetre of each axis is, x over y, once the figure is laid out."""
    figure.draw_without_rendering()
    found = []
    for axes in figure.axes:
        box = axes.get_window_extent()
        for line in axes.lines:  # all of it is in sight
            assert (axes.dataLim.min >= (axes.get_xlim()[0], axes.get_ylim()[0])).all(), line
            assert (axes.dataLim.max <= (axes.get_xlim()[1], axes.get_ylim()[1])).all(), line
        found.append(float(np.ptp(axes.get_xlim()) / box.width
                           / (np.ptp(axes.get_ylim()) / box.height)))
    return found


def moved(x: float, y: float) -> tuple[Recording, str]:
    """A run whose first body goes along an ellipse [m], almost once, and the body's name."""
    run = recording()
    turn = np.linspace(0.0, 6.0, len(run))
    poses = run.arrays["body_pose"].copy()
    poses[:, 0, :2] = np.column_stack([x * np.cos(turn), y * np.sin(turn)])
    return (Recording(run.mechanism, {**run.arrays, "body_pose": poses}, run.info),
            run.mechanism.bodies[0].name)


def test_a_path_in_the_plane_has_one_scale(capsys: pytest.CaptureFixture[str]) -> None:
    for wide in (3.0, 0.4):
        run, body = moved(wide, 1.0)
        x, y = f"{body}.x", f"{body}.y"
        figure = draw(plotted(run), [y, "k1.value"], x=x)
        path, other = drawn(figure)
        assert path == pytest.approx(1.0)
        assert other != pytest.approx(1.0, rel=0.5)
        first, last = figure.axes
        assert (last.get_xlabel(), first.get_ylabel()) == (f"{x} [m]", f"{y} [m]")
    assert capsys.readouterr().err == ""  # of matplotlib, about limits that gave way


def test_events_stand_where_they_were_and_too_many_are_told() -> None:
    times = [0.1 * k for k in range(1, 2 * MAX_EVENTS + 1)]
    run = happening(*times)
    assert any(f"{len(times)} events are not marked" in text
               for text in texts(draw(plotted(run), [MCP])))
    figure = draw(plotted(run), [MCP, "k1.value"], window=(0.25, 0.45))
    for axes in figure.axes:
        assert [line.get_xdata()[0] for line in axes.lines
                if len(line.get_xdata()) == 2] == pytest.approx([0.3, 0.4])
    assert "Vertical lines: event2 at 0.3 s, event3 at 0.4 s." in texts(figure)
    assert clashes(figure) == []


def test_a_run_that_does_not_have_it_is_left_out() -> None:
    free = recording(scene("free", controllers=[], drives=[]))
    runs = [*plotted(free), Plotted("led", recording(), {})]
    axes, = draw(runs, ["k1.value"]).axes
    assert [line.get_color() for line in axes.lines] == [style.hue(1)]
    with pytest.raises(UnknownQuantityError):
        draw(runs, ["k9.value"])
    other = recording(scene("other", meters=[{"name": "two", "value": "=2"}], drives=[],
                            controllers=[]))
    with pytest.raises(OutputError, match=r"no run has both .k1\.value. and .two."):
        draw(plotted(recording(), other), ["k1.value"], x="two")


def test_too_much_or_too_little_is_told() -> None:
    run = recording()
    with pytest.raises(OutputError, match=r"the first is at .* the last at"):
        draw(plotted(run), [MCP], window=(50.0, 60.0))
    with pytest.raises(OutputError, match="13 panels are too many"):
        draw(plotted(run, run), run.names()[:MAX_PANELS + 1])


@pytest.mark.parametrize("names", [
    [MCP], [MCP, "finger.dip.angle", "finger.tendon.tension"],
    [f"finger.{body}.contact.{force}" for body in ("proximal", "middle", "distal")
     for force in ("normal", "tangential", "fx")]], ids=len)
def test_a_figure_of_a_column_has_its_names_above_and_nothing_outside(names: list[str]) -> None:
    figure = draw(plotted(recording()), names, width=0.085, titled=False)
    assert figure.get_figwidth() * 25.4 == pytest.approx(85)
    figure.draw_without_rendering()
    assert figure.axes[0].get_window_extent().width > 0.7 * figure.bbox.width
    for axes in figure.axes:
        legend = axes.get_legend()
        words = {text.get_text() for text in legend.get_texts()} if legend else set()
        assert (words or {axes.get_title(loc="left")}) <= set(names)
        assert axes.get_window_extent().height / figure.dpi * 25.4 == pytest.approx(38, abs=1)
    assert clashes(figure) == []
    assert min(text.get_fontsize() for text in written(figure)) >= 7
