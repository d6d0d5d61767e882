"""The replay in a real browser: it plays, pauses, scrubs, and leaves a reader who wants no motion alone."""

from browsing import chart, seconds
from playwright.sync_api import expect


def test_the_replay_plays_pauses_and_ends(opened):
    page = opened("demo")
    chart(page, "replay")
    page.get_by_label("Episode", exact=True).select_option(index=2)
    pole = page.locator("#figure-replay .pole:not(.seen *)").first
    upright = pole.get_attribute("transform")
    for _ in range(4):
        page.get_by_role("button", name="Slower").click()

    page.get_by_role("button", name="Play", exact=True).click()
    page.wait_for_function("document.querySelector('#figure-replay input[type=range]').value > 10")
    page.get_by_role("button", name="Pause", exact=True).click()
    paused = seconds(page)
    page.wait_for_timeout(300)

    assert paused > 0.2
    assert seconds(page) == paused
    assert pole.get_attribute("transform") != upright
    for _ in range(4):
        page.get_by_role("button", name="Faster").click()
    page.get_by_role("button", name="Play", exact=True).click()
    expect(page.locator("#figure-replay .badge")).to_contain_text("Failed at", timeout=20000)
    expect(page.get_by_role("button", name="Play", exact=True)).to_be_visible()


def test_the_replay_scrubs_by_slider_plot_and_keyboard(opened):
    page = opened("demo")
    chart(page, "replay")
    slider = page.get_by_role("slider", name="Time")

    slider.fill("20")
    assert seconds(page) == 0.4
    slider.press("ArrowRight")
    assert seconds(page) == 0.42
    slider.press("Shift+ArrowRight")
    assert seconds(page) == 0.62
    slider.press("Home")
    assert seconds(page) == 0
    plots = page.locator("#figure-replay .time-plots").bounding_box()
    page.mouse.click(plots["x"] + plots["width"] / 2, plots["y"] + 40)
    middle = seconds(page)
    cursor = page.locator("#figure-replay .cursor").bounding_box()
    assert cursor["height"] > 0.7 * plots["height"]  # through all plots
    assert abs(cursor["x"] - plots["x"] - plots["width"] / 2) < 10
    slider.press("End")

    assert 0.3 * seconds(page) < middle < 0.7 * seconds(page)


def test_the_replay_can_be_slowed(opened):
    page = opened("demo")
    chart(page, "replay")

    page.get_by_role("button", name="Slower").click()
    page.get_by_role("button", name="Slower").click()

    expect(page.locator("#figure-replay .speed")).to_have_text("0.25×")


def test_a_small_margin_leads_to_its_replay(opened):
    page = opened("demo")

    row = page.locator(".by-start[data-start='0'] .smallest tr").filter(has_text="dynamics step").filter(has_text="ppo")
    row.get_by_role("button", name="Watch").first.click()

    expect(page.get_by_label("Episode", exact=True)).to_have_value("ppo, seed 2: dynamics step 1.6 N")
    expect(page.locator("#figure-replay")).to_be_in_viewport()
    page.wait_for_function("document.querySelector('#figure-replay input[type=range]').value > 2")


def test_a_reader_who_wants_no_motion_is_not_moved(opened):
    page = opened("demo", reduced_motion="reduce")

    page.get_by_role("button", name="Watch").first.click()
    page.wait_for_timeout(300)

    assert seconds(page) == 0
    assert page.evaluate("getComputedStyle(document.documentElement).scrollBehavior") == "auto"
