"""Figures of runs under control: what they say, and that nothing covers anything."""

from __future__ import annotations

from itertools import combinations
from typing import Any

import numpy as np
import pytest

from sandbox.draw.figure import comparison, signals, style
from sandbox.draw.figure.comparison import Compared
from sandbox.draw.figure.signals import Plotted
from sandbox.errors import OutputError
from sandbox.paper import finger_control_figure as finger_control
from sandbox.paper.figures import FIGURES
from sandbox.recording.recording import Recording
from sandbox.samples.outcome import Happened
from sandbox.samples.targets import targets
from tests.draw.written import clashes, texts
from tests.recording import sample
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
BACK = 0.2 * np.log(0.1 / 0.02)
"""When a tenth of the target has become the band of 2 % [s]: 0.322."""


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


def test_an_event_that_sets_a_target_only_is_marked_and_nothing_else() -> None:
    moved = {"name": "again", "at": 2.0, "set": {"mcp_loop.target": float(TARGETS[0])}}
    figure, found = finger_control.draw(loaded(moved), {})
    assert found["finger.mcp.angle"].settling == pytest.approx(2 + BACK, abs=1e-6)
    assert "settled at 2.32 s" in texts(figure)
    assert "again" in texts(figure)
    # a load, and a new target later: what settles is the whole run
    later = {"name": "later", "at": 2.1, "set": {"mcp_loop.target": float(1.001 * TARGETS[0])}}
    assert finger_control.draw(loaded(LOADED, later), {})[1]["finger.mcp.angle"].settling > 2


def test_what_does_not_come_back_and_what_had_not_settled() -> None:
    figure, found = finger_control.draw(loaded(LOADED, lag=9.0), {})
    assert "settled at 0.495 s;\nnot back" in texts(figure)
    assert clashes(figure) == []
    early = {**LOADED, "at": 0.3}
    found = finger_control.draw(loaded(early, since=0.3), {})[1]
    assert found["finger.pip.angle"].settling == pytest.approx(0.495, abs=5e-4)


def test_names_of_many_events() -> None:
    events = [{"name": f"an_event_with_a_very_long_name_{i}", "at": at, "set": {"pull": 15}}
              for i, at in enumerate([0.1, 1.0, 1.4, 1.5, 1.5, 1.6, 2.0, 2.9])]
    figure, _ = finger_control.draw(loaded(*events), {})
    assert sum("an_event" in text for text in texts(figure)) == 8
    assert clashes(figure) == []
    figure, _ = finger_control.draw(loaded(*events, LOADED), {})
    assert not any("an_event" in text or "Grey" in text for text in texts(figure))
    assert clashes(figure) == []


def test_without_loops_and_drives() -> None:
    """Figure 18's kind: stiffness is the springs' own, targets come by hand."""
    content = scene(controllers=[], drives=[])
    figure, found = finger_control.draw(recording(content), {"finger.tendon.shortening": 0.002971})
    said = texts(figure)
    assert list(found) == ["finger.tendon.shortening"]
    assert {"target 2.971", "mcp  15000", "pip  5000", "dip  1100"} <= set(said)
    assert any("Tendon tension" in text for text in said)
    assert clashes(figure) == []
    figure, found = finger_control.draw(recording(content), {})
    assert found == {}
    assert not any("Shaded" in text for text in texts(figure))


def test_stiffnesses_that_are_alike_are_shown_on_a_linear_axis() -> None:
    content = scene(controllers=[])
    for drive in content["drives"][1:]:
        drive["value"] = 300
    run = recording(content)
    figure, _ = finger_control.draw(run, {})
    assert figure.axes[4].get_yscale() == "log"  # what was recorded counts
    content["drives"] = content["drives"][:1]
    content["parts"][0]["springs"]["stiffness"] = [300, 290, 310]
    figure, _ = finger_control.draw(recording(content), {})
    assert figure.axes[4].get_yscale() == "linear"
    assert clashes(figure) == []  # labels that nearly coincide are moved apart


def test_the_finger_that_is_led_is_the_one_shown() -> None:
    hand = scene()
    second = {**hand["parts"][0], "name": "other", "at": [0, 0.2]}
    hand["parts"] = [second, *hand["parts"]]
    run = recording(hand)
    roles = finger_control.roles_of(run, {"finger.mcp.angle": 0})
    assert roles.tendon == "finger.tendon"
    assert roles.joints == ("finger.mcp", "finger.pip", "finger.dip")
    assert roles.pull == "pull"
    # led by the shortening; else the one that is pulled
    assert finger_control.roles_of(
        run, {"other.tendon.shortening": 0}).tendon == "other.tendon"
    assert finger_control.roles_of(run, {}).tendon == "finger.tendon"


