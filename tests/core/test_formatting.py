"""Numbers and tables as text."""

import numpy as np
import pytest

from ffsr_plan.core.formatting import counted, html_table, proven


@pytest.mark.parametrize(
    ("clearance", "text"),
    [(0.12399, "0.123 m"), (12.39, "12.3 m"), (0.0, "0 m"), (np.inf, "inf m"), (-0.5, "-0.5 m")],
)
def test_proven_clearances_are_rounded_down(clearance, text):
    assert proven(clearance) == text


def test_nouns_follow_their_number():
    assert [counted(k, "link") for k in (0, 1, 2)] == ["0 links", "1 link", "2 links"]


def test_html_tables_escape_what_they_show():
    table = html_table("a < b", {"x & y": "<script>"})
    assert table == (
        "<table><caption>a &lt; b</caption>"
        "<tr><th>x &amp; y</th><td>&lt;script&gt;</td></tr></table>"
    )
