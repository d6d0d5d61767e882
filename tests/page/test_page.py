"""The page in a real browser: it draws, answers to the reader, asks nothing of the network and runs no foreign text."""

import json
import re

import pytest
from browsing import PHONE, chart, downloaded, stays_small_and_opens_quickly
from playwright.sync_api import expect


@pytest.mark.parametrize(
    "figure, lines", [("curves", 8), ("survival", 4), ("learning", 5), ("parameters", 8), ("grids", 144), ("replay", 5)]
)
def test_every_figure_draws_its_marks(opened, figure, lines):
    drawing = chart(opened("demo"), figure)

    marks = drawing.locator(".mark-line path, .mark-rect path")
    assert marks.count() >= lines
    assert all(marks.nth(i).get_attribute("d") for i in range(lines))


def test_every_panel_is_drawn_in_the_end(opened):
    page = opened("demo")

    page.wait_for_function(
        "[...document.querySelectorAll('.chart')].every((host) => host.querySelector('.plot svg'))", timeout=120000
    )
    assert page.locator(".chart").count() == 15 + 15 + 2 + 2 + 3 + 1


def test_the_metric_selector_redraws_the_curves(opened):
    page = opened("demo")
    line = chart(page, "curves").locator(".mark-line path").first
    before = line.get_attribute("d")

    page.locator("#figure-curves").get_by_label("Metric").select_option("2")

    expect(line).not_to_have_attribute("d", before)
    expect(page.locator("#figure-curves .chart").first).to_have_attribute("aria-label", re.compile("^RMSE, observation"))
    expect(page.locator("#figure-parameters").get_by_label("Metric")).to_have_value("2")


def test_the_start_protocol_changes_curves_and_margins(opened):
    page = opened("demo")
    line = chart(page, "curves").locator(".mark-line path").first
    before = line.get_attribute("d")
    page.locator("#margin-choices").scroll_into_view_if_needed()

    page.locator("#margin-choices").get_by_role("button", name="random").click()

    expect(page.locator(".margins[data-start='1']")).to_be_visible()
    expect(page.locator(".margins[data-start='0']")).to_be_hidden()
    for part in (".from", ".smallest"):  # the answer and the smallest margins follow
        expect(page.locator(f".by-start[data-start='1'] {part}")).to_be_visible()
        expect(page.locator(f".by-start[data-start='0'] {part}")).to_be_hidden()
    expect(page.locator(".by-start[data-start='1'] .from")).to_have_text("From the random start: 25 seeded starts")
    expect(page.locator(".margins[data-start='1'] .beside").first).to_contain_text("nominal")
    chart(page, "curves")
    expect(line).not_to_have_attribute("d", before)


def test_learning_curves_are_drawn_of_the_score_that_is_chosen(opened):
    page = opened("demo")
    figure = page.locator("#figure-learning")
    line = chart(page, "learning").locator(".mark-line path").first
    before = line.get_attribute("d")
    assert downloaded(page, "learning", "CSV")[1].decode().splitlines()[1].startswith("ppo,return / horizon,mean,0,")

    figure.get_by_role("button", name="RMSE").click()

    expect(line).not_to_have_attribute("d", before)
    rows = downloaded(page, "learning", "CSV")[1].decode().splitlines()
    assert len(rows) == 1 + 2 * 51 and all(row.startswith("ppo,RMSE,") for row in rows[1:])
    expect(figure.locator(".chart").first).to_have_attribute("aria-label", re.compile("RMSE against training steps"))


def test_a_policy_can_be_hidden_and_shown(opened):
    page = opened("demo")
    lines = chart(page, "survival").locator(".mark-line path")
    assert lines.count() == 4
    key = page.locator("#figure-survival").get_by_role("button", name="ppo", exact=True)

    key.click()
    expect(lines).to_have_count(3)
    key.click()

    expect(lines).to_have_count(4)


def test_the_pointer_and_the_arrow_keys_read_a_curve(opened):
    page = opened("demo")
    chart(page, "curves")
    host = page.locator("#figure-curves .chart").first

    host.hover()
    expect(page.locator(".tooltip")).to_contain_text("observation white noise")
    expect(page.locator(".tooltip tr")).to_have_count(4)
    page.mouse.move(2, 2)
    expect(page.locator(".tooltip")).to_be_hidden()
    host.focus()
    page.keyboard.press("ArrowRight")

    expect(page.locator(".tooltip strong")).to_contain_text(", 0")


@pytest.mark.parametrize("figure", ["curves", "survival", "learning", "parameters", "grids", "replay"])
def test_every_figure_gives_its_data_specification_and_command(opened, figure):
    page = opened("demo")
    chart(page, figure)

    name, csv = downloaded(page, figure, "CSV")
    assert name == f"cartpole-first-look-{figure}.csv"
    lines = csv.decode().splitlines()
    assert len(lines) > 40
    assert len({line.count(",") for line in lines}) == 1
    spec = json.loads(downloaded(page, figure, "Vega-Lite")[1])
    assert spec["$schema"].endswith("vega-lite/v6.json")
    assert "var(--" not in json.dumps(spec)
    svg = downloaded(page, figure, "SVG")[1].decode()
    assert svg.startswith("<svg") and "mark-" in svg and "var(--" not in svg
    assert downloaded(page, figure, "PNG")[1].startswith(b"\x89PNG")
    page.locator(f"#figure-{figure} .tools").get_by_role("button", name="Command").click()
    expect(page.locator(f"#figure-{figure} .drawer code").first).to_contain_text("gust ")
    page.locator(f"#figure-{figure} .tools").get_by_role("button", name="Table").click()
    expect(page.locator(f"#figure-{figure} .drawer tbody tr").first).to_be_visible()


