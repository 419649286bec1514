"""Figures of runs under control: what they say, and that nothing covers anything."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from sandbox.draw.figure import signals
from sandbox.draw.figure.signals import Plotted
from sandbox.paper import finger_control_figure as finger_control
from sandbox.paper.figures import FIGURES
from sandbox.recording.recording import Recording
from sandbox.samples.outcome import Happened
from sandbox.samples.targets import targets
from tests.draw.written import clashes, texts
from tests.samples.controlled import TARGETS, recording, scene

LONG = ["finger.mcp.angle", "finger.pip.angle", "finger.tendon.shortening", "k1.value", "k2.value"]


def test_the_finger_under_control() -> None:
    run = recording(reach=(1, 1, 0.5))
    figure, found = FIGURES["finger-control"].draw(run, {})
    said = texts(figure)
    assert [f"finger.{joint}.angle" for joint in ("mcp", "pip", "dip")] == list(found)
    assert said.count("settled at 0.990 s") == 2
    assert said.count("does not settle") == 1
    assert {"target 5°", "target 10°", "target 15°", "7.5°", "15 N", "constant"} <= set(said)
    assert {"k1  15000", "k2  5000", "k3  1100"} <= set(said)
    assert [axes.get_ylabel() for axes in figure.axes] == [
        "shortening [mm]", *["rotation [deg]"] * 3, "stiffness [N/m]", "pull [N]"]
    assert figure.axes[4].get_yscale() == "log"
    # the line that marks the settling stands where it was found
    marks = [line.get_xdata()[0] for line in figure.axes[1].lines if len(line.get_xdata()) == 2
             and line.get_xdata()[0] == line.get_xdata()[1]]
    assert marks == [found["finger.mcp.angle"].settling]
    assert clashes(figure) == []


def loaded(*events: dict[str, Any], since: float = 2.0, lag: float = 0.2) -> Recording:
    """Settled, then the knuckle is thrown back by a tenth, which goes with exp(-t/lag)."""
    run = recording(scene(events=list(events)), omega=12, info={
        "events": tuple(Happened(event["name"], event["at"]) for event in events)})
    angle = run.arrays["joint_angle"].copy()
    column = [joint.name for joint in run.mechanism.joints].index("finger.mcp")
    late = run.time > since
    angle[late, column] -= 0.1 * TARGETS[0] * np.exp((since - run.time[late]) / lag)
    return Recording(run.mechanism, {**run.arrays, "joint_angle": angle}, run.info)


LOADED = {"name": "load", "at": 2.0, "set": {"pull": 15}}


def test_a_load_does_not_spoil_the_settling() -> None:
    """The last time outside counts from the event; linear between samples to h^2 / (8 lag)."""
    calm = finger_control.draw(recording(omega=12), {})[1]
    figure, found = finger_control.draw(loaded(LOADED), {})
    said = texts(figure)
    assert found["finger.mcp.angle"].settling == calm["finger.mcp.angle"].settling
    assert "settled at 0.495 s;\nback after 0.322 s" in said
    assert said.count("settled at 0.495 s") == 2  # the other joints do not feel it
    assert said.count("load") == 1
    assert any("Grey lines: events" in text and "back after it" in text for text in said)
    for axes in figure.axes:
        assert [2.0, 2.0] in [list(line.get_xdata()) for line in axes.lines]
    assert clashes(figure) == []


def test_any_quantities() -> None:
    run = recording()
    figure = signals.draw([Plotted("run", run, targets(run))], LONG)
    assert [axes.get_ylabel() for axes in figure.axes] == [
        "angle [deg]", "length [mm]", "stiffness [N/m]"]
    assert set(LONG) <= set(texts(figure))
    curve, dashed = figure.axes[0].lines[:2]
    assert curve.get_ydata()[-1] == pytest.approx(5, abs=1e-3)
    assert dashed.get_ydata() == pytest.approx(5)
    assert clashes(figure) == []
