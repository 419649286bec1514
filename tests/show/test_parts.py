"""What Python says is drawn, and what the script can draw: the same words on both sides."""

import re
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest

from sandbox import show
from sandbox.draw.film import drives, joints, legend
from sandbox.draw.film.bars import bars_of
from sandbox.draw.film.drives import DRIVES
from sandbox.draw.film.frames import FrameRenderer
from sandbox.draw.film.marked import traced
from sandbox.draw.film.points import PointPool
from sandbox.draw.film.symbols import SYMBOLS
from sandbox.draw.film.tensions import tensions_of
from sandbox.draw.film.vectors import reactions
from sandbox.engine.simulate import simulate
from sandbox.kinds.layers import EVERY, LAYERS, PASSES
from sandbox.notebook.start import at_start
from sandbox.scene.expand import expand
from sandbox.scene.read.load import load_scene
from sandbox.show.channels import STEADY, channels
from sandbox.show.header import COLOURS, drawing
from sandbox.show.sizes import SIZES, declared
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
    return found | {*joints.MARKS, *joints.LINKS, *drives.HINGE_MARKS}


def test_the_script_draws_each_kind_that_python_names_and_no_other():
    assert set(re.findall(r"^KINDS\.(\w+) =", SCRIPT, re.M)) == kinds_of_python()


def test_every_line_of_a_legend_is_drawn_by_films_and_pages():
    assert set(legend.DRAWN) == set(SYMBOLS) - {"bars"}  # films have one scale of all tensions
    signs = {name for row in DRIVES.values() for name in row.legend}
    assert signs <= set(SYMBOLS)
    assert set(SYMBOLS) == symbols_of_the_script() - {"length", "force", "load", "vector"}


def symbols_of_the_script():
    table = re.search(r"^const SYMBOLS = \{(.*?)^\};", SCRIPT, re.M | re.S)[1]
    return set(re.findall(r"^  (\w+): \(s, ", table, re.M)) | set(
        re.findall(r"^SYMBOLS\.(\w+) =", SCRIPT, re.M))


@pytest.mark.parametrize("name", ["hydraulic_lift", "release", "servo_arm", "capstan"])
def test_films_and_pages_tell_the_same_of_a_run(name):
    """The words of a page are those of a film but for scales, which hang on the picture's size."""
    run = at_start(expand(load_scene(name)))
    film = FrameRenderer(run)
    shown = legend.items_for(film.content, film.camera.scale, film.unit)
    page = [row["after"] for row in drawing(run)["legend"]
            if "w" in row and any(layer in film.layers for layer in row["l"])]
    assert [item.after for item in shown if item.after in page] == page
    assert {"valve open", "may let go", "motor", "friction holds", "servo"} & set(page)


@pytest.mark.parametrize("run", [hand(), zoo()], ids=["hand", "zoo"])
def test_what_a_header_names_is_known_to_the_script(run):
    head = drawing(run)
    assert {item["s"] for item in head["legend"]} <= symbols_of_the_script()
    assert {part["l"] for part in head["parts"]} <= set(LAYERS)
    assert all(0 <= part["f"] < len(head["fills"]) for part in head["parts"] if "f" in part)


def test_films_and_pages_draw_in_one_order():
    run, head = zoo(), drawing(zoo())
    every = run.mechanism.view.model_copy(update={"show": dict.fromkeys(LAYERS, EVERY)})
    assert set(FrameRenderer(run, view=every)._drawn_by._table()) == set(PASSES)
    layers = [part["l"] for part in head["parts"]]
    assert layers.index("bodies") < layers.index("springs") < layers.index("contacts")
    order = [part["k"] for part in head["parts"]]
    assert order.index("poly") < order.index("coil") < order.index("pin") < order.index("cord")


def test_the_script_reads_the_channels_that_python_writes():
    text = (HERE / "channels.py").read_text(encoding="utf-8")
    written = set(re.findall(r'^ {8}"(\w+)": ', text, re.M))
    assert {name for name in written if re.search(rf"\bf\.{name}\b", SCRIPT)} == written
    assert set(STEADY) <= written


def test_the_sizes_of_the_films_are_the_scripts_and_stand_once():
    for name in SIZES:
        assert re.search(rf"\b{name}\b", SCRIPT), name
        assert not re.search(rf"\b{name} = ", SCRIPT), name
    assert "PIN = 3.6," in declared()
    assert "SLIM = [[5.4, 12], [3.4, 11]]" in declared()


