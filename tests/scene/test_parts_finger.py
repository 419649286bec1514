"""A finger spelled out: frames, names, mirror, springs and tendon as mechanics places them."""

import math

import pytest
from pydantic import ValidationError

from sandbox.scene.elements.bodies import Body
from sandbox.scene.geometry import anchors, pose_of, to_world
from sandbox.scene.parts.finger import Finger, expand_finger, hinge_names, phalanx_names

SET_G = {
    "type": "finger", "name": "f",
    "lengths": ["45 mm", "26 mm", "21 mm"], "radii": ["9 mm", "8 mm", "7.5 mm"],
    "masses": ["12 g", "6 g", "4 g"],
    "guides": [["-22 mm", "-14 mm"], ["24 mm", "-8 mm"], ["10 mm", "-3 mm"], ["4 mm", "-1 mm"]],
    "springs": {"stiffness": "300 N/m", "from": ["-8 mm", "8 mm"], "to": ["8 mm", "8 mm"]},
    "damping": [4e-3, 1.2e-3, 3e-4], "limits": ["85 deg", "95 deg", "75 deg"],
}


def finger(**changes):
    return Finger.model_validate(SET_G | changes)


def worlds(elements, *, palm=None):
    """World points of everything that has a place: hinges, guides, spring ends."""
    bodies = {body.name: body for body in (*elements.bodies, *([palm] if palm else []))}
    points = []
    for joint in elements.joints:
        for name, at in zip((joint.a, joint.b),
                            anchors(joint, bodies[joint.a], bodies[joint.b]), strict=True):
            points.append(to_world(pose_of(bodies[name]), at))
    for spring in elements.springs:
        points.append(to_world(pose_of(bodies[spring.a]), spring.on_a))
        points.append(to_world(pose_of(bodies[spring.b]), spring.on_b))
    for guide in elements.tendons[0].guides:
        points.append(to_world(pose_of(bodies[guide.body]), guide.at))
    return points


def test_names_beyond_three_phalanges_are_numbers():
    assert phalanx_names(4) == ("phalanx1", "phalanx2", "phalanx3", "phalanx4")
    assert hinge_names(4)[3] == "hinge4"


def test_mass_centre_and_inertia_of_a_phalanx():
    body = expand_finger(finger()).bodies[1]
    assert body.mass == 0.012
    assert body.centre == (0.0225, 0.0)
    assert body.inertia == pytest.approx(0.012 * (0.045**2 / 12 + 0.009**2 / 4))


def test_palm_above_is_the_mirror_image():
    start = ["20 deg", "30 deg", "10 deg"]
    below = expand_finger(finger(start=start))
    above = expand_finger(finger(start=start, palm="above"))
    mirrored = [(x, -y) for x, y in worlds(below)]
    assert worlds(above) == [pytest.approx(point) for point in mirrored]
    assert {j.positive for j in above.joints} == {"counterclockwise"}
    for one, two in zip(below.bodies[0].shapes, above.bodies[0].shapes, strict=True):
        assert two.at == pytest.approx((one.at[0], -one.at[1]))


@pytest.mark.parametrize("side", ["below", "above"])
def test_on_a_body_is_the_same_finger_in_that_bodys_frame(side):
    palm = Body(name="hand", at=(0.3, 0.1), angle=0.4, motion="fixed")
    start = [0.1, 0.2, 0.3]
    held = finger(on="hand", at=[0.02, 0.01], angle=0.5, start=start, palm=side)
    made = expand_finger(held, palm=palm)
    place = to_world((0.3, 0.1, 0.4), (0.02, 0.01))
    free = expand_finger(finger(at=list(place), angle=0.9, start=start, palm=side))
    assert worlds(made, palm=palm) == [pytest.approx(point) for point in worlds(free)]
    assert [b.name for b in made.bodies] == ["f.proximal", "f.middle", "f.distal"]
    # joint angle = sense * (angle of b - angle of a) - zero must be the start rotation
    sense = 1 if made.joints[0].positive == "counterclockwise" else -1
    turned = sense * (made.bodies[0].angle - palm.angle) - made.joints[0].zero
    assert turned == pytest.approx(0.1)
    assert ("f.*", "hand") in [rule.between for rule in made.contacts]


def test_tendon_to_and_anchor():
    led = expand_finger(finger(tendon_to=[{"body": "lever", "at": [0, 0.01]}])).tendons[0]
    assert [g.body for g in led.guides[3:]] == ["f.palm", "lever"]
    anchored = expand_finger(finger(anchor=["-50 mm", 0])).tendons[0]
    assert anchored.guides[-1].at == (-0.05, 0)


def test_limits_may_have_a_lowest_angle():
    made = expand_finger(finger(limits=["85 deg", ["-10 deg", "95 deg"], "75 deg"]))
    assert made.joints[0].limits == (0.0, pytest.approx(math.radians(85)))
    assert made.joints[1].limits == pytest.approx((math.radians(-10), math.radians(95)))


def test_density_instead_of_masses():
    made = expand_finger(finger(masses=None, density=1100, thickness="15 mm"))
    assert made.bodies[1].density == 1100
    assert made.bodies[1].thickness == 0.015
    assert made.bodies[1].inertia is None


@pytest.mark.parametrize(("changes", "field", "words"), [
    ({"radii": [0.009]}, "radii", "expected 3 entries, got 1"),
    ({"guides": [[0, 0]] * 3}, "guides", "expected 4 entries, got 3"),
    ({"damping": [1, 2]}, "damping", "expected 1 or 3 entries, got 2"),
    ({"springs": {"stiffness": [1, 2], "from": [0, 0], "to": [0, 0]}}, "springs", "'stiffness'"),
    ({"masses": None}, None, "either 'masses' or 'density'"),
    ({"density": 1100}, None, "either 'masses' or 'density'"),
])
def test_wrong_counts_are_named_where_they_are(changes, field, words):
    with pytest.raises(ValidationError) as caught:
        finger(**changes)
    (error,) = caught.value.errors()
    assert error["loc"] == ((field,) if field else ())
    assert words in error["msg"]
