"""What the browser tests of the page share."""

import contextlib
import pathlib
import time

from playwright.sync_api import expect

DESKTOP = {"width": 1280, "height": 900}
PHONE = {"width": 390, "height": 844}
expect.set_options(timeout=30000)  # ms; other tests may keep every core busy


class Complaints(list):
    """What a page must not do: errors, warnings on the console, requests to anywhere."""

    def watch(self, page):
        page.on("console", lambda message: self.append(f"console: {message.text}"))
        page.on("pageerror", lambda error: self.append(f"error: {error}"))
        page.on("request", lambda request: self.request(request.url))

    def request(self, url):
        if not url.startswith(("file:", "data:", "blob:")):
            self.append(f"request: {url}")


def chart(page, figure, index=0):
    """The drawn SVG of a figure's chart, scrolled to."""
    host = page.locator(f"#figure-{figure} .chart").nth(index)
    host.scroll_into_view_if_needed()
    drawing = host.locator(".plot svg")
    expect(drawing).to_have_count(1, timeout=30000)
    return drawing


def downloaded(page, figure, button):
    with page.expect_download(timeout=60000) as event:
        page.locator(f"#figure-{figure} .tools").get_by_role("button", name=button, exact=True).click()
    return event.value.suggested_filename, pathlib.Path(event.value.path()).read_bytes()


def seconds(page):
    return float(page.locator("#figure-replay .readout dd").first.inner_text().split()[0])


@contextlib.contextmanager
def stays_small_and_opens_quickly(browser, path, seconds=3):
    """Opens a large page; in the end it must have complained of nothing, be smaller than 20 MB and have worked for less."""
    page = browser.new_page(viewport=DESKTOP)
    complaints = Complaints()
    complaints.watch(page)
    watch = page.context.new_cdp_session(page)
    watch.send("Performance.enable", {"timeDomain": "threadTicks"})
    started = time.monotonic()
    page.goto(path.as_uri(), wait_until="commit")
    page.wait_for_selector("html[data-ready]", state="attached", timeout=60000)
    waited = time.monotonic() - started
    metrics = {one["name"]: one["value"] for one in watch.send("Performance.getMetrics")["metrics"]}

    yield page

    page.close()
    size = path.stat().st_size / 1e6
    worked = metrics["TaskDuration"]  # of the page's thread: other programs beside this test do not count
    print(f"{path.name}: {size:.1f} MB, opens after {waited:.2f} s, {worked:.2f} s of them work")
    assert size < 20
    assert 0 < worked < seconds
    assert complaints == []
