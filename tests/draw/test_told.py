"""What pictures tell of forces that are worked out: scales, numbers, marks of what holds."""

from __future__ import annotations

from typing import Any

import numpy as np

import sandbox
from sandbox.picture.tensions import largest_tension
from sandbox.recording.recording import Recording
from tests.draw.painted import frames_of


def _run(**lists: Any) -> Recording:
    return sandbox.simulate(sandbox.expand(sandbox.load_scene({
        "run": {"duration": 0.1, "step": 1e-3, "sample_rate": 1000}, "gravity": [0, 0],
        "bodies": [{"name": "wall", "motion": "fixed"},
                   {"name": "w", "mass": 1.0, "inertia": 1e-2}],
        "joints": [{"type": "pin", "name": "p", "a": "wall", "b": "w", "on_a": [0, 0]}],
        **lists})))


def test_a_short_spike_does_not_wash_out_what_is_carried_else() -> None:
    """5 % of the run at 100 N, the rest at 1 N: the top is what twice 1 N is rounded up to."""
    tension = np.where(np.arange(1000) < 50, 100.0, 1.0)[:, None]
    assert largest_tension(tension) == 2.0
    assert largest_tension(tension[::-1]) == 100.0  # the last picture is not beyond the scale


def test_what_may_be_let_go_has_its_mark_where_it_holds_on() -> None:
    """Full until the event at 50 ms, hollow after it; a joint that cannot go has none."""
    run = _run(events=[{"name": "e", "at": 0.05, "release": ["p"]}])
    renderer = frames_of(run, size=(800, 600), enlarge=1)
    early, late = (renderer.draw(t).copy().astype(int) for t in (0.02, 0.09))
    x, y = (round(float(v)) for v in renderer.picture.camera.to_pixels(np.zeros((1, 2)))[0])
    # left of the pin, within the diamond
    full, hollow = (picture[y, x - 5].sum() for picture in (early, late))
    assert full < 200
    assert hollow > 700
    assert "holds" not in frames_of(_run()).picture.out.glyphs
