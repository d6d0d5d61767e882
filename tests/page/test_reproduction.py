"""A paper's reproduction in a real browser: the picture of the verdicts leads to the claims, and every figure lives on its own."""

import re

import pytest
from browsing import PHONE, stays_small_and_opens_quickly
from playwright.sync_api import expect

CHARTS = {"learning": ["learning"], "injected": ["disturbances", "replay"], "white": ["curves", "survival"],
          "plant": ["parameters", "grids"]}


def drawing(page, figure, kind, index=0):
    """The drawn SVG of a chart of one of the paper's figures, scrolled to."""
    host = page.locator(f"#figure-{figure} [data-figure={kind}] .chart").nth(index)
    host.scroll_into_view_if_needed()
    svg = host.locator(".plot svg")
    expect(svg).to_have_count(1)
    return svg


@pytest.mark.parametrize("figure", CHARTS)
def test_every_figure_draws_its_charts(opened, figure):
    page = opened("reproduction")

    for kind in CHARTS[figure]:
        marks = drawing(page, figure, kind).locator(".mark-line path, .mark-rect path")
        assert marks.first.get_attribute("d")
    shown = page.locator(f"#figure-{figure} [data-figure]")
    assert shown.evaluate_all("all => all.map((one) => one.dataset.figure)") == CHARTS[figure]


def test_a_choice_in_one_figure_leaves_the_others_alone(opened):
    page = opened("reproduction")
    other = drawing(page, "plant", "parameters").locator(".mark-line path").first.get_attribute("d")
    line = drawing(page, "white", "curves").locator(".mark-line path").first
    before = line.get_attribute("d")

    page.locator("#figure-white [data-figure=curves]").get_by_label("Metric").select_option("2")
    page.locator("#figure-white [data-figure=curves]").get_by_role("button", name="random").click()
    page.locator("#figure-white [data-figure=curves]").get_by_role("button", name="ppo", exact=True).click()

    expect(line).not_to_have_attribute("d", before)
    plant = page.locator("#figure-plant [data-figure=parameters]")
    expect(plant.get_by_label("Metric")).to_have_value("0")
    expect(plant.get_by_role("button", name="nominal")).to_have_attribute("aria-pressed", "true")
    expect(plant.get_by_role("button", name="ppo", exact=True)).to_have_attribute("aria-pressed", "true")
    survival = page.locator("#figure-white [data-figure=survival]")
    expect(survival.get_by_role("button", name="ppo", exact=True)).to_have_attribute("aria-pressed", "false")
    assert drawing(page, "plant", "parameters").locator(".mark-line path").first.get_attribute("d") == other


def test_what_was_injected_is_drawn_once_a_sweep(opened):
    page = opened("reproduction")
    figure = page.locator("#figure-injected [data-figure=disturbances]")
    data = page.evaluate("JSON.parse(document.querySelector('#figure-injected > script').textContent)")
    kept = [next(one for one in data["episodes"] if one.get("s") == s) for s in sorted({one["s"] for one in data["episodes"] if "s" in one})]

    assert figure.locator("h4").all_inner_texts() == [data["sweeps"][one["s"]]["name"] for one in kept]
    drawing(page, "injected", "disturbances")
    with page.expect_download() as event:
        figure.get_by_role("button", name="CSV").click()
    rows = [line.split(",") for line in open(event.value.path()).read().splitlines()[1:]]
    first = kept[0]["disturbances"][0]["v"]
    assert [float(row[3]) for row in rows[:len(first)]] == first


def test_the_key_of_the_replay_is_as_wide_as_its_words(opened):
    page = opened("reproduction")
    drawing(page, "injected", "replay")

    for mark in page.locator("#figure-injected .legend .mark:visible").all():
        assert mark.bounding_box()["height"] < 25  # one line


def test_a_policy_looks_the_same_in_every_figure(opened):
    page = opened("reproduction")

    for name in ("lqr", "ppo", "ppo-modern"):
        colours = page.evaluate(
            """(name) => [...document.querySelectorAll('.key-row button')].filter((one) => one.textContent === name)
               .map((one) => getComputedStyle(one).getPropertyValue('--policy') + one.querySelector('path').getAttribute('d'))""",
            name,
        )
        assert len(colours) == 4
        assert len(set(colours)) == 1


@pytest.mark.parametrize("figure, kind", [("learning", "learning"), ("injected", "disturbances"), ("white", "curves"), ("plant", "grids")])
def test_every_chart_gives_its_data(opened, figure, kind):
    page = opened("reproduction")
    drawing(page, figure, kind)
    tools = page.locator(f"#figure-{figure} [data-figure={kind}] .tools")

    with page.expect_download() as event:
        tools.get_by_role("button", name="CSV").click()
    with page.expect_download() as image:
        tools.get_by_role("button", name="SVG").click()

    name = page.evaluate("(id) => JSON.parse(document.querySelector(`#figure-${id} > script`).textContent).name", figure)
    assert event.value.suggested_filename == f"{name}-{kind}.csv"
    assert image.value.suggested_filename == f"{name}-{kind}.svg"


def test_the_picture_holds_every_claim_and_leads_to_it(opened):
    page = opened("reproduction")
    cells = page.locator(".cells .cell")
    assert cells.count() == 12
    assert page.locator(".claims > li").count() == 12
    counts = [int(text) for text in page.locator(".counts dd").all_inner_texts()]
    assert sum(counts) == 12

    for i in (7, 11):
        cells.nth(i).click()
        expect(page.locator(f"#claim-C{i + 1}")).to_be_in_viewport()
        assert page.evaluate("document.querySelector(':target').id") == f"claim-C{i + 1}"
        page.evaluate("window.scrollTo({top: 0, behavior: 'instant'})")