def test_of_two_tendons_that_pull_against_each_other_the_one_that_got_shorter() -> None:
    content = scene(controllers=[])
    back = [{"body": f"finger.{part}", "at": [0, 0.005]}
            for part in ("palm", "proximal", "middle", "distal")]
    content["tendons"] = [{"name": "back", "guides": back}]
    content["drives"].append({"type": "pull", "name": "against", "tendon": "back", "value": 1})
    run = recording(content)
    names = [tendon.name for tendon in run.mechanism.tendons]
    longer = run.arrays["tendon_length"].copy()
    longer[:, names.index("back")] = 0.11
    run = Recording(run.mechanism, {**run.arrays, "tendon_length": longer}, run.info)
    assert set(names) == {"back", "finger.tendon"}
    assert finger_control.roles_of(run, {}).pull == "pull"
    longer[:, names.index("back")] = 0.09
    longer[:, names.index("finger.tendon")] = 0.11
    run = Recording(run.mechanism, {**run.arrays, "tendon_length": longer}, run.info)
    assert finger_control.roles_of(run, {}).pull == "against"


def test_rotary_springs_and_other_hinges() -> None:
    """The sample's tendon goes from the palm to the distal phalanx: past no hinge of its own."""
    with pytest.raises(OutputError, match="needs a tendon that passes hinges"):
        finger_control.draw(sample.recording(), {})
    tendon = {"name": "cord", "guides": [{"body": "finger1.proximal"}, {"body": "finger1.distal"}]}
    run = sample.recording(tendons=[tendon], drives=[])
    rows = finger_control.stiffnesses(run, finger_control.roles_of(run, {}).joints)
    assert [(row.label, row.unit, row.value[0]) for row in rows] == [("pip", "N m/rad", 0.1)]


def test_too_short_a_run() -> None:
    run = recording().part(0, 1)
    with pytest.raises(OutputError, match="1 samples"):
        finger_control.draw(run, {})
    with pytest.raises(OutputError, match="1 samples"):
        signals.draw([Plotted("run", run, {})], ["finger.mcp.angle"])


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


def test_many_quantities() -> None:
    run = recording()
    names = run.match("finger.*")
    by_unit = [name for name in names if run.unit(name) == "N"]
    assert len(by_unit) > 14
    assert clashes(signals.draw([Plotted("run", run, {})], by_unit[:30])) == []
    pairs = [f"finger.{a}/finger.{b}.{what}" for what in ("normal", "tangential")
             for a, b in combinations(("palm", "proximal", "middle", "distal"), 2)]
    with pytest.raises(OutputError, match="too many for one panel"):
        signals.draw([Plotted("run", run, {})], [*by_unit, *pairs])


def test_runs_laid_over_one_another() -> None:
    runs = [recording(reach=(1, 1, 0.5)), recording(scene("other"), zeta=0.3, omega=9),
            recording(scene("free", controllers=[]), zeta=0.9)]
    compared = [Compared(run.mechanism.name, run, targets(run)) for run in runs]
    names = list(targets(runs[0]))
    figure = comparison.draw(compared, [*names, "finger.tendon.shortening"], ["k1", "k2", "k3"])
    said = texts(figure)
    assert {"controlled", "other", "free", "5°", "10°", "15°"} <= set(said)
    assert len([axes for axes in figure.axes if axes.get_visible()]) == 7
    circles = [line for line in figure.axes[2].lines if line.get_marker() == "o"]
    assert len(circles) == 1  # one does not settle, one has no target
    found = targets(runs[1])["finger.dip.angle"][0]
    assert np.degrees(found) == pytest.approx(circles[0].get_ydata()[0], rel=0.021)
    assert clashes(figure) == []


def test_targets_that_differ_have_the_colours_of_their_runs() -> None:
    one, other = recording(), recording()
    compared = [Compared("a", one, targets(one)),
            Compared("b", other, targets(other, {"finger.mcp.angle": 0.1}))]
    figure = comparison.draw(compared, ["finger.mcp.angle"], [])
    dashed = [line.get_color() for line in figure.axes[0].lines if line.is_dashed()]
    assert dashed == [style.hue(0), style.hue(1)]


def test_many_runs_with_long_names() -> None:
    runs = [Compared(f"a_rather_long_name_of_a_scene_{i}", recording(), {}) for i in range(8)]
    figure = comparison.draw(runs, ["finger.mcp.angle", "finger.pip.angle"], [])
    assert clashes(figure) == []


def test_too_many_panels() -> None:
    run = recording()
    with pytest.raises(OutputError, match="--quantity"):
        comparison.draw([Compared("a", run, {})], run.names()[:30], [])
