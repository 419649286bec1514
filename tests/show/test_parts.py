"""What Python says is drawn, and what the script can draw: the same words on both sides."""

import re
from pathlib import Path

import numpy as np
import pytest

from sandbox.draw.film.drives import DRIVES, FRICTION, STIFFENED_CORD
from sandbox.draw.film.fluids import valve_entries
from sandbox.draw.film.joints import JOINTS
from sandbox.draw.film.marked import traced
from sandbox.draw.film.vectors import reactions
from sandbox.kinds.layers import LAYERS
from sandbox.notebook.start import at_start
from sandbox.scene.expand import expand
from sandbox.scene.read.load import load_scene
from sandbox.show import drives, joints
from sandbox.show.channels import channels, vectors_of
from sandbox.show.header import COLOURS, DRAWN, DRIVE_SYMBOLS, drawing
from sandbox.show.web_files import MODULES, text_of
from tests.draw.conftest import hand, zoo

HERE = Path(joints.__file__).parent
SCRIPT = "\n".join(text_of(name) for name in MODULES)


def kinds_of_python():
    """Every kind of part that the sources name, and those that tables give."""
    text = "\n".join(path.read_text(encoding="utf-8") for path in HERE.glob("*.py"))
    found = set(re.findall(r'"k": "(\w+)"', text))
    pairs = re.findall(r'"k": "(\w+)" if .* else "(\w+)"', text)
    found |= {word for pair in pairs for word in pair}
    return found | {kind for table in (joints.MARKS, joints.LINKS, drives.MARKS)
                    for kind in table.values() if kind}


def test_the_script_draws_each_kind_that_python_names_and_no_other():
    assert set(re.findall(r"^KINDS\.(\w+) =", SCRIPT, re.M)) == kinds_of_python()


def test_every_mark_and_link_of_the_films_has_its_kind_of_part():
    assert {row.mark for row in JOINTS.values()} <= set(joints.MARKS)
    assert {row.link for row in JOINTS.values()} <= set(joints.LINKS)
    assert {row.mark for row in DRIVES.values()} <= set(drives.MARKS)


def test_every_line_of_the_films_legend_has_its_symbol():
    entries = [entry.words for row in DRIVES.values() for entry in row.legend]
    entries += [entry.words for entry in FRICTION] + [STIFFENED_CORD.words]
    assert set(entries) == set(DRIVE_SYMBOLS)
    assert set(DRIVE_SYMBOLS.values()) <= set(re.findall(r"^  (\w+): \[", SCRIPT, re.M))


def test_the_legend_tells_open_valves_from_shut_ones():
    run = at_start(expand(load_scene("hydraulic_lift")))
    told = {item["after"]: item["s"] for item in drawing(run)["legend"]}
    assert [told.get(entry.words) for entry in valve_entries(run.model)] == ["open", "shut"]


@pytest.mark.parametrize("run", [hand(), zoo()], ids=["hand", "zoo"])
def test_what_a_header_names_is_known_to_the_script(run):
    head = drawing(run)
    symbols = set(re.findall(r"^  (\w+): \[", SCRIPT, re.M))
    assert {item["s"] for item in head["legend"]} <= symbols
    assert {part["l"] for part in head["parts"]} <= set(DRAWN) <= set(LAYERS)
    assert all(0 <= part["f"] < len(head["fills"]) for part in head["parts"] if "f" in part)


def test_a_browser_draws_every_layer_but_those_of_films_alone():
    assert set(LAYERS) - set(DRAWN) == {"pressure"}


def test_the_script_reads_the_channels_that_python_writes():
    words = set(re.search(r"const SMOOTH = \[(.*?)\]", SCRIPT)[1].split(", "))
    words |= set(re.search(r"const STEADY = \[(.*?)\]", SCRIPT)[1].split(", "))
    text = (HERE / "channels.py").read_text(encoding="utf-8")
    assert {word.strip('"') for word in words} | {"pose"} == set(
        re.findall(r'^ {8}"(\w+)": ', text, re.M)) | set(vectors_of(zoo()))


