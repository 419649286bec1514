"""A real browser, where playwright and a Chromium are there; else these tests are left out."""

import os
import shutil

import pytest

BROWSERS = ("chromium", "chromium-browser", "google-chrome", "chrome")


@pytest.fixture(scope="module")
def browser():
    """One for a file of tests: while its driver lives, an event loop runs in this thread, and tests
    elsewhere that begin one of their own could not."""
    sync = pytest.importorskip(
        "playwright.sync_api", reason="no playwright: pip install 'sandbox-mechanics[dev]'")
    found = next((path for name in BROWSERS if (path := shutil.which(name))), None)
    if found is None:
        pytest.skip("no browser: install chromium from the system's packages")
    root = hasattr(os, "geteuid") and os.geteuid() == 0
    with sync.sync_playwright() as driver:
        running = driver.chromium.launch(
            executable_path=found, args=["--no-sandbox"] if root else [])
        yield running
        running.close()


@pytest.fixture
def opened(browser, tmp_path):
    """Opens a page's text; the tab keeps what went wrong in ``faults``.

    Errors and warnings of the console, exceptions, and requests to anywhere but the file itself.
    """
    contexts = []

    def open_page(text, *, at="", clock=False, **options):
        context = browser.new_context(**{"viewport": {"width": 1280, "height": 900}, **options})
        contexts.append(context)
        tab = context.new_page()
        tab.faults = []
        tab.on("console", lambda said: tab.faults.append(said.text)
               if said.type in ("error", "warning") else None)
        tab.on("pageerror", lambda error: tab.faults.append(str(error)))
        tab.on("request", lambda asked: tab.faults.append(asked.url)
               if not asked.url.startswith(("file:", "data:", "blob:")) else None)
        if clock:
            tab.clock.install(time=0)
        path = tmp_path / "page.html"
        path.write_text(text, encoding="utf-8")
        tab.goto(path.as_uri() + at)
        tab.wait_for_selector("html[data-ready]", state="attached")
        if clock:  # from here on it moves by run_for alone
            tab.clock.pause_at(3600)
        return tab

    yield open_page
    for context in contexts:
        context.close()
