"""Outlines from SVG and DXF files: what becomes of them, where they lie, what is wrong."""

from __future__ import annotations

import builtins
import json
import math

import ezdxf
import pytest

from sandbox.errors import SceneError
from sandbox.scene.geometry import area_properties
from sandbox.scene.read.load import load_scene

HEAD = '<svg xmlns="http://www.w3.org/2000/svg" width="40mm" height="20mm" viewBox="-5 -5 40 20">'
PLATE = f'''{HEAD}<g id="plate"><path d="M 0 0 H 20 A 5 5 0 0 1 20 10 H 0 Z"/>
<circle cx="5" cy="5" r="2"/></g><rect id="far" x="30" y="0" width="3" height="3"/></svg>'''


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "plate.svg").write_text(PLATE)
    drawing = ezdxf.new(units=4)
    space = drawing.modelspace()
    for start, end in (((20, 0), (0, 0)), ((0, 10), (0, 0)), ((0, 10), (20, 10))):
        space.add_line(start, end)
    space.add_arc((20, 5), 5, -90, 90)
    space.add_circle((5, 5), 2, dxfattribs={"layer": "holes"})
    drawing.saveas(tmp_path / "plate.dxf")
    return tmp_path


def shape(folder, **keys):
    scene = {"bodies": [{"name": "x", "motion": "fixed", "shapes": [{"type": "drawing", **keys}]}]}
    path = folder / "scene.json"
    path.write_text(json.dumps(scene))
    return load_scene(path).bodies[0].shapes[0]


def refused(folder, **keys) -> str:
    with pytest.raises(SceneError) as raised:
        shape(folder, **keys)
    assert "$.bodies[0].shapes[0]" in str(raised.value)
    return str(raised.value)


AREA = (200 + math.pi * 25 / 2 - math.pi * 4) * 1e-6
CENTRE = (200 * 10 + math.pi * 25 / 2 * (20 + 20 / (3 * math.pi)) - math.pi * 4 * 5) / (
    AREA * 1e6) * 1e-3


@pytest.mark.parametrize(("keys", "up"), [
    ({"file": "plate.svg", "layer": "plate"}, -1), ({"file": "plate.dxf"}, 1)])
def test_a_plate_is_as_large_as_drawn(folder, keys, up):
    """In the units that the file says; its y is up, so what an SVG draws downwards is below."""
    found = shape(folder, tolerance="1 um", **keys)
    area, centre, _ = area_properties(found)
    assert len(found.holes) == 1
    assert area == pytest.approx(AREA, rel=1e-4)
    assert centre == pytest.approx((CENTRE, up * 0.005), abs=1e-6)


def test_the_unit_of_a_drawing_may_be_said(folder):
    small = shape(folder, file="plate.dxf", tolerance="1 um")
    for unit, factor in (("2 mm", 2), (1e-3, 1)):
        found = shape(folder, file="plate.dxf", unit=unit, tolerance=f"{factor} um")
        assert area_properties(found)[0] == pytest.approx(factor**2 * area_properties(small)[0])
    doubled = shape(folder, file="plate.svg", layer="plate", unit="2 mm", tolerance="1 um")
    assert area_properties(doubled)[0] == pytest.approx(4 * AREA, rel=1e-4)


def test_once_read_it_needs_no_file(folder):
    found = shape(folder, file="plate.dxf")
    (folder / "plate.dxf").unlink()
    again = load_scene({"bodies": [{"name": "x", "motion": "fixed",
                                    "shapes": [found.model_dump(mode="json")]}]})
    assert again.bodies[0].shapes[0] == found


def test_a_layer_takes_what_is_on_it(folder):
    assert shape(folder, file="plate.dxf", layer="0").holes == ()
    found = area_properties(shape(folder, file="plate.dxf", layer="holes", tolerance="1 um"))
    assert found[0] == pytest.approx(math.pi * 4e-6, rel=1e-3)
    assert "Did you mean 'holes'?" in refused(folder, file="plate.dxf", layer="hole")
    assert "it has no id 'plat'" in refused(folder, file="plate.svg", layer="plat")


# --- where files may lie


