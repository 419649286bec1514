"""Bodies that move farther in a step than they are thick, against the laws of impact."""

import math

import numpy as np
import pytest

import sandbox

PLATE = {"name": "plate", "motion": "fixed",
         "shapes": [{"type": "box", "size": ["400 mm", "1 mm"]}]}
RADIUS, MASS = 0.01, 0.1


def disc(name="disc", **more):
    return {"name": name, "mass": MASS, "shapes": [{"type": "circle", "radius": RADIUS}], **more}


def run(*bodies, friction=0.0, restitution=0.0, step=1e-3, duration=0.02, **more):
    return sandbox.simulate(sandbox.load_scene({
        "format": 1, "gravity": [0, 0],
        "run": {"duration": duration, "step": step, "sample_rate": 1 / step},
        "materials": {"m": {"friction": friction, "restitution": restitution}},
        "bodies": [{"material": "m", **body} for body in bodies], **more}))


@pytest.mark.parametrize("restitution", [0, 0.5])
@pytest.mark.parametrize("speed", [5, 20, 1000])
def test_a_fast_disc_does_not_pass_a_thin_plate(speed, restitution):
    found = run(PLATE, disc(at=[0, 0.607], velocity=[0, -speed]), restitution=restitution,
                duration=0.2)
    assert found["disc.vy"][-1] == pytest.approx(restitution * speed, abs=1e-9 * speed)
    assert found["disc.y"].min() > RADIUS + 0.0005 - 1e-6 - 0.5 * speed * 1e-3 * (restitution > 0)
    if not restitution:  # it stays on the plate, closed to the tolerance of gaps
        assert found["disc.y"][-1] == pytest.approx(RADIUS + 0.0005, abs=1e-7)
    assert not found.notes


@pytest.mark.parametrize("restitution", [0, 0.5])
def test_an_oblique_impact_turns_the_disc_by_friction(restitution):
    """Coulomb's impulse is mu J while it slides: at 0.1 the disc does not come to roll.

    A pair has the geometric means of its materials' coefficients.
    """
    found = run(PLATE | {"material": "n"}, disc(at=[-0.12, 0.0955], velocity=[20, -20]), materials={
        "m": {"friction": 0.05, "restitution": restitution / 1.5},
        "n": {"friction": 0.2, "restitution": restitution * 1.5}})
    normal = (1 + restitution) * 20 * MASS
    inertia = MASS * RADIUS**2 / 2
    assert found["disc.vx"][-1] == pytest.approx(20 - 0.1 * normal / MASS, abs=1e-8)
    assert found["disc.vy"][-1] == pytest.approx(20 * restitution, abs=1e-8)
    assert abs(found["disc.omega"][-1]) == pytest.approx(0.1 * normal * RADIUS / inertia, rel=1e-8)


def test_two_fast_discs_meet_along_the_line_of_their_centres():
    offset, speed = 0.013, 50.0
    found = run(disc("a", at=[-0.2, offset], velocity=[speed, 0]),
                disc("b", at=[0.2, 0], velocity=[-speed, 0]), restitution=0.8)
    sine = offset / (2 * RADIUS)
    cosine = math.sqrt(1 - sine**2)
    change = 1.8 * 2 * speed * cosine / 2  # of the velocity of each along the line
    # the normal is found to a ten-thousandth of the margins, of 1 mm each
    near = pytest.approx([speed - change * cosine, change * sine], abs=2 * speed * 2e-7 / RADIUS)
    assert [found["a.vx"][-1], found["a.vy"][-1]] == near
    assert found["b.vx"][-1] == pytest.approx(-found["a.vx"][-1], abs=1e-9)


@pytest.mark.parametrize("clearance", [1e-4, 1e-6])
def test_a_near_miss_leaves_the_motion_as_it_is(clearance):
    post = {"name": "post", "motion": "fixed",
            "shapes": [{"type": "box", "size": ["1 mm", "100 mm"]}]}
    found = run(post, disc(at=[-0.107, 0.05 + RADIUS + clearance], velocity=[20, 0]), friction=0.3)
    assert found["disc.vx"][-1] == 20.0
    assert found["disc.vy"][-1] == found["disc.omega"][-1] == 0.0


