"""``sandbox render`` and ``sandbox report``: pictures and pages of saved runs."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from PIL import Image

from tests.samples.controlled import recording


@pytest.fixture
def saved(sandbox, scene):
    assert sandbox("run", scene(view={"size": [200, 150]}), "--no-render", "--quiet",
                   "--out", "saved").code == 0
    return "saved"


def test_films_and_frames(sandbox, saved):
    output = sandbox("render", saved, "--out", "x.gif", "--out", "frames", "--size", "320x200",
                   "--fps", 50, "--speed", 0.5, "--fit", "ball")
    assert (output.code, output.out.split()) == (0, ["x.gif", "frames"]), output.err
    with Image.open("x.gif") as image:
        assert image.size == (320, 200)
    assert Path("frames/frame_00000.png").is_file()
    assert "--limit frames=N" in sandbox("render", saved, "--limit", "frames=1").err
    assert sandbox("render", saved).out.split() == ["saved/animation.gif"]


def test_stills_and_strips(sandbox, saved):
    output = sandbox("render", saved, "--at", "0.02s", "--at", "end")
    assert output.code == 0
    assert output.out.split() == ["saved/still_0.02s.png", "saved/still_end.png"]
    output = sandbox("render", saved, "--at", "10 ms", "--format", "svg", "--labels", "scales")
    assert output.out.split() == ["saved/still_10ms.svg"]
    assert sandbox("render", saved, "--format", "pdf").out.split() == ["saved/still_end.pdf"]
    assert sandbox("render", saved, "--at", "start", "--out", "x.png", "--size", "2x").code == 0
    with Image.open("x.png") as picture:
        assert picture.size == (400, 300)
    for name, begin in (("still_end.png", b"\x89PNG"), ("still_10ms.svg", b"<?xml"),
                        ("still_end.pdf", b"%PDF")):
        assert Path(saved, name).read_bytes().startswith(begin)
    for words in (["--strip"], ["--strip", "3"], ["--strip", "--at", "start", "--at", "end"]):
        output = sandbox("render", saved, *words, "--transparent", "--labels", "none")
        assert (output.code, output.out.split()) == (0, ["saved/strip.png"])
    with Image.open(Path(saved, "strip.png")) as picture:
        assert picture.mode == "RGBA"


@pytest.mark.parametrize(("words", "message"), [
    (["--out", "a.gif", "--out", "b.mpg", "--out", "c.jpg"], "c.jpg: no picture can have"),
    (["--out", "a.png", "--out", "a.gif", "--size", "85mm"], "asks for paper: a film has pixels"),
    (["--at", "1 s", "--at", "soon"], "\nerror: at='soon'"),
    (["--at", "end", "--out", "a.gif"], "at asks for single moments"),
    (["--transparent", "--format", "mp4"], "transparent asks for a see-through ground"),
    (["--format", "svg", "--out", "a.svg"], "give --format or --out FILE, not both"),
    (["--size", "2y"], "as in 2x"),
    (["--show", "velocty"], "did you mean 'velocity'"),
])
def test_wrong_pictures(sandbox, saved, words, message):
    output = sandbox("render", saved, *words)
    assert output.code == 2
    assert message in output.err
    assert not Path("a.gif").exists()
    assert not Path("a.png").exists()


def test_a_page_lies_beside_its_run_or_shows_several(sandbox, runs):
    output = sandbox("report", "controlled", "--plot", "finger.*.angle")
    assert output.code == 0
    assert output.out.startswith("renders/controlled/report.html  (")
    page = Path("renders/controlled/report.html").read_text()
    assert page.count("data-run>") == 1
    plots = json.loads(re.search(r'"plots":(\[.*?\])', page)[1])
    assert {"finger.mcp.angle", "finger.pip.angle", "finger.dip.angle"} <= set(plots)
    recording().save("renders/controlled")  # a new run removes the page of the old one
    assert not Path("renders/controlled/report.html").exists()
    output = sandbox("report", "controlled", "renders/other", "--out", "both.html", "--json")
    message = json.loads(output.out)
    assert message["runs"] == ["renders/controlled", "renders/other"]
    assert message["bytes"] == Path(message["file"]).stat().st_size
    assert Path("both.html").read_text().count("data-run>") == 2
    for words, message in (
            (["controlled", "--plot", "finger.mcp.angel"], "Did you mean 'finger.mcp.angle'?"),
            (["controled"], "did you mean 'controlled'"),
            (["controlled", "--out", "page.txt"], "does not end in .html")):
        output = sandbox("report", *words)
        assert output.code == 2
        assert message in output.err
