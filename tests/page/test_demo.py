"""The page that the demo itself leaves, with shorter trainings: what a reader of the README sees first."""

import pathlib
import subprocess

import pytest
from browsing import chart, downloaded, seconds
from playwright.sync_api import expect

STUDY = pathlib.Path(__file__).resolve().parents[2] / "studies/demo.toml"
SWEEPS = 15  # over levels: five waveforms at three sites


@pytest.fixture(scope="module")
def demo_page(program, tmp_path_factory):
    folder = tmp_path_factory.mktemp("demo")
    command = [program, "run", STUDY, "--out", folder / "demo.gust"]
    subprocess.run([*command, "--set", "policy.ppo.agent.steps=40000"], check=True, capture_output=True, timeout=300)
    return folder / "demo.gust/report.html"


def test_the_page_of_the_demo_answers_and_draws(opened, demo_page):
    page = opened(demo_page)

    expect(page.locator("p.question")).to_contain_text("How much does each kind of disturbance cost")
    rows = page.locator(".margins[data-start='0'] tbody tr:not(.group)")
    assert rows.count() == SWEEPS
    assert rows.locator(".value").count() == 2 * SWEEPS  # of the LQR and PPO
    for figure in ("curves", "survival", "learning", "parameters", "replay"):
        assert chart(page, figure).locator(".mark-line path").first.get_attribute("d")
    assert page.locator("#figure-curves .chart").count() == SWEEPS
    expect(page.locator("#claims li")).to_have_count(2)
    expect(page.locator("#provenance")).to_contain_text(f"gust run {STUDY} --set policy.ppo.agent.steps=40000")
    csv = downloaded(page, "curves", "CSV")[1].decode().splitlines()
    assert len(csv) > 1 + SWEEPS * 2 * 11  # and the levels that the margins asked for


def test_the_memory_of_a_controller_is_plotted_beside_its_replay(opened, program, tmp_path):
    study = STUDY.with_name("bench.toml")
    command = [program, "run", study, "--out", tmp_path / "bench.gust", "--set", "evaluate.episodes=3"]
    subprocess.run(command, check=True, capture_output=True, timeout=300)
    page = opened(tmp_path / "bench.gust/report.html")

    chooser = page.locator("#figure-replay select").first
    label = next(text for text in chooser.locator("option").all_inner_texts() if text.startswith("pid cascade"))
    chooser.select_option(label=label)

    expect(chart(page, "replay")).to_contain_text("integral of theta to force [N]")
    csv = downloaded(page, "replay", "CSV")[1].decode().splitlines()
    assert "integral of theta to force" in csv[0]


def test_the_demo_is_watched_falling(opened, demo_page):
    page = opened(demo_page)

    page.get_by_role("button", name="Watch").first.click()
    chart(page, "replay")
    page.wait_for_function("document.querySelector('#figure-replay input[type=range]').value > 5")
    page.get_by_role("slider", name="Time").press("End")

    assert seconds(page) > 0
    expect(page.locator("#figure-replay .badge")).to_contain_text("Failed at")
    expect(page.locator("#figure-replay .pole:not(.seen *)").first).to_be_visible()
