"""Laws of the checks of user input: a clean value or `InvalidInput`, nothing else."""

import fractions
from pathlib import Path

import numpy as np
import pytest

from ffsr_plan.core.checks import finite_array, number, path, text, whole_number
from ffsr_plan.core.errors import InvalidInput


class Unprintable:
    """An object whose representation raises."""

    def __repr__(self):
        raise RuntimeError("no representation")

    def __array__(self, dtype=None, copy=None):
        raise RuntimeError("no array")


ODD = [None, 10**400, -(10**5000), "1", b"1", object(), Unprintable(), [], {}, 1j, True, float]


@pytest.mark.parametrize("value", ODD, ids=range(len(ODD)))
@pytest.mark.parametrize("check", [number, lambda w, v: whole_number(w, v, at_least=0)])
def test_a_number_is_a_number_or_refused_by_name(check, value):
    if type(value) is int and value > 0 and check is not number:
        value *= 10
    with pytest.raises(InvalidInput, match=r"^here: got .{1,125}; allowed: "):
        check("here", value)


def test_a_fraction_beyond_floats_is_refused():
    assert number("x", fractions.Fraction(1, 2)) == 0.5
    with pytest.raises(InvalidInput):
        number("x", fractions.Fraction(10**400))


WRONG = [*ODD, [10**400], ["1"], [True], [1.0, False], [[1.0], ["2"]], np.array(["1"]),
         np.array([True]), np.array([None]), np.array([1.0, "x"], dtype=object), [np.bool_(True)],
         np.array([1], dtype="m8[s]")]  # fmt: skip


@pytest.mark.parametrize("value", WRONG, ids=range(len(WRONG)))
def test_an_array_holds_numbers_only(value):
    for shape in ((1,), (2,), (2, 1)):
        with pytest.raises(InvalidInput, match=r"^there"):
            finite_array("there", value, shape)


MASKED = np.ma.masked_array([1.0, 2.0], mask=[False, True])


@pytest.mark.parametrize(
    ("value", "shape"),
    [(MASKED, (2,)), ([MASKED, [3.0, 4.0]], (2, 2)), (MASKED[1], ()), ([1.0, MASKED[1]], (2,))],
    ids=["array", "row", "number", "entry"],
)
@pytest.mark.filterwarnings("ignore:Warning. converting a masked element")
def test_masked_numbers_are_not_used(value, shape):
    with pytest.raises(InvalidInput, match=r"^there: got .*none of them masked"):
        finite_array("there", value, shape)
    assert np.all(finite_array("there", np.ma.masked_array([1.0, 2.0]), (2,)) == [1.0, 2.0])


def test_of_a_long_array_the_first_wrong_number_is_named():
    values = np.zeros((20, 3))
    values[7, 2] = values[9, 0] = np.nan
    with pytest.raises(InvalidInput, match=r"^there, entry 7: got nan; allowed: a finite number"):
        finite_array("there", values, (-1, 3))
    with pytest.raises(InvalidInput, match=r"^there, row 7: got nan"):
        finite_array("there", values[:, 2], (-1,), row="row")
    with pytest.raises(InvalidInput, match=r"^there: got \[0\.0, nan\]; allowed: finite numbers"):
        finite_array("there", [0.0, np.nan], (2,))


@pytest.mark.parametrize(
    "value", [[1, 2.5], (np.float32(1.0), 2), np.array([1, 2]), np.array([1, 2.5], dtype=object)]
)
def test_arrays_of_any_kind_of_number_are_accepted(value):
    assert finite_array("there", value, (2,)).dtype == np.float64


@pytest.mark.parametrize(
    "value",
    [
        None,
        3,
        True,
        "",
        b"a",
        [],
        object(),
        "a\0b",
        "n" * 256,
        "d/" * 2100,
        "\ud800",
        Path("n" * 300),
    ],
    ids=range(12),
)
def test_a_path_that_no_file_can_have_is_refused(value):
    with pytest.raises(InvalidInput, match=r"^where: got .{1,125}; allowed: a path"):
        path("where", value)


def test_a_path_is_kept_whether_or_not_there_is_a_file():
    assert path("where", "a/b.csv") == Path("a/b.csv")
    assert path("where", "n" * 255) == Path("n" * 255)
    assert path("where", Path("b.gif"), ".gif") == Path("b.gif")
    with pytest.raises(InvalidInput, match=r"b\.png'; allowed: a path that ends in \.gif"):
        path("where", "b.png", ".gif")


def test_a_text_is_a_text():
    assert text("title", "") == ""
    with pytest.raises(InvalidInput, match="title: got 3; allowed: a text"):
        text("title", 3)