def test_a_channel_has_a_column_for_each_that_parts_ask_for():
    run = zoo()
    found, head = channels(run.model, run.arrays), drawing(run)
    cords = [part for part in head["parts"] if part["k"] == "cord"]
    assert max(c for part in cords for c in part["c"]) == found["tension"].shape[1] - 1
    assert found["pose"].shape[1] == 3 * len(head["moving"])
    assert found["drive"].shape[1] == len(head["drives"])


def test_the_night_has_an_ink_for_each_of_the_palette():
    night = re.search(r"NIGHT_INKS = \{(.*?)\};", SCRIPT, re.S)[1]
    assert set(re.findall(r"(\w+):", night)) == set(COLOURS)
    assert set(re.findall(r'ink\("(\w+)"\)', SCRIPT)) <= set(COLOURS)


def test_bodies_lie_in_the_films_order():
    run = zoo()
    names = [part["n"] for part in drawing(run)["parts"] if part["l"] == "bodies" and "n" in part]
    assert names.index("floor") < names.index("weight") < names.index("coupler")
    assert names.index("coupler") < names.index("wheel")


def test_a_view_that_shows_layers_of_some_bodies_is_heeded():
    run = hand()
    view = run.mechanism.view.model_copy(update={"show": {
        "contacts": ("section1*",), "bodies": ("finger2*", "tree*"), "velocity": ("finger2*",)}})
    mechanism = run.mechanism.model_copy(update={"view": view})
    moving = {**run.arrays, "body_velocity": np.ones_like(run.arrays["body_velocity"])}
    head = drawing(type(run)(mechanism, moving, run.info))
    names = [body["name"] for body in head["bodies"]]
    shown = {part["n"] for part in head["parts"] if part["l"] == "bodies" and "n" in part}
    assert shown == {name for name in names if name.startswith(("finger2", "tree"))}
    parts = {part["k"]: part for part in head["parts"] if "of" in part}
    assert {names[b] for b in parts["contacts"]["of"]} == {"section1.circle", "section1.square"}
    assert {names[parts["vectors"]["at"][i][0]] for i in parts["vectors"]["of"]} == {
        "finger2.proximal", "finger2.middle", "finger2.distal"}


def test_traces_of_some_bodies_are_those_of_the_film_and_numbered_as_they_come():
    run = hand()
    names = [body.name for body in run.mechanism.bodies]
    view = run.mechanism.view.model_copy(update={"show": {
        "traces": ("finger3.distal", "finger2.middle")}})
    some = type(run)(run.mechanism.model_copy(update={"view": view}), run.arrays, run.info)
    parts = [part for part in drawing(some)["parts"] if part["k"] == "trace"]
    assert [names[part["at"][0]] for part in parts] == ["finger3.distal", "finger2.middle"]
    assert [part["w"] for part in parts] == [0, 1]
    places = traced(some, view, view.show["traces"])
    assert [part["at"][0] for part in parts] == [body for body, _ in places]


def test_forces_of_hinges_of_some_bodies_are_those_of_the_film():
    run = hand()
    view = run.mechanism.view.model_copy(update={"show": {"reactions": ("finger2.proximal",)}})
    pushed = {**run.arrays, "joint_force": np.ones_like(run.arrays["joint_force"])}
    some = type(run)(run.mechanism.model_copy(update={"view": view}), pushed, run.info)
    part = next(part for part in drawing(some)["parts"] if part["l"] == "reactions")
    body = [body.name for body in run.mechanism.bodies].index("finger2.proximal")
    film = reactions(some, [body])
    assert len(part["of"]) == len(film.places) == 2  # one that begins it, one that ends it
    assert [part["at"][k][0] for k in part["of"]] == [body for body, _ in film.places]


def test_the_script_is_in_short_files_of_ascii():
    for name in (*MODULES, "sandbox.css"):
        text = text_of(name)
        assert text.isascii(), name
        assert text.count("\n") <= 300, name
