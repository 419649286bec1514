"""How an object is held, in recordings written by hand: closed forms, who counts, when it rests."""

import numpy as np
import pytest

from sandbox.elements.quantities import GRASP, MOST_PRESSING, STRAY, WINDOW
from sandbox.engine.inspect import inspect
from sandbox.errors import SceneError
from sandbox.model.catalogue import UnknownQuantityError
from sandbox.model.meters import check_quantities
from sandbox.samples.expectations import verdicts
from sandbox.samples.grasps import MEASURES
from sandbox.scene.expand import expand
from sandbox.scene.read.load import load_scene
from sandbox.scene.settings import Expect
from tests.audit.still import H, block, machine, still

R = 0.02
DISC = {"type": "circle", "radius": R}
MU = 0.5
"""Of surfaces that say nothing."""
BALL, LEFT, RIGHT, TABLE, STONE = range(1, 6)


def world(*, left=None, table="link", **ball):
    """A disc, two fingers, a table, another object."""
    return machine(
        block("ball", at=(0.3, 0.1), **{"role": "object", "shapes": [DISC], **ball}),
        left or block("left", role="phalanx"), block("right", role="phalanx"),
        {"name": "table", "motion": "fixed", "role": table},
        block("stone", role="object", shapes=[DISC]))


def touch(sample, other, angle, force, *, rub=0.0, swapped=False):
    """What presses on the disc from a side, ``angle`` seen from its centre."""
    out = np.array([np.cos(angle), np.sin(angle)])
    f = -force * out + rub * np.array([out[1], -out[0]])
    at = tuple(np.array([0.3, 0.1]) + R * out)
    if swapped:
        return (sample, other, BALL, tuple(-f), tuple(out), at, 0.0)
    return (sample, BALL, other, tuple(f), tuple(-out), at, 0.0)


def pinch(n=4, *, swapped=False, forces=(3.0, 1.0)):
    return [touch(k, other, angle, force, swapped=swapped) for k in range(n)
            for other, angle, force in ((LEFT, np.pi, forces[0]), (RIGHT, 0.0, forces[1]))]


@pytest.mark.parametrize("swapped", [(), (1,), (0, 2)])
def test_either_body_may_come_first(swapped):
    """Three contacts evenly round: mu, however their rows are written."""
    rows = [touch(0, other, np.radians(90 + 120 * k), 1.0, swapped=k in swapped)
            for k, other in enumerate((LEFT, RIGHT, LEFT))]
    assert still(world(), touches=rows)["ball.epsilon"][0] == pytest.approx(MU)


@pytest.mark.parametrize("swapped", [False, True])
def test_closed_forms_of_two_opposite_contacts(swapped):
    """mu / sqrt(2 + mu^2); G G^T = 2 in all directions; deviation 1 of a mean of 2."""
    run = still(world(), touches=pinch(swapped=swapped))
    np.testing.assert_allclose(run["ball.epsilon"], MU / np.sqrt(2 + MU**2), rtol=1e-9)
    np.testing.assert_array_equal(run["ball.closure"], 1.0)
    np.testing.assert_allclose(run["ball.isotropy"], 1.0, rtol=1e-9)
    np.testing.assert_allclose(run["ball.spread"], 0.5, rtol=1e-12)


def test_the_centre_of_mass_and_the_outline_count():
    """Of a disc on a bar rho runs to the bar's end, and moments are about the centre given."""
    from sandbox.mechanics.closure import grasp_epsilon

    bar = {"type": "capsule", "start": (0, 0), "end": (0.06, 0), "radius": 0.005}
    run = still(world(shapes=[DISC, bar], centre=(0.01, 0)), touches=pinch())
    at = np.array([[0.3 - R, 0.1], [0.3 + R, 0.1]])
    expected = grasp_epsilon(at, [[1, 0], [-1, 0]], MU, centre=(0.31, 0.1), length=0.055)
    assert 0.05 < expected < MU / np.sqrt(2 + MU**2) - 0.05
    np.testing.assert_allclose(run["ball.epsilon"], expected, rtol=1e-9)


