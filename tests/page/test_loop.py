"""The page of a loop that is no plant: curves, margins, and a replay of plots, for nobody has drawn it."""

import pathlib
import sys

import pytest
from browsing import PHONE, chart, downloaded, seconds
from playwright.sync_api import expect

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "loop"))
from room import Room  # noqa: E402

DRIFT = """
schema = 1
name   = "drift"
plant  = { kind = "drift" }
policy = [{ name = "nothing", kind = "zero" }]

[evaluate]
metrics = ["anr_h"]

[[sweep]]
name     = "bias"
site     = "action"
waveform = "constant"
levels   = [0, 0.1, 0.2]

[report]
keep_traces = "worst 1"
"""


@pytest.fixture(scope="module")
def room_page(build, tmp_path_factory):
    room = Room(build, tmp_path_factory.mktemp("room"))
    room("run", "room.toml")
    return room.folder / "room.gust/report.html"


def test_the_page_of_a_loop_answers_and_draws(opened, room_page):
    page = opened(room_page)

    expect(page.locator("header")).to_contain_text("thermostat")
    assert page.locator(".margins[data-start='0'] tbody tr:not(.group)").count() == 3
    for figure in ("curves", "survival", "parameters", "replay"):
        assert chart(page, figure).locator(".mark-line path").first.get_attribute("d")
    assert page.locator("#figure-curves .chart").count() == 3
    expect(page.locator("#claims li")).to_have_count(3)


def test_an_episode_of_a_loop_is_replayed_as_plots(opened, room_page):
    page = opened(room_page)
    drawing = chart(page, "replay")

    expect(drawing).to_contain_text("temperature observed")
    expect(drawing).to_contain_text("action [W]")
    expect(drawing).to_contain_text("reward")
    expect(page.locator("#figure-replay .stage")).to_be_hidden()
    slider = page.get_by_role("slider", name="Time")
    slider.fill("60")
    assert seconds(page) == 60
    expect(page.locator("#figure-replay .readout")).to_contain_text("temperature")
    select = page.get_by_label("Episode", exact=True)
    for title in select.locator("option").all_inner_texts():
        if "half power · sun" in title:
            select.select_option(label=title)
            break
    slider.press("End")
    expect(page.locator("#figure-replay .badge")).to_contain_text("Failed at")
    table = downloaded(page, "replay", "CSV")[1].decode().splitlines()
    assert table[0] == "step,time,temperature,heat_commanded,heat_applied,action_heat,reward"
    assert len(table) == 1 + 301


def test_the_page_of_a_loop_that_tells_rewards_alone_leaves_out_the_rest(opened, build, tmp_path):
    room = Room(build, tmp_path)
    (tmp_path / "drift.toml").write_text(DRIFT)
    room("run", "drift.toml")
    page = opened(tmp_path / "drift.gust/report.html")

    assert chart(page, "curves").locator(".mark-line path").first.get_attribute("d")
    drawing = chart(page, "replay")
    expect(drawing).to_contain_text("value observed")
    expect(drawing).to_contain_text("reward")
    expect(drawing).not_to_contain_text("action")
    page.get_by_role("slider", name="Time").press("End")
    expect(page.locator("#figure-replay .badge")).to_have_text("Lasted to the end")
    expect(page.locator("#provenance")).to_contain_text("survival (no failure)")
    assert page.locator("#figure-survival").count() == 0


def test_the_page_of_a_loop_fits_a_phone(opened, room_page):
    page = opened(room_page, viewport=PHONE)
    chart(page, "replay")

    assert page.evaluate("document.documentElement.scrollWidth") <= PHONE["width"]
