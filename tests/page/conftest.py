"""The pages that the tests open in a browser: the invented ones of fixture.h, and any file."""

import os
import pathlib
import subprocess

import pytest
from browsing import DESKTOP, Complaints
from playwright.sync_api import sync_playwright

CHROMIUM = os.environ.get("CHROMIUM", "/usr/bin/chromium")


@pytest.fixture(scope="session")
def browser():
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox", "--disable-gpu"])
        yield browser
        browser.close()


@pytest.fixture(scope="session")
def fixture_file(build, tmp_path_factory):
    """fixture_file("demo"): the invented page of that kind, written once."""
    folder = tmp_path_factory.mktemp("pages")

    def make(kind):
        path = folder / f"{kind}.html"
        if not path.exists():
            path.write_bytes(subprocess.run([build / "page_fixture", kind], check=True, capture_output=True).stdout)
        return path

    return make


@pytest.fixture
def opened(browser, fixture_file):
    """opened("demo", viewport=PHONE, ...): an invented page or a file, ready; in the end it must not have complained."""
    contexts = []
    complaints = Complaints()

    def open_page(kind, viewport=DESKTOP, **options):
        context = browser.new_context(viewport=viewport, accept_downloads=True, **options)
        contexts.append(context)
        page = context.new_page()
        complaints.watch(page)
        path = kind if isinstance(kind, pathlib.Path) else fixture_file(kind)
        page.goto(path.as_uri(), wait_until="commit")
        page.wait_for_selector("html[data-ready]", state="attached", timeout=60000)
        return page

    yield open_page
    for context in contexts:
        context.close()
    assert complaints == []