@pytest.mark.parametrize(("mu", "least"), [((0.2, 0.8), 0.2), ((0.8, 0.2), 0.2)])
def test_every_contact_rubs_as_its_pair_does(mu, least):
    """Geometric means: of a disc with 1/2 and fingers with 2 mu^2 mu of each, the lesser counts.

    Of two opposite contacts epsilon is mu / sqrt(2 + mu^2) of the one that rubs less.
    """
    fingers = [block(name, role="phalanx", material=name) for name in ("left", "right")]
    mech = machine(
        block("ball", at=(0.3, 0.1), role="object", shapes=[DISC], material="ball"), *fingers,
        materials={"ball": {"friction": 0.5}, "left": {"friction": 2 * mu[0] ** 2},
                   "right": {"friction": 2 * mu[1] ** 2}})
    np.testing.assert_allclose(still(mech, touches=pinch())["ball.epsilon"],
                               least / np.sqrt(2 + least**2), rtol=1e-9)


def test_a_micronewton_presses():
    """More than 1 uN counts as pressing, less does not."""
    for force, count in ((1.1e-6, 1.0), (0.9e-6, 0.0)):
        run = still(world(), touches=pinch(forces=(force, force)))
        np.testing.assert_array_equal(run["ball.closure"], count)


def test_who_counts():
    """A table and another object are no hand; what presses with nothing does not press."""
    rows = [touch(0, LEFT, np.pi, 3.0), touch(0, TABLE, 0.0, 1.0),
            touch(1, TABLE, 0.0, 1.0), touch(1, STONE, np.pi, 1.0),
            touch(2, LEFT, np.pi, 3.0), touch(2, RIGHT, 0.0, 1e-7)]
    run = still(world(), touches=rows)
    np.testing.assert_array_equal(run["ball.closure"], 0.0)
    np.testing.assert_array_equal(run["ball.epsilon"], [0.0, np.nan, 0.0, np.nan])
    np.testing.assert_array_equal(run["ball.isotropy"], [0.0, np.nan, 0.0, np.nan])
    np.testing.assert_array_equal(run["ball.spread"], [0.0, np.nan, 0.0, np.nan])


@pytest.mark.parametrize(("role", "counts"), [("palm", True), ("ground", False), ("link", False)])
def test_what_never_moves_is_a_hands_by_its_role(role, counts):
    rows = [touch(0, LEFT, np.pi, 3.0), touch(0, TABLE, 0.0, 3.0)]
    run = still(world(table=role), touches=rows)
    assert run["ball.closure"][0] == counts
    assert run["ball.spread"][0] == 0.0  # a palm is no finger


def test_fingers_are_the_smallest_groups():
    """Forces 3, 1 and 2 on bodies; of fingers 4 and 2, whatever larger group holds all."""
    groups = [{"name": "one", "bodies": ["left", "right"]},
              {"name": "hand", "bodies": ["left", "right", "third"]}]
    third = block("third", role="phalanx")
    mech = machine(block("ball", at=(0.3, 0.1), role="object", shapes=[DISC]),
                   block("left", role="phalanx"), block("right", role="phalanx"), third,
                   groups=groups)
    rows = [touch(0, LEFT, np.pi, 3.0), touch(0, RIGHT, 0.0, 1.0), touch(0, 4, 1.0, 2.0)]
    run = still(mech, touches=rows)
    assert run["ball.spread"][0] == pytest.approx(1 / 3)
    assert run["ball.spread_bodies"][0] == pytest.approx(np.sqrt(2 / 3) / 2)


