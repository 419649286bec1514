"""Studies of random objects in a hand: their files, points of them against closed forms, tables."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from sandbox.engine.simulate import simulate
from sandbox.findings import differential, gripping_force
from sandbox.findings.hand_rows import PHALANGES, closing_finger, doubts, hand_rows
from sandbox.mechanics.embrace import Pull, close_on_discs
from sandbox.recording.recording import Recording
from sandbox.scene.library import shipped_studies
from sandbox.scene.read.load import load_scene
from sandbox.sweeps.plan import read_plan
from sandbox.sweeps.table import SweepTable

RUNS = {"gripping_force_discs": 512, "gripping_force_squares": 256, "differential_rockers": 128,
        "differential_bar": 384}


def made_up(study: str) -> SweepTable:
    """A table in which finger i of run n presses with n + i / 10 N, and all came to rest."""
    plan = read_plan(shipped_studies()[study])
    n = len(plan)
    kept = {name: np.zeros(n) for name in plan.job.keep}
    for i in range(1, 5):
        kept[f"proximal{i}"] = np.arange(n) + 0.1 * i
        kept[f"tension{i}"] = np.full(n, 6.25)
    return SweepTable(plan, kept, plan.ids, ["done"] * n, np.ones(n))


@pytest.mark.parametrize("study", RUNS)
def test_the_study_files(study: str) -> None:
    plan = read_plan(shipped_studies()[study])
    assert len(plan) == RUNS[study]
    assert {f"{name}{i}" for name in (*PHALANGES, "tension", "contacts", "moves")
            for i in range(1, 5)} <= set(plan.job.keep)


def test_both_hands_meet_the_same_objects() -> None:
    rockers, bar = (made_up(name) for name in ("differential_rockers", "differential_bar"))
    for path in rockers.varied:
        assert bar.varied[path][::3] == rockers.varied[path]


def _forces(run: Recording) -> np.ndarray:
    return np.array([[run[f"finger{i}.{name}.contact.normal"][-1] for name in PHALANGES]
                     for i in range(1, 5)])


def _sections(given: dict[str, float]) -> tuple[np.ndarray, np.ndarray]:
    r, x, gap = (np.array([given[f"{name}{i}"] for i in range(1, 5)])
                 for name in ("r", "x", "gap"))
    return np.stack([x, -0.009 - gap - r], axis=1), r


def test_forces_of_the_hand_are_those_of_the_closed_form() -> None:
    """The four discs of the picture: three, one, one and two contacts, two with joints on stops.

    The hand's contacts are held to 1e-9 m, a force changes by some 100 N/m of such.
    """
    given = dict(gripping_force.SHOWN)
    run = simulate(load_scene("four_discs", overrides={
        f"parameters.{name}": value for name, value in given.items()}))
    tension = np.array([run[f"finger{i}.tendon.tension"][-1] for i in range(1, 5)])
    np.testing.assert_allclose(tension, 25.0 / 4, rtol=0.01)
    centres, discs = _sections(given)
    there = close_on_discs(closing_finger("four_discs"), centres, discs, Pull(tension), 0.5)
    np.testing.assert_allclose(_forces(run), there.forces, rtol=0, atol=1e-6)
    assert [*(there.forces > 0.01).sum(axis=1)] == [3, 1, 1, 2]


@pytest.mark.parametrize("k", [300.0, 1e5])
def test_tensions_on_the_bar_are_those_of_the_closed_form(k: float) -> None:
    """T_j = F / 4 + k (mean of X - X_j), and each from how far the bar has gone.

    At rest to 1e-10 m, and the stiffest cords make 5e4 N/m of it.
    """
    given = {"r1": 0.016, "x1": 0.01, "gap1": 0.012, "r2": 0.016, "x2": 0.012, "gap2": 0.014,
             "r3": 0.014, "x3": 0.012, "gap3": 0.014, "r4": 0.015, "x4": 0.01, "gap4": 0.014}
    run = simulate(load_scene("four_on_a_bar", overrides={
        f"parameters.{name}": value for name, value in {**given, "k": k}.items()}))
    tension = np.array([run[f"finger{i}.tendon.tension"][-1] for i in range(1, 5)])
    finger, both = closing_finger("four_discs"), 1.0 / (1.0 / k + 1e-5)
    drawn = np.full(4, run["bar_x"][-1])
    there = close_on_discs(finger, *_sections(given), Pull(drawn, both), 0.5)
    np.testing.assert_allclose(there.tension, tension, rtol=0, atol=1e-5)
    way = finger.tendon.shortening(there.theta)
    np.testing.assert_allclose(25.0 / 4 + both * (way.mean() - way), tension, rtol=0, atol=1e-5)
    assert (tension.max() > 18) == (k > 1e4)  # tied rigidly one finger takes nearly all


def test_rows_of_fingers() -> None:
    table = made_up("gripping_force_discs")
    rows = hand_rows(table)
    assert rows.forces.shape == (4 * len(table), 3)
    np.testing.assert_allclose(rows.forces[4 * 7:4 * 8, 0], [7.1, 7.2, 7.3, 7.4])
    np.testing.assert_allclose(rows.radius[4 * 7 + 2], table["parameters.r3"][7])
    assert rows.sound.all()
    table.kept["moves2"][7] = 1.0
    table.status[9] = "diverged"
    assert np.flatnonzero(~hand_rows(table).sound).tolist() == [29, 36, 37, 38, 39]
    table.looks[3] = ("poses",)
    assert doubts({"discs": table}) == (
        "512 runs, 1 did not end; 5 of 2048 fingers were not at rest and are left out; "
        "1 audits ask for a look (poses).")


def test_shares_as_claimed() -> None:
    """Made up: of the first five runs only run 1 presses with 1 to 2 N, with one phalanx each."""
    cases = gripping_force.cases_of(made_up("gripping_force_discs"), "parameters.pull",
                                    "discs, pull {:g} N")
    assert [case.name for case in cases] == ["discs, pull 15 N", "discs, pull 25 N"]
    assert [int(case.as_claimed.sum()) for case in cases] == [0, 4]
    assert [int(case.each.sum()) for case in cases] == [0, 4]
    line = gripping_force.shares_csv(cases).splitlines()[5].split(",")
    assert line[2:5] == ["proximal", "1024", "1.0"]
    assert float(line[5]) == 4 / 1024


def test_shares_over_pulls(monkeypatch: pytest.MonkeyPatch) -> None:
    """Made up: phalanges press with a quarter of the pull, half of it and twice it, or not at all.

    Four fingers share the pull: a phalanx that presses with it whole is within 1 to 2 N from 4 to
    8 N on. A fifth has not come to rest and does not count.
    """
    shares = np.array([[0.25, 0, 0], [0.5, 0.5, 1], [1, 2, 0], [0, 0, 0], [1, 1, 1]])

    def closed(_finger: object, rows: object, pull: np.ndarray) -> SimpleNamespace:
        assert len(pull) == len(rows.runs) == len(shares)  # type: ignore[attr-defined]
        return SimpleNamespace(forces=pull[:, None] * shares,
                               residual=np.array([0, 0, 0, 0, 1.0]))

    monkeypatch.setattr(gripping_force, "closed", closed)
    monkeypatch.setattr(gripping_force, "PULLS", (3.0, 5.0, 9.0, 20.0))
    rows = hand_rows(made_up("gripping_force_discs")).only(np.arange(len(shares)))
    found = gripping_force.pull_shares(None, rows)  # type: ignore[arg-type]
    #  F / 4   largest of the four                each that presses
    #  0.75    0.19, 0.75, 1.5*, 0                none; the third has 0.75 besides 1.5
    #  1.25    0.31, 1.25*, 2.5, 0                none; the second has 0.625 twice
    #  2.25    0.56, 2.25, 4.5, 0                 none
    #  5       1.25*, 5, 10, 0                    the first
    np.testing.assert_allclose(
        found, [[3, 0.25, 0], [5, 0.25, 0], [9, 0, 0], [20, 0.25, 0.25]])


def test_what_is_lost() -> None:
    """One phalanx alone holds nothing: all is lost, and nothing untouched."""
    ties = differential.ties_of({"rockers": made_up("differential_rockers"),
                                 "bar": made_up("differential_bar")})
    assert [tie.name for tie in ties] == [
        "rockers", "springs of 100 N/m", "springs of 300 N/m", "rigid"]
    assert all(tie.lost.all() and not tie.untouched.any() for tie in ties)
    rigid = ties[3]
    np.testing.assert_allclose(rigid.force[2], 8 + np.array([0.1, 0.2, 0.3, 0.4]))
    assert differential.ties_csv(ties).splitlines()[4].startswith("rigid,128,0.0,0.0,")


def test_the_closed_form_of_a_bar_is_asked_for_its_way(monkeypatch: pytest.MonkeyPatch) -> None:
    """The end of the spring has gone gone + T / k, spring and cord in series."""
    table = made_up("differential_bar")
    for i in range(1, 5):
        table.kept[f"gone{i}"] = np.full(len(table), 0.01)
    tie = differential.ties_of({"rockers": made_up("differential_rockers"), "bar": table})[2]
    asked = []
    monkeypatch.setattr(differential, "close_on_discs", lambda *given: asked.append(given[3]))
    differential.closed(closing_finger("four_discs"), tie)
    np.testing.assert_allclose(asked[0].amount, 0.01 + 6.25 / 300)
    np.testing.assert_allclose(asked[0].stiffness, 300 * 1e5 / (300 + 1e5))
