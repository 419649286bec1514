"""Hands of linkages, rolling joints and fluid, and other authors': held at any step, and no other.

That their expectations hold, are audited and run twice alike is tested with all shipped scenes.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from sandbox.engine.simulate import simulate
from sandbox.mechanics.four_bar import FourBar
from sandbox.recording.recording import Recording
from sandbox.samples.expectations import verdicts
from sandbox.scene.library import shipped_scenes
from sandbox.scene.read.load import load_scene

FAULTS: dict[str, tuple[dict[str, Any], set[str]]] = {
    "linkage": ({"templates.finger.joints[horn1].on_b": [0, -0.0091]},
                {"off.x", "share", "on_palm"}),
    "adaptive_linkage": ({"templates.finger.joints[shaft].damping": 0.001,
                          "templates.finger.joints[horn].on_b": [0, -0.0121]},
                         {"right.shaft.angle", "right.distal/disc.normal"}),
    "soft_synergy": ({"templates.finger.springs[back2].on_a": [0.0091, 0.026]},
                     {"right.y2", "moment2"}),
    "fluidic": ({"templates.two.lines[bellows2].chambers[0].displacement": 0.121e-6},
                {"middle.pip.angle", "index.distal/disc.normal"}),
    "birglen_regions": ({"templates.finger.tendons[tendon].guides[0].radius": 0.00605},
                        {"finger1.pip.angle", "finger2.distal/finger2.disc.normal"}),
    "sdm": ({"templates.finger.springs[flexure2].rest_angle": "46 deg"},
            {"right.pip.angle", "left.distal/disc.normal", "left.proximal/disc.normal"}),
}
"""For each scene: a fault, and some of the quantities that are no longer as expected."""


def of(name: str, **overrides: Any) -> Recording:
    return simulate(load_scene(shipped_scenes()[name], overrides=overrides))


@pytest.mark.parametrize("name", FAULTS)
def test_a_planted_fault_is_found(name: str) -> None:
    overrides, broken = FAULTS[name]
    assert broken <= {verdict.quantity for verdict in verdicts(of(name, **overrides))
                      if not verdict.ok}


@pytest.mark.parametrize("step", ["1 ms", "2 ms"])
@pytest.mark.parametrize("name", FAULTS)
def test_the_verdict_does_not_hang_on_the_step(name: str, step: str) -> None:
    """What is determined by statics cannot depend on how finely it is reached."""
    assert not [verdict for verdict in verdicts(of(name, **{"run.step": step})) if not verdict.ok]


@pytest.mark.parametrize(("name", "overrides"), [
    ("linkage", {"parameters.r": "29 mm", "parameters.torque": "0.2 N m"}),
    ("adaptive_linkage", {"parameters.r": "34 mm", "parameters.torque": "0.15 N m"}),
    ("soft_synergy", {"parameters.cord": "0.8 N/mm", "parameters.first": "4.4 mm"}),
    ("fluidic", {"parameters.pressure": "2.3 bar"}),
    ("birglen_regions", {"parameters.pull": "11 N", "parameters.rho1": "57 mm"}),
    ("sdm", {"parameters.r": "30 mm", "parameters.off": "-4 mm", "parameters.pull": "30 N"}),
])
def test_expectations_follow_the_parameters(name: str, overrides: dict[str, Any]) -> None:
    """They are formulas, not numbers that this one run happens to give."""
    assert not [verdict for verdict in verdicts(of(name, **overrides)) if not verdict.ok]


def test_linkages_turn_as_the_four_bar_functions_say() -> None:
    """Joints held to 1e-8 m of 8 mm leave 1e-6 rad."""
    run = of("linkage")
    for near, far, length, foot, horn in (("mcp", "pip", 0.032, 0.009, 0.009),
                                          ("pip", "dip", 0.022, 0.007, 0.0085)):
        # seen from the far hinge towards the near one, the finger closing counter-clockwise
        bar = FourBar(length, horn, float(np.hypot(length, foot + horn)), foot)
        turned = bar.first_angle(-np.pi / 2 - run[f"right.{near}.angle"]) - np.pi / 2
        assert np.allclose(np.angle(np.exp(1j * (turned - run[f"right.{far}.angle"]))), 0,
                           rtol=0, atol=1e-6)


@pytest.mark.parametrize("mass", [0.02, 0.2])
def test_the_soft_hand_carries_its_disc_whatever_that_weighs(mass: float) -> None:
    """At rest it counts no more: the plane lies flat."""
    light, other = of("soft_synergy"), of("soft_synergy", **{"bodies[disc].mass": mass})
    assert other["disc.x"][-1] == pytest.approx(light["disc.x"][-1], abs=1e-6)