def test_a_verdict_can_be_read_without_colour(opened):
    page = opened("reproduction")

    for cell in page.locator(".cells .cell").all():
        verdict = re.search(r"C\d+ (shown|open|refuted in part|refuted|not comparable|not testable)", cell.text_content()).group(1)
        mark = cell.locator("use").get_attribute("href")
        marks = {"shown": "holds", "open": "undecided", "refuted in part": "partly", "refuted": "fails"}
        assert mark == f"#mark-{marks.get(verdict, 'untested')}"
        assert page.locator(mark).count() == 1


def test_the_readings_show_what_hangs_on_them(opened):
    page = opened("reproduction")

    assert page.locator(".readings tbody tr").count() == 3
    assert page.locator(".readings thead th.hangs").all_inner_texts() == ["C2"]
    assert page.locator(".cell.hangs").count() == 1
    expect(page.locator(".changing li")).to_have_count(1)
    expect(page.locator("#claim-C2 .judged table")).to_be_hidden()
    page.locator("#claim-C2 summary").click()
    expect(page.locator("#claim-C2 .judged code")).to_contain_text("score(a")
    expect(page.locator("#claim-C2 .judged tbody tr")).to_have_count(2)


def test_the_page_reads_without_scripts(browser, fixture_file):
    page = browser.new_page(java_script_enabled=False)
    page.goto(fixture_file("reproduction").as_uri())

    page.locator(".cell").nth(3).click()

    assert page.url.endswith("#claim-C4")
    expect(page.locator("#claim-C4")).to_be_in_viewport()
    expect(page.locator(".printed tbody tr:not(.group)")).to_have_count(9)
    page.close()


def test_no_name_is_given_twice_and_every_control_has_one(opened):
    page = opened("reproduction")
    drawing(page, "plant", "grids")

    twice = page.evaluate(
        """(() => { const ids = [...document.querySelectorAll('[id]')].map((one) => one.id);
           return ids.filter((id, i) => ids.indexOf(id) !== i); })()"""
    )
    nameless = page.evaluate(
        """[...document.querySelectorAll('button, select, input, [role=img], [role=region]')]
           .filter((one) => !(one.getAttribute('aria-label') || one.textContent.trim() || one.closest('label')))
           .map((one) => one.outerHTML)"""
    )

    assert twice == []
    assert nameless == []


@pytest.mark.parametrize("kind", ["reproduction", "large-reproduction"])
def test_no_reproduction_is_wider_than_a_phone(opened, kind):
    page = opened(kind, viewport=PHONE, device_scale_factor=2, has_touch=True, is_mobile=True)
    if kind == "reproduction":
        for figure, kinds in CHARTS.items():
            for one in kinds:
                drawing(page, figure, one)

    assert page.evaluate("document.documentElement.scrollWidth") <= PHONE["width"]
    first = page.locator(".readings tbody th").first
    page.locator(".readings").evaluate("(one) => { one.scrollLeft = 100; }")
    assert first.bounding_box()["x"] < 20  # it stays while the table moves


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_the_verdicts_follow_light_and_dark(opened, scheme):
    page = opened("reproduction", color_scheme=scheme)

    assert (page.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(18, 21, 25)") == (scheme == "dark")
    for verdict in ("holds", "fails", "undecided"):
        colours = page.evaluate(
            """(verdict) => { const style = getComputedStyle(document.querySelector(`.cell.${verdict}`));
               return [style.color, style.backgroundColor].map((colour) => colour.match(/\\d+/g).slice(0, 3).map((v) => v / 255)
                 .map((v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4)))
                 .map(([r, g, b]) => 0.2126 * r + 0.7152 * g + 0.0722 * b).sort((a, b) => a - b); }""",
            verdict,
        )
        assert (colours[1] + 0.05) / (colours[0] + 0.05) >= 4.5, verdict


def test_many_policies_show_few_at_first_and_the_reader_the_rest(opened):
    page = opened("large-reproduction")
    grids = page.locator("#figure-figure-3 [data-figure=grids]")
    grids.scroll_into_view_if_needed()
    assert grids.locator(".tile").count() == 7  # of the first eight policies one has no map

    grids.get_by_role("button", name="None").click()
    expect(grids.locator(".tile")).to_have_count(0)
    grids.get_by_role("button", name="ppo dynamics 11").click()

    expect(grids.locator(".tile")).to_have_count(1)
    assert page.locator("#figure-figure-3 [data-figure=learning] .tile:visible").count() == 1
    assert page.locator("#figure-figure-4 [data-figure=grids] .tile").count() == 7


def test_the_printed_reproduction_is_light_and_keeps_its_verdicts(opened):
    page = opened("reproduction", color_scheme="dark")
    page.wait_for_function(
        "[...document.querySelectorAll('.chart')].every((host) => host.querySelector('.plot svg'))", timeout=120000
    )
    page.emulate_media(media="print")

    pdf = page.pdf(format="A4", print_background=False)

    assert pdf.startswith(b"%PDF")
    assert page.evaluate("getComputedStyle(document.querySelector('.cell.holds')).backgroundColor") == "rgb(20, 113, 63)"
    expect(page.locator(".topbar")).to_be_hidden()


def test_a_button_draws_every_chart_and_prints(opened):
    page = opened("reproduction")
    page.evaluate("window.print = () => { window.printed = document.querySelectorAll('.chart:not(:has(svg))').length; }")

    page.get_by_role("button", name="Draw all charts and print").click()

    page.wait_for_function("window.printed === 0")


def test_a_reproduction_of_19_crowded_figures_stays_small_and_opens_quickly(browser, fixture_file):
    with stays_small_and_opens_quickly(browser, fixture_file("large-reproduction"), seconds=6) as page:  # 2 s where it was made
        assert page.locator(".chart .plot svg").count() < 20  # only what is near the window