def test_a_channel_has_a_column_for_each_that_parts_ask_for():
    run = zoo()
    found, head = channels(run.model, run.arrays), drawing(run)
    cords = [part for part in head["parts"] if part["k"] == "cord"]
    assert max(c for part in cords for c in part["c"]) == found["tension"].shape[1] - 1
    assert found["pose"].shape[1] == 3 * len(head["moving"])
    assert found["drive"].shape[1] == len(head["drives"])


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


def test_a_page_has_the_colours_of_its_pictures_by_day_and_by_night():
    day, dark = (dict(re.findall(r"--(\w+): (#\w+);", block)) for block in re.findall(
        r":root \{(.*?)\}", text_of("sandbox.css"), re.S))
    night = dict(re.findall(r'(\w+): "(#\w+)"', re.search(
        r"NIGHT_INKS = \{(.*?)\};", SCRIPT, re.S)[1]))
    colours = drawing(zoo())["colours"]
    for name, ink in (("ink", "INK"), ("line", "HAIRLINE"), ("accent", "FORCE")):
        assert (day[name], dark[name]) == (colours[ink], night[ink])
    assert (day["back"], dark["faint"]) == (colours["BACKGROUND"], night["FAINT_INK"])
    assert f'NIGHT = "{dark["back"]}"' in SCRIPT


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


@pytest.mark.parametrize(("layer", "kind"), [("axes", "axes"), ("body_names", "name")])
def test_axes_and_names_are_of_the_bodies_that_the_view_names_and_of_fixed_ones(layer, kind):
    run = zoo()
    names = [body.name for body in run.mechanism.bodies]

    def shown(view):
        mechanism = run.mechanism.model_copy(update={"view": run.mechanism.view.model_copy(
            update={"show": view})})
        head = drawing(type(run)(mechanism, run.arrays, run.info))
        return [names[part["b"]] for part in head["parts"] if part["k"] == kind]

    assert shown({}) == names
    assert shown({layer: ("w*", "floor")}) == [
        name for name in names if name.startswith("w") or name == "floor"]
    assert "floor" in shown({layer: ("w*", "floor")})


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


@pytest.mark.parametrize("most", [1, 99])
def test_numbers_stand_on_bars_where_films_write_them(monkeypatch, most):
    for module in (joints, show.parts, show.joints):
        monkeypatch.setattr(module, "TELLING", most)
    run = simulate(expand(load_scene("truss", overrides={"run.duration": 0.05})))
    told = {part["k"]: part["told"] for part in drawing(run)["parts"] if "told" in part}
    film = joints.JointDrawer(run, tensions_of(run), PointPool())
    assert set(told.values()) == {most > 1} == {bool(film._told)}
    assert {part["told"] for part in drawing(zoo())["parts"] if part["k"] == "band"} == {most > 1}


def test_no_two_files_of_the_script_declare_one_name():
    """They share a scope: one name twice and nothing of the page runs."""
    text = "\n".join([declared(), *(text_of(name) for name in (*MODULES, *LIVE))])
    names = re.findall(r"^(?:async )?(?:function|class) (\w+)", text, re.M)
    for line in re.findall(r"^(?:const|let) (.*)", text, re.M):
        names += re.findall(r"(?:^|, )(\w+) = ", line)
    assert len(names) > 150
    assert sorted(names) == sorted(set(names))


def test_the_script_is_in_short_files_of_ascii():
    folder = files("sandbox.show").joinpath("web")
    there = {file.name for file in folder.iterdir() if file.is_file()}
    assert there == {*MODULES, *LIVE, "sandbox.css"}
    for name in there:
        text = text_of(name)
        assert text.isascii(), name
        assert text.count("\n") <= 300, name


def test_no_name_stands_twice_in_what_a_browser_loads_together():
    """All files are one script: a second ``const`` of a name is an error of the whole page."""
    names = re.findall(r"^(?:const|let|class|function|async function) ([^=;{(]*)",
                       "\n".join(text_of(name) for name in (*MODULES, *LIVE)), re.M)
    lists = re.findall(r"^(?:const|let) (.*?);", "\n".join(
        text_of(name) for name in (*MODULES, *LIVE)), re.M)
    names = [name.strip() for name in names]
    names += [name for row in lists for name in re.findall(r", ([A-Z_]+) = ", row)]
    names += re.findall(r"([A-Z_]+) = ", declared())
    twice = {name for name in names if names.count(name) > 1}
    assert not twice
