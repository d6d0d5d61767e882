"""The networks that the paper's first author published do in gust what her own training log says of them."""

import importlib.machinery
import importlib.util

import pytest
from conftest import PROGRAM, ROOT


def script():
    """scripts/check-authors-networks as a module; it runs the program under test."""
    loader = importlib.machinery.SourceFileLoader("check_authors_networks", str(ROOT / "scripts/check-authors-networks"))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(loader.name, loader))
    loader.exec_module(module)
    module.GUST = PROGRAM
    return module


CHECK = script()
pytestmark = pytest.mark.skipif(not CHECK.FOLDER.is_dir(), reason=f"the networks are no part of the project: no {CHECK.FOLDER}")


@pytest.fixture(scope="module")
def found():
    return CHECK.measured(CHECK.FOLDER)


def deviations(**changes):
    found = CHECK.measured(CHECK.FOLDER, **changes)
    assert len(found) == 20
    return {column: CHECK.root_mean_square(found, column) for column in CHECK.METRICS}


def test_all_checkpoints_agree_with_the_log_within_sampling_error(found):
    assert len(found) == 20
    deviations = {column: CHECK.root_mean_square(found, column) for column in CHECK.METRICS}
    assert {column: z for column, z in deviations.items() if z > CHECK.LIMIT} == {}


def test_the_committed_table_is_what_is_measured(found):
    assert (ROOT / "studies/paper/checks.md").read_text().endswith(CHECK.table(found) + "\n")


def test_the_log_tells_a_wider_rail_and_other_weights_from_its_own_settings():
    assert deviations(x_limit="2.4")["length"] > CHECK.LIMIT
    assert deviations(state_weights="[5,0,1,0]")["return"] > CHECK.LIMIT
