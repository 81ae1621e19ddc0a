"""Errors: one root, messages from their fields, pickling by their fields."""

import pickle

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan import errors
from ffsr_plan.core.checks import unknown_name
from ffsr_plan.core.contacts import Contact, MemberName
from ffsr_plan.core.formatting import nearest_name

TOUCHING = (Contact("a", 3, 0.2, "x.stl"), Contact("a", 4, 0.1, "x.stl"), Contact("a", "b", 0.1))
OF_CLOUD = tuple(
    Contact("arm", k, 0.1, MemberName(f"sphere {own} of debris cloud 'shell'"))
    for k, own in ((7, 1), (9, 3))
)
EXAMPLES = [
    errors.InvalidInput("delta", -1, "at least 0"),
    errors.StartInCollision("base", 3, 0.1),
    errors.StartInCollision("a", 3, 0.1, (Contact("a", 3, 0.1, "x.stl"),), (), ("move",)),
    errors.GoalInCollision("base", "arm", 0.1),
    errors.NoPath(3, (1, "arm"), 40),
    errors.AttitudeOutOfReach(1.0, 0.25),
    errors.PoseOutOfReach("tool", 0.1, 0.2, np.zeros(7)),
    errors.PoseOutOfReach("tool", 0.1, None, np.zeros(7)),
    errors.PoseOutOfReach("tool", 0.1, 0.2, np.zeros(7), errors.HeldBase(True, 0.3, 0.05), True),
    errors.UnprovenPath(3, "arm", None, 0.01, 40),
    errors.WorkerDied(worker=0, colonies=[0, 2], status="SIGKILL(-9)"),
    errors.PlanNotVerified(("one", "two")),
    errors.IntegrationError("a text"),
    errors.InternalError("no open edge"),
    errors.PlanningError("a text"),
]


@pytest.mark.parametrize("error", EXAMPLES, ids=lambda error: type(error).__name__)
def test_errors_have_one_root_and_survive_pickling(error):
    again = pickle.loads(pickle.dumps(error))
    assert isinstance(again, fp.FfsrPlanError)
    assert type(again) is type(error)
    assert str(again) == str(error)
    assert vars(again).keys() == vars(error).keys()
    for name, value in vars(error).items():
        assert np.array_equal(getattr(again, name), value)


def test_invalid_input_is_a_value_error():
    with pytest.raises(ValueError, match="delta: got -1; allowed: at least 0"):
        raise errors.InvalidInput("delta", -1, "at least 0")


@pytest.mark.parametrize(
    ("error", "message"),
    [
        (errors.StartInCollision("base", 3, 0.1), "start .* 0.1 m inside obstacle 3$"),
        (errors.GoalInCollision("a", "b", 0.1), "goal .* inside link 'b'$"),
        (errors.NoPath(3, (1,), 40), r"layer 3 of 40 .*closed by obstacle 1\)"),
        (errors.NoPath(3, tuple(range(20)), 40), "closed by obstacles 0, 1, .* and 8 more"),
        (errors.NoPath(3, (), 40), "closed by the limits of the lattice"),
        (
            errors.NoPath(
                3, (7, 8), 40, (Contact("hand", 7, 0.1, "a.stl"), Contact("arm", 8, 0.1))
            ),
            r"closed by a.stl \(sphere 7\) and obstacle 8, which links 'arm', 'hand' meet\)",
        ),
        (
            errors.NoPath(3, (7, 9), 40, OF_CLOUD),
            r"closed by spheres 1, 3 of debris cloud 'shell', which link 'arm' meets\)",
        ),
        (
            errors.StartInCollision("a", 3, 0.2, TOUCHING, TOUCHING[:1], ("move",)),
            r"start .*: link 'a' is 0.2 m inside x.stl \(sphere 3\) and 1 sphere more of it; "
            r"link 'a' is 0.1 m inside link 'b'; the goal is in collision too: link 'a' .*; "
            "what may help: move$",
        ),
        (
            errors.UnprovenPath(3, "a", 5, 0.1, 40, "x.stl"),
            r"link 'a' comes within 0.1 m of x.stl \(sphere 5\); what may",
        ),
        (
            errors.UnprovenPath(3, "a", 5, -0.2438, 40, "x.stl"),
            r"link 'a' is 0.2438 m inside x.stl \(sphere 5\); what may",
        ),
        (errors.UnprovenPath(3, "a", "b", -5e-17, 40), "link 'a' touches link 'b'; what may"),
        (errors.StartInCollision("a", 3, 5.55e-17), "start .*: link 'a' touches obstacle 3$"),
        (
            errors.PoseOutOfReach("t", 0.1, None, np.zeros(7), errors.HeldBase(True, 0.1, 0.05)),
            r"within reach of a held base, .* by 5\.73 degrees and takes the frame 0\.05 m away",
        ),
        (
            errors.PoseOutOfReach("t", 0.1, None, np.zeros(7), errors.HeldBase(False, 0.1, 0.05)),
            r"a held base misses it as well, by 0\.05 m",
        ),
        (errors.AttitudeOutOfReach(np.pi / 2, np.pi / 6), r"by 60\.0 of 90\.0 degrees"),
        (errors.PlanNotVerified(("one", "two")), "does not verify: one; two"),
        (errors.InternalError("no open edge"), "internal error: no open edge; please report it"),
        (errors.InvalidInput("x", "y" * 200, "z"), r"y\.\.\.; allowed: z"),
    ],
)
def test_messages_say_what_happened(error, message):
    with pytest.raises(type(error), match=message):
        raise error


def test_the_most_similar_name_is_suggested():
    error = unknown_name("robot", "pont", ["point", "satellite"])
    assert "did you mean 'point'?" in str(error)


@pytest.mark.parametrize(
    ("value", "names", "nearest"),
    [
        ("radios", ["name", "radius"], "radius"),
        ("Fig2A", ["fig2a", "fig2b"], "fig2a"),
        ("ants", ["ant-system", "max-min-ant-system"], "ant-system"),
        ("cvs", ["center", "csv"], "csv"),
        ("diameter", ["name", "radius"], None),
        ("ants", ["name"], None),
        ("stowed", [], None),
    ],
)
def test_a_name_is_suggested_only_where_it_is_close(value, names, nearest):
    assert nearest_name(value, names) == nearest
    assert ("did you mean" in str(unknown_name("x", value, names))) == (nearest is not None)


def test_where_there_is_no_name_the_message_says_so():
    assert str(unknown_name("x", "a", [], "no joint")).endswith("allowed: no joint")
    assert str(unknown_name("x", "a", ["b"], "no joint")).endswith("allowed: b")


def test_a_message_is_one_short_line_whatever_it_quotes():
    for what, value, allowed in (
        ("a\nb\x1b[31m", "c\r\nd\x00", "one\n  two"),
        ("n" * 9000, ["v"] * 9000, "a" * 9000),
        ("count", -(10**9000), "less"),
    ):
        message = str(errors.InvalidInput(what, value, allowed))
        assert message.isprintable()
        assert len(message) < 1500
    assert str(errors.InvalidInput("a\nb", "c", "d")) == "a b: got 'c'; allowed: d"
