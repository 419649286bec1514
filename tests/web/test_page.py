"""The page as text: one script, allowed by its hash; data that cannot leave their place."""

import base64
import hashlib
import json
import re

import pytest

from sandbox.errors import OutputError
from sandbox.picture.subject import INKS
from sandbox.recording.recording import Recording
from sandbox.web.page import HASHES, MOST_RUNS, UPLOT, report, safe_json, styles, text_of
from tests.draw.conftest import hand, zoo

EVIL = '</script><script>window.pwned=1</script><img src=x onerror="pwned=2">\u2028"\'&{}'


def test_equal_runs_give_equal_pages():
    assert report([zoo()]) == report([zoo()])


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


def test_safe_json_is_the_same_data_and_holds_no_tag():
    data = {"a": EVIL, "é": [1.5, None, True]}
    text = safe_json(data)
    assert json.loads(text) == data
    assert text.isascii()
    assert not set("<>&") & set(text)


def test_a_page_needs_a_run_and_shows_up_to_four():
    with pytest.raises(OutputError, match="no run to show"):
        report([])
    run = zoo()
    with pytest.raises(OutputError, match=f"up to {MOST_RUNS} runs, 5 were given"):
        report([run] * 5)
    assert report([run] * 2).count("data-run>") == 2


def test_a_run_that_is_not_complete_says_so_and_is_shown():
    from dataclasses import replace

    from sandbox.samples.outcome import Status

    run = hand()
    info = replace(run.info, status=Status.INTERRUPTED, reason="interrupted")
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
    tokens = dict(re.findall(r"--([a-z]+): (#[0-9a-f]{6})",
                             re.findall(r":root \{(.*?)\}", styles(), re.DOTALL)[night]))
    assert {"edge", "accent", "ink", "faint", "bad", "good", "warn"} <= set(tokens)
    for ground in ("back", "page"):
        for name in ("edge", "accent"):
            assert contrast(tokens[name], tokens[ground]) >= 3, (name, ground)
        for name in ("ink", "faint", "bad", "good", "warn"):
            assert contrast(tokens[name], tokens[ground]) >= 4.5, (name, ground)
    for token in ("ink", "faint_ink", "force", "drive", "spring", "pin_ring", "stop"):
        assert contrast(*(INKS[name][night] for name in (token, "paper"))) >= 3, token