@pytest.mark.parametrize(("tilt", "at"), [(0.0, 0.0), (0.3, 0.0), (0.0, 0.004)])
def test_flat_sides_count_as_both_ends(tilt, at):
    """A box between two lower ones: four contacts, at the ends of what the sides share.

    The centre of pressure may be anywhere between them; tilted by 0.3 all of it.
    """
    from sandbox.mechanics.closure import grasp_epsilon

    def box(name, x, height, role):
        c, s = np.cos(tilt), np.sin(tilt)
        return block(name, at=(0.3 + c * x, 0.1 + s * x), angle=tilt, role=role,
                     shapes=[{"type": "box", "size": (0.04, height)}])

    mech = machine(box("ball", 0.0, 0.04, "object"), box("left", -0.04, 0.02, "phalanx"),
                   box("right", 0.04, 0.03, "phalanx"))
    turn = np.array([[np.cos(tilt), -np.sin(tilt)], [np.sin(tilt), np.cos(tilt)]])
    rows = [(0, 1, other, tuple(turn @ (-side, 0)), tuple(turn @ (-side, 0)),
             tuple(turn @ (side * 0.02, at) + (0.3, 0.1)), 0.0)
            for other, side in ((2, -1.0), (3, 1.0))]
    ends = np.array([[-0.02, -0.01], [-0.02, 0.01], [0.02, -0.015], [0.02, 0.015]])
    normals = np.array([[1, 0], [1, 0], [-1, 0], [-1, 0]])
    expected = grasp_epsilon(ends, normals, MU, centre=(0, 0), length=0.04 / np.sqrt(2))
    centres = grasp_epsilon([[-0.02, at], [0.02, at]], normals[::2], MU, centre=(0, 0),
                            length=0.04 / np.sqrt(2))
    assert expected > 1.1 * centres
    np.testing.assert_allclose(still(mech, touches=rows)["ball.epsilon"][0], expected, rtol=1e-9)


N = 300
FULL = round(WINDOW / H)


def hold(change=None, n=N, touches=None):
    def changed(arrays):
        if change is not None:
            change(arrays, arrays["time"][:, None] - arrays["time"][0])
    return still(world(), changed, n=n, touches=pinch(n) if touches is None else touches)


def test_held_after_a_window_at_rest():
    run = hold()
    np.testing.assert_array_equal(run["ball.held"], np.arange(N) >= FULL)
    np.testing.assert_array_equal(run["ball.drift"][FULL:], 0.0)
    assert np.isnan(run["ball.drift"][:FULL]).all()


@pytest.mark.parametrize(("share", "held"), [(0.99, True), (1.01, False)])
@pytest.mark.parametrize("way", ["moves", "turns", "shakes"])
def test_what_moves_too_much_is_not_held(way, share, held):
    """At a rate that takes it a hundredth of its size in a window; shaking counts each way."""
    rate = share * STRAY * R / WINDOW

    def change(a, t):
        if way == "moves":
            a["body_pose"][:, BALL, :2] += rate * t * np.array([0.6, 0.8])
        elif way == "turns":
            a["body_pose"][:, BALL, 2:] += rate * t / R
        else:
            a["body_pose"][1::2, BALL, 0] += rate * H
    run = hold(change)
    assert run["ball.held"][FULL:].all() == held
    assert run["ball.held"].any() == held
    if held and way != "shakes":  # drift is not taken back at the end of a window
        # a chord is shorter than its arc by a share of angle^2 / 24, here of 0.02 rad
        assert run["ball.drift"][-1] == pytest.approx(rate * (N - 1 - FULL) * H, rel=2e-5)


@pytest.mark.parametrize(("share", "held"), [(0.99, True), (1.01, False)])
@pytest.mark.parametrize("body", [BALL, LEFT])
def test_what_slides_is_not_held(body, share, held):
    """Along the surface: across the normal, at the point of touch, of either body."""
    rate = share * STRAY * R / WINDOW

    def change(a, _):
        a["body_velocity"][:, body, 1] = rate
        a["body_velocity"][:, body, 0] = 1.0  # towards it or away: no sliding
    assert hold(change)["ball.held"][FULL:].all() == held


