"""The audit against closed forms: what it calls right is right, and its errors fall with the step.

Thresholds are the audit's own; each test says what the figure has to be.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from sandbox.audit.audit import Figure, audit
from sandbox.audit.evidence import Evidence
from sandbox.audit.rest import Rest, beyond_joint, grip_of
from sandbox.engine.simulate import simulate
from sandbox.mechanics.statics import contact_forces
from sandbox.recording.recording import Recording
from tests.support.mechanisms import G, finger, fixed, mass, mechanism
from tests.support.reference import SET_G, SET_G_TABLE

H = 5e-4


def figures(run: Recording) -> dict[str, Figure]:
    return {figure.name: figure for figure in audit(run)}


@cache
def pendulum(step: float) -> Recording:
    """A bob of mass m at r from its pin, let go level; every step recorded."""
    return simulate(mechanism(
        duration=0.6, step=step, gravity=(0.0, -G), run={"sample_rate": 1 / step},
        bodies=[fixed("wall"), mass("bob", 0.2, (0.3, 0.0))],
        joints=[{"type": "pin", "name": "pin", "a": "wall", "b": "bob", "on_a": (0.0, 0.0)}]))


def pendulum_reaction(run: Recording) -> np.ndarray:
    """R = m (a - g) with a from theta and the energy, for what fell from level, [n, 2].

    (I + m r^2) omega^2 = 2 m g r sin phi with phi below the level, and
    (I + m r^2) alpha = m g r cos phi.
    """
    m, r, inertia = 0.2, 0.3, 1e-5
    phi = -run["bob.angle"]
    share = m * r * r / (inertia + m * r * r)
    omega2 = 2 * share * G / r * np.sin(phi)
    alpha = share * G / r * np.cos(phi)
    outward = np.column_stack([np.cos(phi), -np.sin(phi)])
    downward = np.column_stack([-np.sin(phi), -np.cos(phi)])
    return m * (r * alpha[:, None] * downward - r * omega2[:, None] * outward + [0.0, G])


def test_the_reaction_of_a_pendulum_is_its_closed_form_to_second_order():
    """At the bottom it is m g (1 + 2 share); errors go with h^2, here 3.9 to 4.1 for halving h.

    Gaps of up to 0.1 nm that a step may leave make 0.2 kg * 1e-10 m / h^2 of noise besides.
    """
    errors = []
    for step in (8 * H, 4 * H):
        run = pendulum(step)
        errors.append(np.abs(run.reactions[:, 0] - pendulum_reaction(run)).max())
    assert errors[1] < 1e-4 * 0.2 * G
    assert 3.5 < errors[0] / errors[1] < 4.5
    run = pendulum(H)
    noise = 0.2 * 1e-10 / H**2
    assert np.abs(run.reactions[:, 0] - pendulum_reaction(run)).max() < errors[1] / 16 + 2 * noise


def test_the_energy_of_a_pendulum_is_kept_to_second_order():
    lost = [figures(pendulum(step))["energy.lost"].value for step in (2 * H, H)]
    assert lost[1] < 1e-3
    assert 3.5 < lost[0] / lost[1] < 4.5


def test_a_pendulum_stays_on_its_pin():
    """Gaps are closed to 1e-6 m/s^2 h^2 and rounding; the first goes with h^4."""
    run = pendulum(H)
    assert Evidence(run).loads.frames.gaps[0][1:].max() < 1e-6 * H**2 + 1e-13
    assert figures(run)["joint.drift"].verdict == "pass"
    first = [Evidence(pendulum(step)).loads.frames.gaps[0, 0] for step in (16 * H, 8 * H)]
    assert 15 < first[0] / first[1] < 17
    assert figures(pendulum(16 * H))["joint.drift"].verdict == "pass"


@cache
def held(row: int) -> Recording:
    groups = [{"name": "finger", "kind": "finger",
               "bodies": ["finger.proximal", "finger.middle", "finger.distal"]}]
    disc = SET_G_TABLE[row]
    return simulate(finger(
        SET_G, pull={"ramp": {"to": disc.tension, "over": 0.3}}, duration=1.5, step=H, disc=disc,
        groups=groups))


@pytest.mark.parametrize("row", range(len(SET_G_TABLE)))
def test_contact_forces_from_tension_and_springs_are_those_of_the_table(row):
    """The audit's own f = J^-T tau, which reads no contact force, to the table's four digits."""
    rest = Rest(Evidence(held(row)).last)
    grip = grip_of(rest, rest.model.mechanism.groups[0])
    tau = [-rest.about(j, beyond_joint(rest.model, j)).others for j in grip.hinges]
    force = contact_forces(grip.jacobian, np.array(tau))
    expected = [SET_G_TABLE[row].forces[i] for i in grip.phalanx]
    assert force == pytest.approx(expected, abs=1e-4)
    found = figures(held(row))
    assert found["rest.contacts"].verdict == "pass"
    assert found["rest.moments"].value < 1e-4
    assert "about 3 hinges" in found["rest.moments"].why
    assert found["contact.shared"].value == 0


def test_a_finger_that_closes_freely_keeps_momentum_and_reactions_to_rounding():
    run = simulate(finger(SET_G, pull=3.0, duration=0.06, step=H, stops=False,
                          run={"sample_rate": 1 / H}))
    found = figures(run)
    for name in ("momentum.moment", "reaction.size"):
        assert found[name].value < 1e-11
        assert found[name].verdict == "pass"
    assert found["energy.lost"].value < 1e-3
    assert found["tendon.shortening"].verdict == "pass"
