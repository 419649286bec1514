"""Stiffness of what is held: closed forms with one, two and three contacts, and the engine's."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from sandbox.engine.simulate import simulate
from sandbox.recording.recording import Recording
from sandbox.samples.grasps import MAX_STIFFNESS_SAMPLES, Grasp
from sandbox.samples.stiffness import Linearization
from sandbox.scene.expand import expand
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.read.load import load_scene

G = 9.81


def run_of(bodies: list[dict[str, Any]], mu: float = 0.8, **more: Any) -> Recording:
    return simulate(expand(load_scene({
        "run": {"duration": 0.15}, "materials": {"m": {"friction": mu}}, "bodies": [
            {"material": "m", **body} if body.get("shapes") else body for body in bodies],
        **more})))


def last(run: Recording, name: str = "thing") -> list[float]:
    """Stiffness along x, y, of turning, and the least, at the end."""
    return [float(run[f"{name}.stiffness{end}"][-1]) for end in ("_x", "_y", "_turn", "")]


@pytest.mark.parametrize(("round_", "half", "stands"), [(0.05, 0.02, True), (0.02, 0.03, False)])
def test_a_plank_on_a_cylinder(round_: float, half: float, stands: bool) -> None:
    """It rolls: U'' = W (R - b) by its turn, and its centre goes by b turn; b > R topples.

    One contact, of a flat side on a round one, whose force turns and whose point moves.
    """
    weight = 0.2 * G
    run = run_of([
        {"name": "log", "motion": "fixed", "role": "palm", "shapes": [
            {"type": "circle", "radius": round_}]},
        {"name": "thing", "mass": 0.2, "role": "object", "at": [0, round_ + half], "shapes": [
            {"type": "box", "size": [0.2, 2 * half]}]}], gravity=[0, -G])
    x, y, turn, least = last(run)
    assert np.isinf(y)
    if stands:
        assert turn == pytest.approx(weight * (round_ - half), rel=1e-6)
        assert x == least == pytest.approx(weight * (round_ - half) / half**2, rel=1e-6)
    else:
        assert (x, turn, least) == (0.0, 0.0, 0.0)


def tips(mu: float, k: float, press: float, *, count: int = 3, r: float = 0.02,
         tip: float = 0.006) -> Recording:
    """A disc between fingertips on guides, evenly round it, that springs press on it."""
    angles = np.radians(90 + 360 / count * np.arange(count))
    bodies: list[dict[str, Any]] = [
        {"name": "frame", "motion": "fixed"},
        {"name": "thing", "mass": 0.1, "role": "object", "shapes": [
            {"type": "circle", "radius": r}]}]
    joints, springs = [], []
    for i, out in enumerate(np.stack([np.cos(angles), np.sin(angles)], axis=1)):
        bodies.append({"name": f"tip{i}", "mass": 0.02, "role": "phalanx",
                       "at": ((r + tip) * out).tolist(),
                       "shapes": [{"type": "circle", "radius": tip}]})
        joints.append({"type": "slot", "name": f"guide{i}", "a": "frame", "b": f"tip{i}",
                       "on_b": [0, 0], "turns": False, "start": [0, 0],
                       "end": (3 * r * out).tolist()})
        springs.append({"type": "linear", "name": f"spring{i}", "a": "frame", "b": f"tip{i}",
                        "on_a": (3 * r * out).tolist(), "on_b": [0, 0], "stiffness": k,
                        "rest_length": 3 * r - (r + tip) + press / k, "damping": 1.0})
    return run_of(bodies, mu, joints=joints, springs=springs,
                  contacts=[{"between": ["tip*", "tip*"], "collide": False}])


@pytest.mark.parametrize("press", [0.5, 4.0])
def test_three_smooth_fingertips_on_springs(press: float) -> None:
    """k n n^T - N / (r + tip) t t^T of each: normals turn as the disc goes across them.

    Nothing turns a smooth disc.
    """
    k = 400.0
    expected = 1.5 * (k - press / 0.026)
    assert last(tips(0.0, k, press)) == [
        *(pytest.approx(expected, rel=1e-6) for _ in range(2)), 0.0,
        pytest.approx(expected, rel=1e-6)]


def test_stiffness_is_calculated_only_in_the_samples_that_are_read(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    run = tips(0.0, 400.0, 1.0)
    calculated = []
    plain = Linearization.__init__
    monkeypatch.setattr(Linearization, "__init__", lambda self, run, sample, size: (
        calculated.append(sample), plain(self, run, sample, size))[0])
    last = run.within("thing.stiffness", slice(-1, None))
    assert calculated == [len(run) - 1]
    whole = run["thing.stiffness"]
    held = np.flatnonzero(run["thing.held"])
    assert len(calculated) == min(len(held), MAX_STIFFNESS_SAMPLES)
    assert {held[0], held[-1]} <= set(calculated)
    assert whole[-1] == last
    assert np.array_equal(np.isfinite(whole), run["thing.held"] == 1)
    window = slice(held[3], held[3] + MAX_STIFFNESS_SAMPLES)
    known = set(calculated)
    run.within("thing.stiffness", window)
    assert set(calculated) - known == set(range(*window.indices(len(run)))) - known


def pushed(mechanism: Mechanism, name: str, force: tuple[float, float]) -> Mechanism:
    """The same for 2 s more, in the first of which a push at the body's centre grows evenly."""
    end = mechanism.run.duration
    drives = Mechanism.model_validate({"drives": [
        {"type": "force", "name": f"test_push{k}", "body": name,
         "direction": [1.0 - k, float(k)],
         "value": {"table": [[0, 0], [end, 0], [end + 1, size], [end + 2, size]]}}
        for k, size in enumerate(force)]}).drives
    return mechanism.model_copy(update={
        "drives": (*mechanism.drives, *drives), "expect": (),
        "run": mechanism.run.model_copy(update={"duration": end + 2})})


@pytest.mark.parametrize(("scene", "name", "size"), [
    ("sdm", "disc", 1.0), ("soft_synergy", "disc", 0.2),
    pytest.param("four_finger_opposed", "object.body", 1.0, marks=pytest.mark.nightly)])
def test_shipped_hands_answer_a_push_as_their_stiffness_says(
    scene: str, name: str, size: float,
) -> None:
    """Half of what opposite pushes along x differ by, u = C F + c F^3 + ...

    With half the push, too, (4 u(F/2) 2 - u(F)) / 3 leaves some (u / rho)^4, and 1e-5 of a way
    that has not come to its end yet after a second.
    """
    mechanism = expand(load_scene(scene))
    rest = simulate(mechanism)
    body = [each.name for each in mechanism.bodies].index(name)
    rho, end = Grasp(rest, body).size, len(rest) - 1
    expected = size * Linearization(rest, end, rho).of(body).compliance[0, 0]
    ways = []
    for share in (1.0, -1.0, 0.5, -0.5):
        run = simulate(pushed(mechanism, name, (share * size, 0.0)))
        at = Grasp(run, body).centre[:, 0]
        ways.append(float(at[-1] - at[end]))
    whole, half = (ways[0] - ways[1]) / 2, ways[2] - ways[3]
    assert (4 * half - whole) / 3 == pytest.approx(
        expected, abs=expected * (10 * (expected / rho)**4 + 1e-5) + 1e-12)