def test_what_rolls_does_not_slide():
    """Both turn about their centres, with one velocity where they meet."""
    def change(a, _):
        a["body_pose"][:, LEFT, :2] = 0.3 - 3 * R, 0.1
        a["body_velocity"][:, BALL, 2] = 5.0
        a["body_velocity"][:, LEFT, 2] = -2.5
    rows = [touch(k, LEFT, np.pi, 3.0) for k in range(N)]
    assert hold(change, touches=rows)["ball.held"][FULL:].all()

    def against(a, t):
        change(a, t)
        a["body_velocity"][:, LEFT, 2] = 2.5
    assert not hold(against, touches=rows)["ball.held"].any()


def test_what_turns_with_its_finger_does_not_slide_wherever_the_centres_of_mass_are():
    """Both turn about one point of the world as if they were one body, the disc lying askew.

    Speeds are those of centres of mass, so that these have to be told from origins: a slip of
    5 rad/s by 9 mm would be 45 mm/s, and 3 mm/s are too much.
    """
    off, askew, turn = np.array([0.01, -0.002]), 0.7, 5.0
    left = block("left", role="phalanx", centre=(0.01, 0.01))
    centres = {BALL: np.array([[np.cos(askew), -np.sin(askew)], [np.sin(askew), np.cos(askew)]])
               @ off + [0.3, 0.1], LEFT: np.array([0.01, 0.01])}

    def change(a):
        for body, centre in centres.items():
            a["body_velocity"][:, body] = -turn * centre[1], turn * centre[0], turn
    rows = [touch(k, LEFT, np.pi, 3.0) for k in range(N)]
    run = still(world(left=left, centre=tuple(off), angle=askew), change, n=N, touches=rows)
    assert run["ball.held"][FULL:].all()


def test_a_slip_counts_in_the_step_that_ends_with_it():
    """Speeds are those at a step's end: one of 2 / 100 of its size counts for a window."""
    def change(a, _):
        a["body_velocity"][150, BALL, 1] = 2 * STRAY * R / H
    held = np.arange(N) >= FULL
    held[150:150 + FULL] = False
    np.testing.assert_array_equal(hold(change)["ball.held"], held)


def test_drift_has_the_way_and_the_turn():
    """0.04 mm along and 0.002 rad of 20 mm, 2 rho sin(turn / 2): both together."""
    def change(a, t):
        later = t[:, 0] > 0.2
        a["body_pose"][later, BALL, 0] += 4e-5
        a["body_pose"][later, BALL, 2] += 2e-3
    run = hold(change)
    assert run["ball.drift"][-1] == pytest.approx(4e-5 + 2 * R * np.sin(1e-3), rel=1e-6)


def test_a_hand_alone_holds():
    """Not while a table carries it, nor for a window after it was let go; another object may."""
    on_table = [touch(k, TABLE, -np.pi / 2, 1.0) for k in range(150, 160)]
    run = hold(touches=sorted([*pinch(N), *on_table]))
    held = np.arange(N) >= FULL
    held[150:160] = False
    np.testing.assert_array_equal(run["ball.held"], held)
    beside = [touch(k, STONE, np.pi / 2, 1.0) for k in range(150, 160)]
    assert hold(touches=sorted([*pinch(N), *beside]))["ball.held"][FULL:].all()
    gone = [row for row in pinch(N) if row[0] != 150]
    held = (np.arange(N) >= FULL) & ~((np.arange(N) >= 150) & (np.arange(N) <= 150 + FULL))
    np.testing.assert_array_equal(hold(touches=gone)["ball.held"], held)


def test_drift_is_counted_from_where_it_is_held_again():
    gone = [row for row in pinch(N) if row[0] != 150]
    rate = 0.5 * STRAY * R / WINDOW

    def change(a, t):
        a["body_pose"][:, BALL, :1] += rate * t
    drift = hold(change, touches=gone)["ball.drift"]
    assert drift[149] == pytest.approx(rate * (149 - FULL) * H)
    assert np.isnan(drift[150:151 + FULL]).all()
    assert drift[151 + FULL] == 0.0
    assert drift[-1] == pytest.approx(rate * (N - 1 - 151 - FULL) * H)


