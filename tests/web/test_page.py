"""The page as text: one script, allowed by its hash; data that cannot leave their place."""

import base64
import hashlib
import json
import re

import pytest

from sandbox.errors import OutputError
from sandbox.recording.recording import Recording
from sandbox.web.page import HASHES, MOST_RUNS, UPLOT, report, safe_json, text_of
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