@pytest.mark.parametrize("name", [
    "../plate.svg", "/etc/plate.svg", "a/../../plate.svg", "C:plate.svg", "a\\plate.svg",
    "\x00.svg"])
def test_a_file_of_another_place_is_not_read(folder, name):
    assert "no file of the scene's own folder" in refused(folder, file=name)


def test_a_link_out_of_the_folder_is_not_followed(folder, tmp_path_factory):
    outside = tmp_path_factory.mktemp("outside")
    (outside / "plate.svg").write_text(PLATE)
    (folder / "link.svg").symlink_to(outside / "plate.svg")
    (folder / "under").symlink_to(outside)
    (folder / "own.svg").symlink_to(folder / "plate.svg")
    for name in ("link.svg", "under/plate.svg"):
        assert "by a link" in refused(folder, file=name)
    assert shape(folder, file="own.svg", layer="plate").holes


def test_a_file_that_is_not_there_is_told_with_a_near_miss(folder):
    text = refused(folder, file="plat.svg")
    assert "there is no file 'plat.svg'" in text
    assert "Did you mean 'plate.svg'? Allowed: 'plate.dxf', 'plate.svg'." in text


def test_a_scene_that_is_no_file_has_no_folder():
    with pytest.raises(SceneError, match="no folder to read a drawing from"):
        load_scene({"bodies": [{"name": "x", "motion": "fixed", "shapes": [
            {"type": "drawing", "file": "plate.svg"}]}]})


# --- what is wrong with them


@pytest.mark.parametrize(("name", "text", "words"), [
    ("a.svg", "<svg><path d='M 0", "cannot be read as SVG: "),
    ("a.txt", "hello", "neither an SVG nor a DXF file"),
    ("a.svg", f"{HEAD}</svg>", "holds no outline"),
    ("a.svg", f"{HEAD}<path d='M 0 0 H 10 V 10 L 3 4'/></svg>",
     "an outline is open, from [0, -0] to [0.003, -0.004] m"),
    ("a.svg", f"{HEAD}<path d='M 0 0 L 10 10 H 0 L 12 0 Z'/></svg>", "crosses or touches itself"),
    ("a.svg", f"{HEAD}<path d='M 0 0 H 10 Z'/></svg>", "has no area"),
    ("a.svg", PLATE, "holds 2 outlines that are not one in the other, one through [0.03"),
    ("a.svg", f"{HEAD}<use href='#a'/></svg>", "it holds 'use', which is not followed"),
    ("a.svg", f"<!DOCTYPE svg [<!ENTITY a 'b'>]>{HEAD}</svg>", "it holds 'ENTITY'"),
])
def test_a_drawing_that_gives_no_outline_is_told(folder, name, text, words):
    (folder / name).write_text(text)
    assert words in refused(folder, file=name)


def test_a_drawing_without_a_unit_asks_for_one(folder):
    drawing = ezdxf.new(units=0)
    drawing.modelspace().add_circle((0, 0), 1)
    drawing.saveas(folder / "bare.dxf")
    assert "it does not say its unit" in refused(folder, file="bare.dxf")
    assert shape(folder, file="bare.dxf", unit="1 cm")


@pytest.mark.parametrize("name", ["plate.svg", "plate.dxf"])
def test_a_tolerance_that_asks_for_too_much_is_told(folder, name):
    text = refused(folder, file=name, unit="1 m", tolerance=1e-9,
                   **({"layer": "plate"} if name == "plate.svg" else {}))
    assert "corners" in text
    assert "larger tolerance" in text


@pytest.mark.parametrize(("name", "library"), [("plate.svg", "svgelements"),
                                               ("plate.dxf", "ezdxf")])
def test_what_is_not_installed_is_told(folder, name, library, monkeypatch):
    found = builtins.__import__

    def without(wanted, *args, **keys):
        if wanted.split(".")[0] == library:
            raise ModuleNotFoundError(name=library)
        return found(wanted, *args, **keys)

    monkeypatch.setattr(builtins, "__import__", without)
    text = refused(folder, file=name)
    assert f"needs {library}, which is not installed" in text
    assert "sandbox-mechanics[outlines]" in text
