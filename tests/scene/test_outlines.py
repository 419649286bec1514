"""Outlines: pieces, drawings, cams, and what is wrong with them."""

from __future__ import annotations

import json
import math
import re

import ezdxf
import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from sandbox.engine.inspect import inspect
from sandbox.errors import SceneError
from sandbox.scene.bodies import Polygon
from sandbox.scene.expand import expand
from sandbox.scene.geometry import area_properties, solids
from sandbox.scene.outlines.rings import PIECE_CORNERS, inside, is_convex, pieces_of, signed_area
from sandbox.scene.read.load import load_scene

ELL = ((0.0, 0.0), (3.0, 0.0), (3.0, 1.0), (1.0, 1.0), (1.0, 4.0), (0.0, 4.0))
STAR = tuple((r * math.cos(k * math.pi / 7), r * math.sin(k * math.pi / 7))
             for k, r in enumerate([2.0, 0.7] * 7))
SQUARE = ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0))


def circle(n: int, radius: float, at: tuple[float, float] = (0.0, 0.0)):
    return tuple((at[0] + radius * math.cos(math.tau * k / n),
                  at[1] + radius * math.sin(math.tau * k / n)) for k in range(n))


def moved(ring, x: float, y: float):
    return tuple((p + x, q + y) for p, q in ring)


RINGS = {
    "ell": (ELL, ()), "star": (STAR, ()), "clockwise": (STAR[::-1], ()),
    "ring": (circle(90, 2.0), (circle(40, 1.0),)),
    "fine circle": (circle(500, 1.0), ()),
    "tiny": (tuple((1e-6 * x, 1e-6 * y) for x, y in ELL), ()),
    "far": (moved(ELL, 1e3, -1e3), ()),
    "corners in line": ((*ELL[:1], (1.0, 0.0), (2.0, 0.0), *ELL[1:]), ()),
}

RINGS["sieve"] = (circle(200, 3.0), (circle(12, 0.3, (-1.2, 0)), circle(9, 0.4, (1.5, 0)),
                                     moved(SQUARE, -0.4, 0.9)))


@pytest.mark.parametrize("name", RINGS)
def test_the_pieces_are_convex_and_cover_the_outline_and_no_more(name):
    outer, holes = RINGS[name]
    pieces = pieces_of(outer, holes)
    area = abs(signed_area(outer)) - sum(abs(signed_area(hole)) for hole in holes)
    assert sum(signed_area(piece.ring) for piece in pieces) == pytest.approx(area, rel=1e-9)
    assert all(is_convex(piece.ring) and len(piece.ring) <= PIECE_CORNERS for piece in pieces)
    corners = {corner for ring in (outer, *holes) for corner in ring}
    assert {corner for piece in pieces for corner in piece.ring} <= corners


# --- what is wrong


def problems(**shape) -> str:
    with pytest.raises(SceneError) as raised:
        load_scene({"bodies": [{"name": "x", "motion": "fixed", "shapes": [shape]}]})
    return str(raised.value)


