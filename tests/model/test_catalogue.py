
import pytest

from sandbox.model.catalogue import Catalogue, UnknownQuantityError
from sandbox.model.meters import check_quantities
from sandbox.scene.mechanism import Mechanism
from tests.recording.sample import mechanism


@pytest.mark.parametrize("name", [
    "disc", ".x", "", "disc.contact", "disc.x.y", "finger1.x", "disc/disc.normal", "disc/palm.x",
    "disc/nobody.normal", "/", "a/b/c.normal",
])
def test_what_is_not_a_quantity(name):
    with pytest.raises(UnknownQuantityError):
        Catalogue(mechanism()).find(name)


def test_the_longest_element_that_has_the_quantity_wins():
    nested = mechanism(bodies=[
        {"name": name, "mass": 1, "inertia": 1} for name in ("a", "a.b", "a.contact")],
        joints=[], springs=[], tendons=[], drives=[], groups=[])
    for name, index, quantity in (
            ("a.b.x", 1, "x"), ("a.contact.x", 2, "x"), ("a.contact.fx", 0, "contact.fx")):
        source = Catalogue(nested).find(name)
        assert (source.kind, source.index, source.quantity) == ("body", index, quantity)


def test_match_follows_patterns_in_catalogue_order():
    known = Catalogue(mechanism())
    assert known.match("finger1.*.angle") == [
        "finger1.proximal.angle", "finger1.distal.angle", "finger1.mcp.angle", "finger1.pip.angle"]
    assert known.match("*.tension") == ["leash.tension", "finger1.tendon.tension"]
    assert known.match("FINGER1.*") == []
    assert known.match("disc.x") == ["disc.x"]
    assert known.match("disc.z") == []


def test_pairs_match_once_and_only_where_they_can_touch():
    known = Catalogue(mechanism())
    every = known.match("*/*.normal")
    # 10 pairs of the 5 bodies with a shape, less palm and plate: neither is moved by forces
    assert len(every) == len(set(every)) == 9
    assert "disc/palm.normal" in every
    assert "palm/disc.normal" not in every
    assert "finger1.proximal/finger1.distal.normal" in every
    assert known.match("palm/*.normal") == [
        "palm/finger1.proximal.normal", "palm/finger1.distal.normal", "palm/disc.normal"]
    assert known.match("disc/finger1*.tangential") == [
        "disc/finger1.proximal.tangential", "disc/finger1.distal.tangential"]


@pytest.mark.parametrize(("wrong", "meant"), [
    ("disc.contact.norml", "disc.contact.normal"),
    ("finger1.distl.x", "finger1.distal.x"),
    ("finger1.distl.contact.fx", "finger1.distal.contact.fx"),
    ("finger1.mpc.angle", "finger1.mcp.angle"),
    ("disc.axx", "disc.ax"),  # of two letters and of four beside it others would be near, or none
    ("grapefruit", ""),
])
def test_near_misses(wrong, meant):
    assert Catalogue(mechanism()).near(wrong) == meant


@pytest.mark.parametrize(("name", "needs"), [
    ("finger1.mcp.friction", "'friction' or 'friction_coefficient'"),
    ("finger1.mcp.held", "'breaks_at', or an event that releases it"),
    ("finger1.tendon.tension_0", "'friction' at one of its guides"),
    ("finger1.tendon.lifted_1", ""),  # an end, which holds the cord whatever it is given
    ("leash.friction", ""),
])
def test_what_an_element_would_have_to_be_given_is_told(name, needs):
    known = Catalogue(mechanism())
    if needs:
        needs = f"'{name.rpartition('.')[0]}' has it only with {needs}"
    assert known.lacking(name) == needs
    with pytest.raises(UnknownQuantityError) as caught:
        known.find(name)
    assert not needs or str(caught.value) == f"unknown quantity {name!r}: {needs}"


def meters(**values):
    return [{"name": name, "value": value} for name, value in values.items()]


@pytest.mark.parametrize("text", ["=disc/finger.normal", "=2 * disc / finger.normal + disc.x / t"])
def test_a_pair_in_an_expression_is_a_division(text):
    """Bound expressions have blanks round their strokes; disc.x / t divides."""
    bodies = [{"name": name, "mass": 1, "inertia": 1} for name in ("disc", "finger")]
    (problem,) = check_quantities(
        Mechanism.model_validate({"bodies": bodies, "meters": meters(a=text)}))
    assert problem.path == "$.meters[0].value"
    assert problem.message.startswith("'/' divides in an expression")
    assert problem.allowed.startswith("'disc.contact.normal' or 'finger.contact.normal', the sums")


def test_every_problem_is_told_with_its_place():
    mech = mechanism(
        meters=meters(a="=disc.xx + 1", b="=c", c="=d + a", d="=b", e="=1", **{"disc.x": "=2"}),
        expect=[{"mean": "finger*.tendon.tensoin", "is": 1}, {"final": "disk.x", "is": 1},
                {"max": "nothing*", "below": 1}, {"quantity": "disc.yy", "at": 99, "is": 1}])
    told = {problem.path: problem for problem in check_quantities(mech)}
    assert set(told) == {"$.meters[0].value", "$.meters[1].value", "$.meters[4].name",
                         "$.meters[5].name", "$.expect[0].mean", "$.expect[1].final",
                         "$.expect[2].max", "$.expect[3].quantity", "$.expect[3].at"}
    assert told["$.expect[3].at"].code == "bad-time"
    assert told["$.expect[3].at"].message.startswith("the instant is 99 s, the run ends ")
    assert told["$.meters[0].value"].hint == "'disc.x'"
    assert told["$.meters[0].value"].allowed.endswith("'disc.contact.fy'")  # all of a body
    assert told["$.meters[1].value"].message == (
        "meters depend on each other in a circle: 'b' → 'c' → 'd' → 'b'")
    assert told["$.expect[0].mean"].hint == "'finger*.tendon.tension'"


def test_what_is_expected_has_the_unit_of_its_quantity():
    mech = mechanism(
        meters=[{"name": "lift", "value": "=disc.y", "unit": "m"},
                {"name": "score", "value": "=disc.y", "unit": "points"}],
        expect=[{"mean": "disc.x", "is": "3 kg", "within": "1 N"},
                {"max": "finger*.tendon.tension", "between": ["1 N", "2 m"]},
                {"max": "finger*/disc.normal", "above": "1 Pa", "below": "3 kN",
                 "over": "last 1 ms"},
                {"final": "lift", "above": "1 s", "over": ["1 mm", "10 ms"]},
                {"final": "score", "is": "3 kg"}, {"final": "disc.contact.fx", "is": "1 kN",
                                                   "within": "0.1 %"},
                {"min": "finger*.tendon.work", "above": "1 mJ"},
                {"min": "finger*.tendon.work", "above": "1 N m"}])
    told = {problem.path: problem for problem in check_quantities(mech)}
    assert told.keys() == {
        "$.expect[0].is", "$.expect[0].within", "$.expect[1].between[1]", "$.expect[2].above",
        "$.expect[3].above", "$.expect[3].over[0]", "$.expect[7].above"}
    assert told["$.expect[7].above"].message == ("'N m' is a unit of torque, but this is an energy")
    assert "mm" in told["$.expect[0].is"].allowed
