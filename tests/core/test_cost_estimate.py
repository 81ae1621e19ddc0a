"""Laws of the limit on memory and work."""

import pytest

from ffsr_plan.core.cost_estimate import MOST_BYTES, MOST_SECONDS, check_memory, check_work
from ffsr_plan.core.errors import InvalidInput


def test_memory_above_the_limit_is_refused_with_its_factors():
    counts = {"layers": 1001, "nodes": 2001, "spheres": 5000}
    with pytest.raises(
        InvalidInput,
        match=r"^lattice: got layers 1001 x nodes 2001 x spheres 5000: 80\.1 GB; "
        r"allowed: at most 2 GB of memory: fewer of them$",
    ):
        check_memory("lattice", counts, 8.0, "fewer of them")


def test_exactly_the_limit_is_allowed_and_more_is_not():
    check_memory("x", {"n": int(MOST_BYTES)}, 1.0, "")
    check_work("x", {"n": int(MOST_SECONDS)}, 1.0, "")
    with pytest.raises(InvalidInput):
        check_memory("x", {"n": int(MOST_BYTES)}, 1.0, "", fixed=1.0)
    with pytest.raises(InvalidInput, match=r"n 7200: 2 hours; allowed: at most 1 hour: less"):
        check_work("x", {"n": 2 * int(MOST_SECONDS)}, 1.0, "less")


def test_counts_whose_product_no_float_holds_are_refused():
    huge = dict.fromkeys("abcdefghi", 2**128)
    with pytest.raises(InvalidInput, match=r"a 3\.4e\+38 x b"):
        check_memory("x", huge, 1.0, "")
    with pytest.raises(InvalidInput):
        check_work("x", huge, 0.1, "")