@pytest.mark.parametrize("motion", ["scheduled", "fixed"])
def test_a_palm_that_moves_is_what_it_is_seen_from(motion):
    """Carried through a quarter turn by its palm: it rests in the hand, not in the world."""
    palm = {"name": "left", "role": "palm", "motion": motion}
    if motion == "scheduled":
        palm["path"] = {"angle": 0.0}

    def change(a):
        turn = np.linspace(0, np.pi / 2, N)
        for body in (BALL, LEFT):
            a["body_pose"][:, body, 2] = turn
        a["body_pose"][:, BALL, 0] = 0.5 * np.cos(turn)
        a["body_pose"][:, BALL, 1] = 0.5 * np.sin(turn)
        a["body_velocity"][:, :3] = 0.0
    run = still(world(left=palm), change, n=N, touches=pinch(N))
    assert run["ball.held"][-1] == (motion == "scheduled")


def test_more_contacts_than_anyone_asks_for():
    bodies = [block(f"tip{k}") for k in range(MOST_PRESSING + 1)]
    mech = machine(block("ball", at=(0.3, 0.1), role="object", shapes=[DISC]), *bodies)
    angles = np.linspace(0, 2 * np.pi, MOST_PRESSING + 1, endpoint=False)
    rows = [touch(k, 2 + i, angles[i], 1.0) for k in (0, 1) for i in range(MOST_PRESSING + k)]
    run = still(mech, n=2, touches=rows)
    assert run["ball.epsilon"][0] > 0
    assert np.isnan(run["ball.epsilon"][1])
    np.testing.assert_array_equal(run["ball.closure"], [1.0, np.nan])
    assert run["ball.spread"][1] < 1e-12


def test_every_measure_is_worked_out_and_told():
    assert set(MEASURES) == set(GRASP)


def test_an_empty_recording_and_one_without_contacts():
    for n in (0, 1, 3):
        run = still(world(), n=n)
        for name in run.match("ball.*"):
            assert run[name].shape == (n,)
    assert (still(world())["ball.held"] == 0).all()


# --- why it is not held


def expecting(expect):
    """A hold of the disc with an expectation; ``change`` and ``touches`` as in :func:`hold`."""
    def run(change=None, touches=None):
        mechanism = world().model_copy(update={"expect": (Expect.model_validate(expect),)})

        def changed(arrays):
            if change is not None:
                change(arrays, arrays["time"][:, None] - arrays["time"][0])
        return still(mechanism, changed, n=N, touches=pinch(N) if touches is None else touches)
    return run


HELD = {"min": "ball.held", "over": [0.12, None], "is": 1, "within": 0}


def test_a_failed_expectation_tells_which_contact_slid_and_how_far():
    """At twice the rate: two hundredths of 20 mm in a window, where 0.2 mm are allowed."""
    def change(a, _):
        a["body_velocity"][:, RIGHT, 1] = 2 * STRAY * R / WINDOW
    run = expecting(HELD)(change)
    first = run.time[np.searchsorted(run.time, 0.12 - 1e-9)]
    assert verdicts(run)[0].reason == (
        f"it is not held, first at {first:.6g} s: it slid by 0.4 mm in the 0.1 s before, "
        "0.2 mm is the most, along 'right' by 0.4 mm")


def test_a_failed_expectation_tells_how_far_it_moved():
    def change(a, t):
        a["body_pose"][:, BALL, :1] += 3 * STRAY * R / WINDOW * t
    told = verdicts(expecting(HELD)(change))[0].reason
    assert told.endswith(": it moved by 0.6 mm in the 0.1 s before, 0.2 mm is the most")


@pytest.mark.parametrize(("touches", "told"), [
    ([], "nothing of a hand ever touches it"),
    (pinch(10), "nothing of a hand touched it after {last:.6g} s"),
    ([row for row in pinch(N) if row[0] != 150], "the hand let go of it in the 0.1 s before"),
    (sorted([*pinch(N), *(touch(k, TABLE, -np.pi / 2, 1.0) for k in range(200, N))]),
     "'table', which is no hand, carries it")])
