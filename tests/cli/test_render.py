"""``sandbox render``: stills, strips, vectors and meters of a saved run."""

from __future__ import annotations

import re

import pytest
from PIL import Image

PNG = b"\x89PNG"


@pytest.fixture
def saved(sandbox, scene):
    assert sandbox("run", scene(view={"size": [200, 150]}), "--no-render", "--quiet",
                   "--out", "saved").code == 0
    return "saved"


def test_stills_have_the_names_of_their_times(sandbox, saved, tmp_path):
    said = sandbox("render", saved, "--at", "0.02s", "--at", "end")
    assert (said.code, said.out.split()) == (0, ["saved/still_0.02s.png", "saved/still_end.png"])
    said = sandbox("render", saved, "--at", "10 ms", "--format", "svg")
    assert said.out.split() == ["saved/still_10ms.svg"]
    assert sandbox("render", saved, "--format", "pdf").out.split() == ["saved/still_end.pdf"]
    assert sandbox("render", saved, "--at", "start", "--out", "x.png", "--size", "2x").code == 0
    with Image.open(tmp_path / "x.png") as picture:
        assert picture.size == (400, 300)
    for name, begin in (("still_end.png", PNG), ("still_10ms.svg", b"<?xml"),
                        ("still_end.pdf", b"%PDF")):
        assert (tmp_path / saved / name).read_bytes().startswith(begin)


def test_a_strip_may_have_no_number(sandbox, saved, tmp_path):
    for words in (["--strip"], ["--strip", "3"], ["--strip", "--at", "start", "--at", "end"]):
        said = sandbox("render", saved, *words, "--transparent", "--bare")
        assert (said.code, said.out.split()) == (0, ["saved/strip.png"])
    with Image.open(tmp_path / saved / "strip.png") as picture:
        assert picture.mode == "RGBA"


def test_wrong_endings_are_told_before_the_first_is_drawn(sandbox, saved, tmp_path):
    said = sandbox("render", saved, "--out", "a.gif", "--out", "b.mpg", "--out", "c.jpg")
    assert said.code == 2
    assert said.err.count("error: ") == 2
    assert "b.mpg: no picture can have" in said.err
    assert "c.jpg: no picture can have" in said.err
    assert not (tmp_path / "a.gif").exists()
    said = sandbox("render", saved, "--out", "a.png", "--out", "b.gif", "--size", "85mm")
    assert said.code == 2
    assert "b.gif: size='85mm' asks for paper: a film has pixels" in said.err
    assert not (tmp_path / "a.png").exists()


@pytest.mark.parametrize(("words", "told"), [
    (["--at", "1 s"], "error: at='1 s': the run lasts from 0 s to 0.05 s"),
    (["--at", "1 s", "--at", "soon"], "\nerror: at='soon'"),
    (["--strip", "99"], "2 to 24 pictures"),
    (["--strip", "0"], "error: strip=0: a strip has 2 to 24 pictures"),
    (["--strip", "two"], "'two' is not a valid integer"),
    (["--at", "end", "--out", "a.gif"], "at asks for single moments"),
    (["--transparent", "--format", "mp4"], "transparent asks for a see-through ground"),
    (["--format", "svg", "--out", "a.svg"], "give one of the two"),
    (["--meter", "ball.xx", "--at", "end"], "meters[0].of[0]: unknown quantity 'ball.xx'"),
    (["--size", "2y"], "as in 2x"),
])
def test_what_cannot_be_drawn_is_told(sandbox, saved, words, told):
    said = sandbox("render", saved, *words)
    assert said.code == 2
    assert told in said.err


def test_an_unknown_meter_is_refused_before_anything_is_simulated(sandbox, scene, tmp_path):
    said = sandbox("run", scene(), "--meter", "ball.hight", "--meter", "=ball.y *", "--out", "new")
    assert said.code == 2
    assert "--meter" in said.err
    assert not (tmp_path / "new").exists()
    said = sandbox("run", scene(), "--meter", "ball.contact.fyy", "--out", "new")
    assert re.search(r"Did you mean 'ball\.contact\.fy'", said.err)
    assert not (tmp_path / "new").exists()