def test_a_wall_is_found_by_a_disc_on_the_floor_of_the_same_body():
    floor = {"name": "floor", "motion": "fixed", "shapes": [
        {"type": "box", "size": ["400 mm", "1 mm"]},
        {"type": "box", "size": ["1 mm", "100 mm"], "at": ["199.5 mm", "50 mm"]}]}
    found = run(floor, disc(at=[-0.1, 0.0105], velocity=[30, 0]), restitution=0.3)
    assert found["disc.vx"][-1] == pytest.approx(-9, abs=1e-8)


@pytest.mark.parametrize("restitution", [0, 0.5])
def test_many_fast_discs_all_hit_the_plate(restitution):
    """Pairs of bodies beyond 256 are searched in another way."""
    discs = [disc(f"d{i}", at=[-0.17 + 0.014 * i, 0.1], velocity=[0, -20 - i],
                  shapes=[{"type": "circle", "radius": 0.005}]) for i in range(25)]
    found = run(PLATE, *discs, restitution=restitution)
    for i in range(25):
        assert found[f"d{i}.vy"][-1] == pytest.approx(restitution * (20 + i), abs=1e-7)
    assert not found.notes


def test_a_missed_meeting_is_reported():
    """The second corner of a thin box meets the plate in the step in which the first one does."""
    box = {"name": "box", "mass": MASS, "at": [0, 0.1], "angle": 0.3, "velocity": [0, -33],
           "shapes": [{"type": "box", "size": ["40 mm", "2 mm"]}]}
    assert "moved so fast that they overlapped" in run(PLATE, box).notes[0]
    assert not run(PLATE, box, step=2e-5).notes


def test_the_audit_takes_the_place_of_a_meeting_as_that_of_its_instant():
    """A fast rod that a thin peg stops: the point is where they meet, not where they are."""
    rod = {"name": "rod", "mass": 0.3, "angle": 2, "angular_velocity": -100, "centre": [0, 0],
           "shapes": [{"type": "capsule", "end": [0.2, 0], "radius": 0.002}]}
    peg = {"name": "peg", "motion": "fixed", "at": [0.15, 0],
           "shapes": [{"type": "circle", "radius": 0.001}]}
    pin = {"type": "pin", "name": "pin", "a": "frame", "b": "rod", "on_b": [0, 0]}
    found = run({"name": "frame", "motion": "fixed"}, peg, rod, duration=0.03, joints=[pin])
    assert abs(found["rod.omega"][-1]) < 0.1
    assert not [figure for figure in found.audit if figure.verdict == "look"]


def test_a_pellet_turns_a_pinned_thin_door():
    """Moments about the hinge stay; the speed of separation is e times that of approach."""
    step, arm, speed, mass = 1e-3, 0.15, 40.0, 0.01
    shape = {"type": "box", "size": [0.002, 0.2], "at": [0, 0.1]}
    door = {"name": "door", "mass": 1, "shapes": [shape]}
    pellet = {"name": "pellet", "mass": mass, "at": [-0.4, arm], "velocity": [speed, 0],
              "shapes": [{"type": "circle", "radius": 0.005}]}
    pin = {"type": "pin", "name": "hinge", "a": "frame", "b": "door", "on_b": [0, 0]}
    found = run({"name": "frame", "motion": "fixed"}, door, pellet, restitution=0.5, step=step,
                duration=0.2, joints=[pin])
    inertia = (0.2**2 + 0.002**2) / 12 + 0.1**2
    omega = 1.5 * mass * speed * arm / (inertia + mass * arm**2)
    error = (omega * step) ** 2  # of the second-order step
    assert found["door.omega"][-1] == pytest.approx(-omega, rel=error)
    assert found["pellet.vx"][-1] == pytest.approx(omega * arm - 0.5 * speed, rel=error)
    assert not [figure for figure in found.audit if figure.verdict == "look"]


