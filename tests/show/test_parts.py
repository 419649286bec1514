"""What Python says is drawn, and what the script can draw: the same words on both sides."""

import re
from pathlib import Path

import numpy as np
import pytest

from sandbox import show
from sandbox.engine.simulate import simulate
from sandbox.notebook.cards import at_start
from sandbox.picture.bars import bars_of
from sandbox.picture.elements.drives import DRIVES
from sandbox.picture.elements.joints import JOINTS
from sandbox.scene.expand import expand
from sandbox.scene.read.load import load_scene
from sandbox.show.header import COLOURS, drawing
from sandbox.show.sizes import declared
from sandbox.show.web_files import LIVE, MODULES, text_of
from tests.draw.conftest import hand, zoo

HERE = Path(show.__file__).parent
SCRIPT = "\n".join(text_of(name) for name in MODULES)
SOURCES = "\n".join(path.read_text(encoding="utf-8") for path in HERE.glob("*.py"))


def kinds_of_python():
    """Every kind of part that the sources name, and those that tables give."""
    found = set(re.findall(r'"k": "(\w+)"', SOURCES))
    pairs = re.findall(r'"k": "(\w+)" if .* else "(\w+)"', SOURCES)
    found |= {word for pair in pairs for word in pair}
    looks = {look.mark for look in (*JOINTS.values(), *DRIVES.values())}
    return (found | looks | {look.link for look in JOINTS.values()}) - {""}


def test_the_script_draws_each_kind_that_python_names_and_no_other():
    assert set(re.findall(r"^KINDS\.(\w+) =", SCRIPT, re.M)) == kinds_of_python()


def test_a_cord_goes_around_wheels_that_it_has_turns_on():
    ends = [{"name": f"b{k}", "mass": 1, "inertia": 1, "at": [0.04 * k - 0.02, -0.1]}
            for k in (0, 1)]
    wheel = {"body": "frame", "radius": 0.02, "turns": 2}
    run = simulate(expand(load_scene({
        "run": {"duration": 0.001},
        "bodies": [{"name": "frame", "motion": "fixed"}, *ends],
        "tendons": [{"name": "c", "guides": [{"body": "b0"}, wheel, {"body": "b1"}]}]})))
    [cord] = [part for part in drawing(run)["parts"] if part["k"] == "cord"]
    assert [guide[5] for guide in cord["g"]] == [0, 1, 0]


def test_the_night_has_an_ink_for_each_of_the_palette():
    night = re.search(r"NIGHT_INKS = \{(.*?)\};", SCRIPT, re.S)[1]
    assert set(re.findall(r"(\w+):", night)) == set(COLOURS)
    assert set(re.findall(r'ink\("(\w+)"\)', SCRIPT)) <= set(COLOURS)


def test_a_view_that_shows_layers_of_some_bodies_is_heeded():
    run = hand()
    fingers = ("finger2.proximal", "finger2.middle", "finger2.distal")
    view = run.mechanism.view.model_copy(update={"show": {
        "contacts": ("section1*",), "bodies": ("finger2*", "tree*"), "velocity": ("finger2*",),
        "reactions": ("finger2.proximal",), "traces": ("finger3.distal", "finger2.middle"),
        "axes": ("finger2.*",), "body_names": ("finger2.*",)}})
    mechanism = run.mechanism.model_copy(update={"view": view})
    moving = {**run.arrays, **{name: np.ones_like(run.arrays[name]) for name in (
        "body_velocity", "joint_force")}}
    head = drawing(type(run)(mechanism, moving, run.info))
    names = [body["name"] for body in head["bodies"]]
    shown = {part["n"] for part in head["parts"] if part["l"] == "bodies" and "n" in part}
    assert shown == {name for name in names if name.startswith(("finger2", "tree"))}
    parts = {part["l"]: part for part in head["parts"] if "of" in part}
    assert {names[b] for b in parts["contacts"]["of"]} == {"section1.circle", "section1.square"}
    vectors = {layer: [names[parts[layer]["at"][i][0]] for i in parts[layer]["of"]]
               for layer in ("velocity", "reactions")}
    assert set(vectors["velocity"]) == set(fingers)
    assert len(vectors["reactions"]) == 2  # of the hinge that begins it, and that ends it
    traces = [part for part in head["parts"] if part["k"] == "trace"]
    assert [(names[part["at"][0]], part["w"]) for part in traces] == [
        ("finger3.distal", 0), ("finger2.middle", 1)]
    for kind in ("axes", "name"):
        assert {names[part["b"]] for part in head["parts"] if part["k"] == kind} >= set(fingers)
        assert "finger1.distal" not in {
            names[part["b"]] for part in head["parts"] if part["k"] == kind}


def loaded():
    return simulate(expand(load_scene("fields", overrides={"run.duration": 0.1})))


@pytest.mark.parametrize(("kind", "layer"), [
    ("contact_force", "contacts"), ("body_velocity", "velocity"), ("load_force", "loads"),
    ("drive_value", "drives"), ("joint_force", "reactions")])
def test_the_legend_tells_of_cut_arrows_of_every_kind(kind, layer):
    run = {"contacts": hand, "loads": loaded}.get(layer, zoo)()

    def told(arrays):
        items = drawing(type(run)(run.mechanism, {**run.arrays, **arrays}, run.info))["legend"]
        return [layer for item in items if item["s"] == "cut" for layer in item["l"]]

    even = {name: np.ones_like(run.arrays[name]) for name in (
        "contact_force", "body_velocity", "body_acceleration", "load_force", "drive_value",
        "joint_force")}
    even["body_velocity"][..., 2] = 0.0
    even["body_acceleration"][:] = 0.0
    assert told(even) == []
    blow = even[kind].copy()
    blow[len(blow) // 2] *= 100.0
    blow[len(blow) // 2] *= np.array([1, 1, 0]) if kind == "body_velocity" else 1.0
    assert told({**even, kind: blow}) == [layer]


def test_lifts_are_placed_by_their_moment_and_other_loads_are_not():
    run = at_start(expand(load_scene("floating")))
    [part] = [part for part in drawing(run)["parts"] if part["k"] == "loads"]
    kinds = {load.name: load.type for load in run.mechanism.loads}
    assert part["lifts"] == [kinds[name] == "buoyancy" for name in part["names"]]
    assert any(part["lifts"])


def test_each_bar_has_the_column_of_what_it_carries_itself():
    run = zoo()
    parts = [part for part in drawing(run)["parts"] if part["k"] == "band"]
    names = [body.name for body in run.mechanism.bodies]
    bars = bars_of(run, range(len(names)))
    assert len(parts) > 1
    assert {part["n"]: part["j"] for part in parts} == {
        names[bar.body]: column for column, bar in enumerate(bars)}


def test_no_two_files_of_the_script_declare_one_name():
    """They share a scope: one name twice and nothing of the page runs."""
    text = "\n".join([declared(), *(text_of(name) for name in (*MODULES, *LIVE))])
    names = re.findall(r"^(?:async )?(?:function|class) (\w+)", text, re.M)
    for line in re.findall(r"^(?:const|let) (.*)", text, re.M):
        names += re.findall(r"(?:^|, )(\w+) = ", line)
    assert len(names) > 150
    assert sorted(names) == sorted(set(names))