@pytest.mark.parametrize("seed", range(4))
def test_self_intersections_are_found(seed):
    """Against every pair of sides, one by one; what is sound is cut into pieces."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(4, 9))
    points = [tuple(p) for p in rng.uniform(-1, 1, (n, 2)).tolist()]

    def beside(a, b, c):
        return np.sign((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))

    crossed = False
    for i in range(n):
        for j in range(i + 2, n - (i == 0)):
            p, q, r, s = points[i], points[(i + 1) % n], points[j], points[(j + 1) % n]
            crossed |= (beside(p, q, r) != beside(p, q, s)) and (beside(r, s, p) != beside(r, s, q))
    if crossed:
        assert "crosses or touches itself" in problems(type="polygon", points=points)
    else:
        shape = Polygon(type="polygon", points=points)
        middle = rng.uniform(-1, 1, (200, 2)).tolist()
        parts = [solid.points for solid, _ in solids(shape)]
        assert all(inside(tuple(p), tuple(points)) == any(inside(tuple(p), ring) for ring in parts)
                   for p in middle)


# --- drawings


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


def drawn(folder, **keys):
    scene = {"bodies": [{"name": "x", "motion": "fixed", "shapes": [{"type": "drawing", **keys}]}]}
    path = folder / "scene.json"
    path.write_text(json.dumps(scene))
    return load_scene(path).bodies[0].shapes[0]


def drawing_refused(folder, **keys) -> str:
    with pytest.raises(SceneError) as raised:
        drawn(folder, **keys)
    assert "$.bodies[0].shapes[0]" in str(raised.value)
    return str(raised.value)


AREA = (200 + math.pi * 25 / 2 - math.pi * 4) * 1e-6
CENTRE = (200 * 10 + math.pi * 25 / 2 * (20 + 20 / (3 * math.pi)) - math.pi * 4 * 5) / (
    AREA * 1e6) * 1e-3


@pytest.mark.parametrize(("keys", "up"), [
    ({"file": "plate.svg", "layer": "plate"}, -1), ({"file": "plate.dxf"}, 1)])
def test_a_plate_is_as_large_as_drawn(folder, keys, up):
    """In the units that the file says; its y is up, so what an SVG draws downwards is below."""
    found = drawn(folder, tolerance="1 um", **keys)
    area, centre, _ = area_properties(found)
    assert len(found.holes) == 1
    assert area == pytest.approx(AREA, rel=1e-4)
    assert centre == pytest.approx((CENTRE, up * 0.005), abs=1e-6)


def test_the_unit_of_a_drawing_can_be_given(folder):
    small = drawn(folder, file="plate.dxf", tolerance="1 um")
    for unit, factor in (("2 mm", 2), (1e-3, 1)):
        found = drawn(folder, file="plate.dxf", unit=unit, tolerance=f"{factor} um")
        assert area_properties(found)[0] == pytest.approx(factor**2 * area_properties(small)[0])
    doubled = drawn(folder, file="plate.svg", layer="plate", unit="2 mm", tolerance="1 um")
    assert area_properties(doubled)[0] == pytest.approx(4 * AREA, rel=1e-4)


# --- where files may lie


@pytest.mark.parametrize("name", [
    "../plate.svg", "/etc/plate.svg", "a/../../plate.svg", "C:plate.svg", "a\\plate.svg",
    "\x00.svg"])
def test_a_file_of_another_place_is_not_read(folder, name):
    assert re.search("there is no file|leads out of", drawing_refused(folder, file=name))


def test_a_link_out_of_the_folder_is_not_followed(folder, tmp_path_factory):
    outside = tmp_path_factory.mktemp("outside")
    (outside / "plate.svg").write_text(PLATE)
    (folder / "link.svg").symlink_to(outside / "plate.svg")
    (folder / "under").symlink_to(outside)
    (folder / "own.svg").symlink_to(folder / "plate.svg")
    for name in ("link.svg", "under/plate.svg"):
        assert "leads out" in drawing_refused(folder, file=name)
    assert drawn(folder, file="own.svg", layer="plate").holes


def test_a_missing_drawing_is_refused_with_a_near_miss(folder):
    text = drawing_refused(folder, file="plat.svg")
    assert "there is no file 'plat.svg'" in text
    assert "Did you mean 'plate.svg'? Allowed: 'plate.dxf', 'plate.svg'." in text


# --- what is wrong with them


@pytest.mark.parametrize(("name", "text", "words"), [
    ("a.svg", "<svg><path d='M 0", "cannot be read as SVG: "),
    ("a.txt", "hello", "neither an SVG nor a DXF file"),
    ("a.svg", f"{HEAD}</svg>", "has no outline"),
    ("a.svg", f"{HEAD}<path d='M 0 0 H 10 V 10 L 3 4'/></svg>",
     "an outline is open, from [0, 0] to [0.003, -0.004] m"),
    ("a.svg", f"{HEAD}<path d='M 0 0 L 10 10 H 0 L 12 0 Z'/></svg>", "crosses or touches itself"),
    ("a.svg", f"{HEAD}<path d='M 0 0 H 10 Z'/></svg>", "has no area"),
    ("a.svg", PLATE, "holds 2 outlines that are not one in the other, one through [0.03"),
    ("a.svg", f"{HEAD}<use href='#a'/></svg>", "it holds 'use', which is not followed"),
    ("a.svg", f"<!DOCTYPE svg [<!ENTITY a 'b'>]>{HEAD}</svg>", "it holds 'ENTITY'"),
])
def test_drawings_without_an_outline_are_refused(folder, name, text, words):
    (folder / name).write_text(text)
    assert words in drawing_refused(folder, file=name)


def test_a_drawing_without_a_unit_asks_for_one(folder):
    drawing = ezdxf.new(units=0)
    drawing.modelspace().add_circle((0, 0), 1)
    drawing.saveas(folder / "bare.dxf")
    assert "it has no unit" in drawing_refused(folder, file="bare.dxf")
    assert drawn(folder, file="bare.dxf", unit="1 cm")


def test_blocks_are_not_followed(folder):
    drawing = ezdxf.new(units=4)
    drawing.blocks.new("bolt").add_circle((0, 0), 1)
    drawing.modelspace().add_blockref("bolt", (0, 0))
    drawing.saveas(folder / "block.dxf")
    assert "it holds the block 'bolt'" in drawing_refused(folder, file="block.dxf")


TURNS = np.arange(0.0, math.tau, math.pi / 12)


def cam(lift, **keys):
    table = [[float(a), float(s)] for a, s in zip(TURNS, lift, strict=True)]
    shape = {"type": "cam", "base": 0.03, "lift": table, **keys}
    scene = load_scene({"bodies": [{"name": "cam", "motion": "fixed", "shapes": [shape]}]})
    return np.array(scene.bodies[0].shapes[0].points)


def cam_refused(lift, **keys) -> str:
    with pytest.raises(SceneError) as raised:
        cam(lift, **keys)
    return str(raised.value)


def test_a_flat_follower_needs_a_base_above_what_bends_the_lift_most():
    """b > -min(s + s''): for s = e (1 - cos 2a), s + s'' = e (1 + 3 cos 2a) is at least -2 e.

    A spline's second derivative misses by h^2 / 12 max |s''''|, 16 e h^2 / 12 = 0.09 e.
    """
    lift = 0.005 * (1 - np.cos(2 * TURNS))
    text = cam_refused(lift, follower="flat", base=0.009)
    assert "undercut at a turn of" in text
    wanted = float(re.search(r"base radius of at least ([\d.]+) m", text)[1])
    assert 0.01 < wanted <= 0.0105  # rounded up to three digits
    assert len(cam(lift, follower="flat", base=wanted)) > 24


@pytest.mark.parametrize(("lift", "keys", "words"), [
    (0 * TURNS, {}, "'roller' is missing"),
    (0 * TURNS, {"follower": "flat", "roller": 0.01}, "a flat follower has no 'roller'"),
    (0 * TURNS - 0.04, {"roller": 0.01}, "Allowed: a base radius above 0.04 m"),
    (0.01 * np.sin(TURNS), {"roller": 0.01, "tolerance": 1e-9}, "Allowed: a tolerance of"),
])
def test_wrong_cams_are_refused(lift, keys, words):
    text = cam_refused(lift, **keys)
    assert "$.bodies[0].shapes[0]" in text
    assert words in text


@pytest.mark.parametrize(("dwell", "warned"), [([210, 330], True), (range(180, 360, 15), False)])
def test_a_lift_that_swings_beyond_its_entries_is_warned_of(dwell, warned):
    """A rise and return of 10 mm with a dwell of two entries, and of twelve."""
    turns = np.radians([*range(0, 180, 15), *dwell])
    lift = np.where(turns < 3.0, 0.005 * (1 - np.cos(2 * turns)), 0.0)
    scene = load_scene({"bodies": [{"name": "cam", "motion": "fixed", "shapes": [
        {"type": "cam", "base": 0.1, "follower": "flat", "lift": np.stack([turns, lift], 1)
         .tolist()}]}]})
    spline = CubicSpline([*turns, math.tau], [*lift, lift[0]], bc_type="periodic")
    lowest = 1e3 * spline(np.linspace(0, math.tau, 36_001)).min()
    text = "".join(str(problem) for problem in inspect(expand(scene)))
    found = re.findall(r"the lift of its cam swings to (\S+) mm", text)
    assert list(map(float, found)) == pytest.approx([lowest] * warned, rel=1e-3)