def test_the_csv_of_the_curves_holds_the_numbers_that_are_drawn(opened):
    page = opened("demo")

    rows = downloaded(page, "curves", "CSV")[1].decode().splitlines()

    assert rows[0] == "sweep,site,waveform,level,unit,policy,start,metric,value,low,high,saturated"
    assert len(rows) == 1 + 15 * 4 * 11
    first = rows[1].split(",")
    assert first[:8] == ["observation white noise", "observation", "white noise", "0", "", "lqr", "nominal", "anr"]


def test_hostile_names_are_inert(opened):
    page = opened("hostile")

    for figure in ("curves", "survival", "learning", "parameters", "grids", "replay"):
        chart(page, figure)
        page.locator(f"#figure-{figure} .tools").get_by_role("button", name="Table").click()
    page.locator("#figure-curves .chart").first.hover()
    expect(page.locator(".tooltip tr")).to_have_count(4)
    page.get_by_label("Episode", exact=True).select_option(index=2)  # runs away: 1e300, no number, infinity
    page.get_by_role("slider", name="Time").fill("8")
    chart(page, "replay")
    page.get_by_label("Episode", exact=True).select_option(index=1)
    csv = downloaded(page, "curves", "CSV")[1].decode()

    assert page.evaluate("window.hacked") is None
    assert page.locator("main img, .tooltip img, footer img").count() == 0
    assert page.locator("h1").inner_text().startswith("</script><script>window.hacked=1</script><img src=x")
    assert "{{data}}" in page.locator("h1").inner_text()
    assert "\u202e" not in page.content()
    assert '""window.hacked=1""' in csv  # quotes doubled
    expect(page.locator("#figure-replay .stage")).to_be_hidden()  # the plant 'constructor' has no scene


@pytest.mark.parametrize("kind", ["empty", "single"])
def test_a_study_with_little_in_it_gives_a_page(opened, kind):
    page = opened(kind)

    expect(page.locator("#answer")).to_be_visible()
    assert page.locator("#figure-curves").count() == (kind == "single")
    if kind == "single":
        chart(page, "curves")


@pytest.mark.parametrize("kind", ["demo", "hostile", "large", "empty"])
def test_nothing_is_wider_than_a_phone(opened, kind):
    page = opened(kind, viewport=PHONE, device_scale_factor=2, has_touch=True, is_mobile=True)
    for figure in ("curves", "parameters", "replay"):
        if kind != "empty" and page.locator(f"#figure-{figure}").count():
            chart(page, figure)

    assert page.evaluate("document.documentElement.scrollWidth") <= PHONE["width"]


def contrast(page, selector):
    """WCAG contrast of an element's text against the page."""
    return page.evaluate(
        """(selector) => {
          const luminance = (colour) => {
            const [r, g, b] = colour.match(/[0-9.]+/g).slice(0, 3).map((v) => v / 255)
              .map((v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4));
            return 0.2126 * r + 0.7152 * g + 0.0722 * b;
          };
          const text = luminance(getComputedStyle(document.querySelector(selector)).color);
          const paper = luminance(getComputedStyle(document.body).backgroundColor);
          return (Math.max(text, paper) + 0.05) / (Math.min(text, paper) + 0.05);
        }""",
        selector,
    )


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_light_and_dark_follow_the_reader_and_can_be_read(opened, scheme):
    page = opened("demo", color_scheme=scheme)
    paper = "document.defaultView.getComputedStyle(document.body).backgroundColor"
    chart(page, "curves")

    dark = page.evaluate(paper) == "rgb(18, 21, 25)"
    assert dark == (scheme == "dark")
    for selector in ("p.question", ".interval", ".over", "figcaption", ".tools button", ".key-row button", ".range"):
        assert contrast(page, selector) >= 4.5, selector
    page.locator("#theme").click()
    page.locator("#theme").click()
    assert page.evaluate(paper) == "rgb(18, 21, 25)"
    fill = "getComputedStyle(document.querySelector('#figure-curves .mark-line path')).stroke"
    assert page.evaluate(fill) == "rgb(98, 178, 240)"
    page.reload()
    assert page.evaluate(paper) == "rgb(18, 21, 25)"


def test_every_control_has_a_name(opened):
    page = opened("demo")
    chart(page, "replay")

    nameless = page.evaluate(
        """[...document.querySelectorAll('button, select, input, [role=img], [role=region]')]
           .filter((one) => !(one.getAttribute('aria-label') || one.textContent.trim() || one.closest('label')))
           .map((one) => one.outerHTML)"""
    )

    assert nameless == []


def test_the_printed_page_is_light_and_holds_its_charts(opened):
    page = opened("demo", color_scheme="dark")
    page.emulate_media(media="print")

    pdf = page.pdf(format="A4", print_background=True)

    assert pdf.startswith(b"%PDF")
    assert page.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)"
    assert page.evaluate("[...document.querySelectorAll('.chart')].filter((one) => !one.querySelector('.plot svg')).length") == 0
    expect(page.locator(".topbar")).to_be_hidden()


def test_a_study_of_100000_cells_stays_small_and_opens_quickly(browser, fixture_file):
    with stays_small_and_opens_quickly(browser, fixture_file("large")) as page:
        chart(page, "curves")
        expect(page.locator("aside")).to_contain_text("Left out, to keep this page small: curves of")