def test_a_failed_expectation_tells_who_holds_it_not(touches, told):
    expect = {"final": "ball.held", "is": 1, "within": 0} if len(touches) != 2 * N - 2 else {
        "mean": "ball.held", "over": [(150.5 + 0.5 * FULL) * H, (151 + 0.9 * FULL) * H],
        "above": 0.5}
    run = expecting(expect)(touches=touches)
    verdict, = verdicts(run)
    assert not verdict.ok
    assert verdict.reason.endswith(": " + told.format(last=run.time[9]))


def test_before_the_first_touch_it_is_told_that_there_was_none_yet():
    run = expecting(HELD)(touches=[row for row in pinch(N) if row[0] > 200])
    assert verdicts(run)[0].reason.endswith(": nothing of a hand had touched it yet")


def test_one_of_drift_tells_why_it_has_none():
    run = expecting({"max": "ball.drift", "below": 1e-4})()
    assert verdicts(run)[0].reason == (
        f"{FULL} of {N} samples have no value: it is not held then, first at {run.time[0]:.6g} s: "
        "the run was not 0.1 s old")


@pytest.mark.parametrize("expect", [
    {"min": "ball.held", "over": [0.12, None], "is": 0, "within": 0},
    {"mean": "ball.held", "over": [0.12, None], "above": 1.5}])
def test_of_what_is_held_all_the_time_nothing_is_told(expect):
    verdict, = verdicts(expecting(expect)())
    assert (verdict.ok, verdict.reason) == (False, "")


def test_the_final_sample_alone_has_to_have_a_value():
    """Not held for the first tenth of a second, at the end so, and where it was."""
    verdict, = verdicts(expecting({"final": "ball.drift", "between": [0, 1e-6]})())
    assert (verdict.ok, verdict.value, verdict.reason) == (True, 0.0, "")
    lost, = verdicts(expecting({"final": "ball.drift", "below": 1})(touches=pinch(10)))
    assert not lost.ok
    assert lost.reason.startswith("the last sample has no value: it is not held then, first at ")


def test_one_of_stiffness_tells_which_of_its_reasons_it_is(monkeypatch):
    """Not held, in the first tenth of a second; later held, where something can't be told of."""
    early, late = ({"max": "ball.stiffness", "over": over, "below": 1e9}
                   for over in ([0, 0.05], [0.15, 0.2]))
    verdict, = verdicts(expecting(early)())
    assert " have no value: it is not held then, first at " in verdict.reason
    assert "told" not in verdict.reason
    monkeypatch.setattr("sandbox.samples.grasps.without_stiffness", lambda _: "fluids")
    assert verdicts(expecting(late)())[0].reason.endswith(
        " have no value: stiffness can't be told with fluids then")


@pytest.mark.parametrize(("given", "allowed", "ok"), [
    ({"is": 1}, "1", False), ({"is": 1, "within": "10 %"}, "0.9 to 1.1", True),
    ({"is": 1, "within": 0}, "1", False)])
def test_what_is_yes_or_no_is_so_exactly(given, allowed, ok):
    """Held but in the first of the samples that are looked at: nearly always is not always."""
    begin = (FULL - 1) * H + H / 2
    run = expecting({"mean": "ball.held", "over": [begin, None], **given})()
    verdict, = verdicts(run)
    assert 0.9 < verdict.value < 1
    assert (verdict.allowed, verdict.ok) == (allowed, ok)


# --- what is told


def mechanism_of(scene):
    return expand(load_scene(scene))


def scene(expect, **ball):
    return mechanism_of({
        "bodies": [{"name": "disc", "mass": 1, "role": "object", "shapes": [DISC]},
                   {"name": "ball", "mass": 1, "shapes": [DISC], "at": [1, 0], **ball}],
        "expect": [{"final": expect, "above": 0}]})


