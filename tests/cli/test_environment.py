"""What the tests themselves run in."""

import os


def test_nothing_that_is_set_for_gust_reaches_the_program():
    """Run by ctest, there is a GUST_BUILD at least."""
    assert [name for name in os.environ if name.startswith("GUST_")] == []