@pytest.mark.parametrize(("along", "restitution"), [(1, 1), (1, 0.5), (-1, 1)])
def test_a_rough_rod_gains_no_energy_when_its_end_hits_the_floor(along, restitution):
    """It sticks; where v' = -e v would add energy, it rebounds with as much as it had."""
    half, radius, angle, speed = 0.05, 0.002, 0.9, 2.0
    arm = -half * math.cos(angle), -half * math.sin(angle) - radius
    rod = {"name": "rod", "mass": MASS, "angle": angle, "velocity": [along, -speed],
           "at": [0, 0.0111 - arm[1]],
           "shapes": [{"type": "capsule", "start": [-half, 0], "end": [half, 0], "radius": radius}]}
    floor = {"name": "floor", "motion": "fixed",
             "shapes": [{"type": "box", "size": [1, 0.1], "at": [0, -0.05]}]}
    found = run(floor, rod, friction=2.0, restitution=restitution)
    inertia = found.arrays["body_inertia"][1]
    push = [np.array([1 / MASS, 0, -arm[1] / inertia]), np.array([0, 1 / MASS, arm[0] / inertia])]
    to_rates = np.array([[1, 0, -arm[1]], [0, 1, arm[0]]])
    masses = np.linalg.inv(to_rates @ np.transpose(push))
    before = np.array([along, -speed])
    most = math.sqrt(before @ masses @ before / masses[1, 1]) / speed
    assert (most < restitution) == (along == 1 and restitution == 1)
    change = masses @ (np.array([0, min(restitution, most) * speed]) - before) @ np.array(push)
    motion = found.arrays["body_velocity"][-1, 1] + 5e-4 * found.arrays["body_acceleration"][-1, 1]
    assert motion == pytest.approx(np.array([along, -speed, 0]) + change, abs=2e-5)
    assert not [figure for figure in found.audit if figure.verdict == "look"]


@pytest.mark.parametrize("steps", [19, 30])  # they meet in the nineteenth
@pytest.mark.parametrize("restitution", [0, 0.5])
def test_the_audit_takes_the_arms_of_a_rough_meeting_at_its_instant(restitution, steps):
    """A box meets a disc that then spins: they rub there, 4 mm before they touch at the pose."""
    box = {"name": "box", "mass": 0.5, "at": [0.18, 0.18], "angle": -2.4, "velocity": [-7, 3.5],
           "shapes": [{"type": "box", "size": [0.033, 0.035]}]}
    ball = disc("ball", at=[-0.06, 0.18], velocity=[4.1, 4.1])
    found = run(box, ball, friction=1.0, restitution=restitution, duration=steps * 1e-3)
    assert found.arrays["contact_twist"].any()
    assert found.arrays["contact_sample"][0] == 18
    assert not [figure for figure in found.audit if figure.verdict == "look"]


def test_a_tendon_does_not_push_a_disc_off_a_wall():
    wall = {**PLATE, "at": [math.sqrt(0.005) + 0.0005 + RADIUS, 0], "angle": math.pi / 2}
    tendon = {"name": "t", "stiffness": 1e6, "guides": [
        {"body": "plate", "at": [0, wall["at"][0]]}, {"body": "disc"}]}
    found = run(wall, disc(at=[0, -0.1], velocity=[5, 0]), restitution=0.7, tendons=[tendon])
    assert found["disc.vx"][-1] == pytest.approx(-0.7 * 5 * math.sqrt(0.5), rel=0.1)  # at 45°


def test_a_fast_turning_rod_gives_a_ball_no_more_energy_than_it_loses():
    a = run(disc("rod", angle=-0.5, angular_velocity=200, shapes=[
        {"type": "box", "size": [0.06, 0.004]}]), disc(at=[0.005, 0.012]), restitution=1.0).arrays
    masses = np.stack([a["body_mass"], a["body_mass"], a["body_inertia"]], axis=1)
    energies = (masses * (a["body_velocity"] + 5e-4 * a["body_acceleration"])**2).sum(axis=(1, 2))
    assert len(a["impact_time"])
    assert energies == pytest.approx(masses[0, 2] * 200**2, rel=1e-9)


def test_a_disc_that_runs_round_a_bend_does_not_rebound():
    points = [[0.1 * math.cos(x), 0.1 * math.sin(x)] for x in np.arange(-3, 2, 0.1)]
    bend = {"name": "bend", "motion": "fixed", "shapes": [
        {"type": "curve", "closed": False, "points": points, "radius": 0.001}]}
    a = run(bend, disc(at=[0, -0.089], velocity=[5, 0]), restitution=0.5).arrays
    assert len(a["impact_time"]) == 1  # where it begins to carry m v^2 / R
    assert np.hypot(*a["contact_force"][3:].T) == pytest.approx(MASS * 5**2 / 0.089, rel=3e-3)