@pytest.mark.parametrize(("ball", "quantity", "told"), [
    ({}, "epsilon",
     "only bodies with the role 'object' have it, 'ball' has the role 'link'; there is 'disc'"),
    ({"role": "object", "motion": "fixed", "mass": None}, "held",
     "'ball' does not move freely, so that nobody has to hold it"),
    ({"role": "object", "shapes": [], "inertia": 1}, "closure",
     "'ball' has no shapes, and nothing can touch it"),
])
def test_asked_of_what_nobody_holds(ball, quantity, told):
    mechanism = scene(f"ball.{quantity}", **ball)
    problem, = check_quantities(mechanism)
    assert problem.message == f"unknown quantity 'ball.{quantity}': {told}"
    assert problem.path == "$.expect[0].final"
    run = still(mechanism)
    with pytest.raises(UnknownQuantityError) as refused:
        run[f"ball.{quantity}"]
    assert told in str(refused.value)
    assert told in verdicts(run)[0].reason


def test_a_slip_of_the_pen():
    problem, = check_quantities(scene("disc.epsilom"))
    assert problem.hint == "'disc.epsilon'"


@pytest.mark.parametrize(("quantity", "when"), [
    ("epsilon", "no hand presses on it, or more than 24 bodies do"), ("drift", "it is not held"),
    ("spread", "no finger presses on it")])
def test_expected_where_nothing_touches(quantity, when):
    run = still(scene(f"disc.{quantity}"))
    verdict, = verdicts(run)
    assert not verdict.ok
    why = (f", first at {run.time[-1]:.6g} s: nothing of a hand ever touches it"
           if quantity == "drift" else "")
    assert verdict.reason == f"the last sample has no value: {when} then{why}"


def test_only_objects_keep_these_names():
    def bodies(role):
        return {"bodies": [{"name": "disc", "mass": 1, "role": role, "shapes": [DISC]},
                           {"name": "disc.held", "mass": 1, "shapes": [DISC], "at": [1, 0]}]}
    assert load_scene(bodies("link"))
    with pytest.raises(SceneError, match="also means the quantity"):
        load_scene(bodies("object"))


def test_it_cannot_be_read_while_a_run_goes_on():
    from sandbox.engine.inspect_control import control_problems

    mechanism = mechanism_of({
        "bodies": [{"name": "disc", "mass": 1, "role": "object", "shapes": [DISC]}],
        "events": [{"name": "stop", "when": "=disc.held > 0.5", "stop": "pass"}]})
    assert any(problem.code == "quantity-not-live" for problem in control_problems(mechanism))


PEG = {"name": "peg", "motion": "fixed", "shapes": [DISC], "at": [0.1, 0]}
FINGER = {"name": "finger", "mass": 1, "shapes": [DISC], "at": [0.1, 0]}


@pytest.mark.parametrize(("other", "rules", "fine"), [
    (FINGER, [], True), ({**PEG, "role": "palm"}, [], True), (PEG, [], False),
    (FINGER, [{"between": ["finger", "disc"], "collide": False}], False),
    ({**FINGER, "shapes": [], "inertia": 1}, [], False),
    ({**FINGER, "role": "ground"}, [], False),
])
@pytest.mark.parametrize("asked", [
    {"expect": [{"final": "disc.held", "above": 0}]},
    {"expect": [{"final": "d*.hel?", "above": 0}]},
    {"meters": [{"name": "firm", "value": "=disc.held * disc.x", "unit": "m"}]}])
def test_what_no_hand_can_touch_is_told(other, rules, fine, asked):
    mechanism = mechanism_of({
        "bodies": [{"name": "disc", "mass": 1, "role": "object", "shapes": [DISC]}, other],
        "contacts": rules, **asked})
    told = [problem for problem in inspect(mechanism) if problem.code == "no-effect"]
    assert len(told) == (not fine)
    for problem in told:
        assert problem.message == "measures the grasp of disc, but no part of a hand can touch it"
        assert problem.path == ("$.expect[0].final" if "expect" in asked else "$.meters[0].value")
        assert not problem.blocks


def test_files_leave_it_out():
    assert not any("held" in name or "epsilon" in name
                   for name in still(world()).table("bodies").names)
