"""The page as text: one script, allowed by its hash; data that cannot leave their place."""

from __future__ import annotations

import base64
import hashlib
import html
import math
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from sandbox.errors import OutputError
from sandbox.model.catalogue import UnknownQuantityError
from sandbox.picture.subject import INKS
from sandbox.recording.recording import Recording
from sandbox.samples.expectations import verdicts
from sandbox.web.page import MAX_RUNS, FoundOut, report, styles, text_of, words
from tests.draw.conftest import hand, zoo

UPLOT = "1.6.32"
"""The version of uPlot (https://github.com/leeoniya/uPlot, MIT) in ``script/uplot/``."""
HASHES = {
    "uPlot.iife.min.js":
        "19c8d4c6ad88929a79f4ae49d6f7161566dfd0ba3d15cc495e974f787eb78f1f",
    "uPlot.min.css":
        "df630c6a8d6f8eeaff264b50f73ce5b114f646ffd9a0bb74f049b0a00135fa04",
    "uPlot.LICENSE":
        "8f989229699b4fe2f1a0432d0e9edc338a8a911e250e2d1b01ecd770a5f5b1bd",
}
"""SHA-256 of its files, as registry.npmjs.org has them in uplot-1.6.32.tgz."""
EVIL = '</script><script>window.pwned=1</script><img src=x onerror="pwned=2">\u2028"\'&{}'


def test_the_one_script_and_the_styles_are_those_that_the_policy_allows():
    page = report([zoo()])
    policy = re.search(r'Content-Security-Policy" content="([^"]*)"', page)[1]
    assert policy.startswith("default-src 'none'; ")
    assert "unsafe" not in policy
    for tag in ("script", "style"):
        start = page.index(f"<{tag} type=\"module\">" if tag == "script" else f"<{tag}>")
        body = page[page.index(">", start) + 1:page.index(f"</{tag}>", start)]
        digest = base64.b64encode(hashlib.sha256(body.encode()).digest()).decode()
        assert f"{tag}-src 'sha256-{digest}'" in policy


def test_names_and_titles_are_data():
    run = zoo()
    mechanism = run.mechanism.model_copy(update={"title": EVIL, "about": EVIL})
    page = report([Recording(mechanism, run.arrays, run.info)])
    assert page.count("<script") == page.count("</script") == 3
    assert "<img" not in page.replace("&lt;img", "")
    assert "pwned=1</script>" not in page


def test_a_page_needs_a_run_and_shows_up_to_four():
    with pytest.raises(OutputError, match="no run to show"):
        report([])
    run = zoo()
    with pytest.raises(OutputError, match=f"up to {MAX_RUNS} runs, 5 were given"):
        report([run] * 5)
    page = report([run] * 2, [FoundOut(source="x"), FoundOut(source="y")])
    assert re.findall(r'"apart":"(\w+)"', page) == ["x", "y"]


def test_a_run_that_is_not_complete_says_so_and_is_shown():
    run = hand()
    info = replace(run.info, complete=False, reason="interrupted")
    page = report([Recording(run.mechanism, run.arrays, info)])
    assert '"complete":false' in page
    assert '"status":"was interrupted"' in page


def test_uplot_is_the_version_that_is_said():
    for name, digest in HASHES.items():
        assert hashlib.sha256(text_of(f"uplot/{name}").encode()).hexdigest() == digest
    assert f"(v{UPLOT})" in text_of("uplot/uPlot.iife.min.js")
    assert "MIT License" in text_of("uplot/uPlot.LICENSE")


def contrast(one, other):
    """The ratio of two colours ``#rrggbb`` by WCAG 2: relative luminances in linear light."""
    def light(colour):
        parts = [int(colour[k:k + 2], 16) / 255 for k in (1, 3, 5)]
        red, green, blue = (v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4
                            for v in parts)
        return 0.2126 * red + 0.7152 * green + 0.0722 * blue + 0.05

    low, high = sorted((light(one), light(other)))
    return high / low


@pytest.mark.parametrize("night", [0, 1])
def test_controls_and_texts_have_contrast_by_day_and_by_night(night):
    """Edges of controls and marks 3 : 1, as WCAG 2.2 asks (1.4.11); texts 4.5 : 1 (1.4.3)."""
    tokens = {name: pair[night] for name, *pair in re.findall(
        r"--([a-z]+): light-dark\((#[0-9a-f]{6}), (#[0-9a-f]{6})\)", styles())}
    assert {"edge", "accent", "ink", "faint", "bad", "good", "warn"} <= set(tokens)
    for ground in ("back", "page"):
        for name in ("edge", "accent"):
            assert contrast(tokens[name], tokens[ground]) >= 3, (name, ground)
        for name in ("ink", "faint", "bad", "good", "warn"):
            assert contrast(tokens[name], tokens[ground]) >= 4.5, (name, ground)
    for token in ("ink", "faint_ink", "force", "drive", "spring", "pin_ring", "stop"):
        assert contrast(*(INKS[name][night] for name in (token, "paper"))) >= 3, token


def test_it_is_the_page_in_a_frame_that_reaches_nothing(tmp_path: Path) -> None:
    run = hand()
    made = run.page("finger1.*.angle", height=500)
    text = made.data.decode()
    assert text == report([run], [FoundOut(verdicts=run.verdicts, figures=run.audit)],
                          run.names("finger1.*.angle"))
    shown = made._repr_html_()
    assert re.findall(r'sandbox="([^"]*)"', shown) == ["allow-scripts allow-downloads"]
    assert "height:500px" in shown
    assert html.unescape(re.findall(r'srcdoc="([^"]*)"', shown)[0]) == text
    assert repr(made).startswith(f"<HTML of {run.mechanism.name} in motion, ")
    made.save(tmp_path / "run.html")
    assert (tmp_path / "run.html").read_text(encoding="utf-8") == text


def test_what_is_wrong_is_said(tmp_path: Path) -> None:
    run = hand()
    with pytest.raises(UnknownQuantityError, match="finger1"):
        run.page("finger1.mcp.angel")
    wrong: Any
    for wrong in (0, math.nan, "tall", True):
        with pytest.raises(OutputError, match=r"pass 200 to 4000 pixels"):
            run.page(height=wrong)
    with pytest.raises(OutputError, match=r"\.html"):
        run.page().save(tmp_path / "run.pdf")


def test_every_verdict_has_the_window_of_its_own_expectation():
    run = hand()
    data = run.mechanism.model_dump(mode="json", by_alias=True)
    data["expect"] = [
        {"mean": "tree.tendon.tension", "over": [0.2, 0.4], "above": -1},
        {"max": "no.such.quantity", "above": -1},
        {"final": "finger?.tendon.tension", "above": -1},
        {"mean": "tree.tendon.tension", "over": [1.0, 1.5], "above": -1}]
    mechanism = type(run.mechanism).model_validate(data)
    run = type(run)(mechanism, run.arrays, run.info)
    told = words(run, FoundOut(verdicts(run)))["expect"]
    assert [one["quantity"] for one in told] == [
        "tree.tendon.tension", "no.such.quantity", *(f"finger{k}.tendon.tension" for k in
                                                       (1, 2, 3, 4)), "tree.tendon.tension"]
    step = float(run.time[1] - run.time[0])
    for one, (start, end) in ((told[0], (0.2, 0.4)), (told[-1], (1.0, 1.5))):
        assert 0 <= one["over"][0] - start <= step
        assert 0 <= end - one["over"][1] <= step
    for one in told[2:6]:  # a last value is taken at the end
        assert one["over"] == [float(run.time[-1])] * 2
