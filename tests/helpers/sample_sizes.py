"""Sizes of random samples: a part of each by default, all of it where FFSR_PLAN_LONG_TESTS is set.

FFSR_PLAN_LONG_TESTS=1 pytest -n auto
"""

import os

LONG = bool(os.environ.get("FFSR_PLAN_LONG_TESTS"))


def sample(part: int, whole: int) -> int:
    """The size of a sample.

    Args:
        part: by default.
        whole: where long tests are wanted.
    """
    return whole if LONG else part
