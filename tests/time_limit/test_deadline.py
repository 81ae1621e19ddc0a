"""A deadline ends by its limit or by Ctrl-C; kernels that are made ready do not count."""

import time

import pytest

import ffsr_plan as fp
from ffsr_plan.core.kernels import compiling_time
from ffsr_plan.core.kernels.compiling_time import Stopwatch, add_compiled, loading, spent_on_kernels
from ffsr_plan.time_limit.deadline import CLOSING_SECONDS, CLOSING_SHARE, Deadline


class Clock:
    def __init__(self):
        self.now = 100.0

    def __call__(self):
        return self.now


@pytest.fixture
def clock():
    return Clock()


def test_a_deadline_passes_at_its_limit(clock):
    deadline = Deadline(2.0, clock=clock)
    clock.now += 1.75
    assert (deadline.elapsed(), deadline.remaining()) == (1.75, 0.25)
    assert deadline.is_limited
    deadline.check()
    clock.now += 0.25
    deadline.stage = "the search"
    with pytest.raises(fp.OutOfTime) as caught:
        deadline.check()
    assert (caught.value.time_limit, caught.value.stage) == (2.0, "the search")


def test_without_a_limit_only_ctrl_c_ends(clock):
    pressed = []
    deadline = Deadline(clock=clock).stopped_by(lambda: bool(pressed))
    clock.now += 1e9
    assert not deadline.is_limited
    deadline.check()
    pressed.append(True)
    assert deadline.stopped()
    with deadline.without_stop():
        deadline.check()
    with pytest.raises(fp.OutOfTime):
        deadline.check()


def test_a_part_is_a_share_of_what_is_left_and_leaves_the_whole_as_it_is(clock):
    pressed = []
    whole = Deadline(2.0, clock=clock).stopped_by(lambda: bool(pressed))
    clock.now += 1.0
    part = whole.part(0.25)
    assert (part.elapsed(), part.remaining(), part.seconds) == (1.0, 0.25, 0.5)
    part.close()
    assert whole.remaining() == 1.0
    pressed.append(True)
    assert whole.stopped()
    assert not Deadline(clock=clock).part(0.25).is_limited


def test_what_kernels_take_before_they_run_does_not_count(clock):
    deadline = Deadline(2.0, clock=clock)
    clock.now += 3.0
    add_compiled(1.5)
    assert deadline.elapsed() == pytest.approx(1.5)
    assert not deadline.passed()


def test_loading_counts_once_and_is_no_compiling(monkeypatch):
    now = iter([1.0, 4.0])
    watch, before = Stopwatch(), spent_on_kernels()
    monkeypatch.setattr(compiling_time.time, "perf_counter", lambda: next(now))
    with loading(), loading():
        pass
    monkeypatch.undo()
    assert spent_on_kernels() - before == pytest.approx(3.0)
    assert watch.compiling == 0.0


def test_loading_while_a_kernel_compiles_is_part_of_that(monkeypatch):
    now, before = iter([1.0, 4.0]), spent_on_kernels()
    monkeypatch.setattr(compiling_time.time, "perf_counter", lambda: next(now))
    compiling_time.count_begin()
    with loading():
        pass
    compiling_time.count_end()
    monkeypatch.undo()
    assert spent_on_kernels() - before == pytest.approx(3.0)


def test_closing_leaves_a_little_time_after_the_limit(clock):
    early, late = Deadline(2.0, clock=clock), Deadline(2.0, clock=clock)
    early.close()
    allowance = CLOSING_SHARE * 2.0 + CLOSING_SECONDS
    assert early.remaining() == pytest.approx(2.0 + allowance)
    clock.now += 2.5
    late.close()
    assert late.remaining() == pytest.approx(allowance - 0.5)
    assert allowance < 0.05 * 2.0 + 0.02  # what remains of the tolerance is for the return


def test_after_ctrl_c_closing_counts_from_now(clock):
    deadline = Deadline(clock=clock, stop_requested=lambda: True)
    clock.now += 4.0
    deadline.close()
    assert deadline.remaining() == pytest.approx(CLOSING_SHARE * 4.0 + CLOSING_SECONDS)
    deadline.check()  # Ctrl-C has been noted
    unlimited = Deadline(clock=clock)
    unlimited.close()
    assert unlimited.remaining() == float("inf")


def test_another_process_takes_over_the_same_end():
    pressed = []
    handed = Deadline(50.0).handed_on()
    taken = Deadline.taken_over(handed, lambda: bool(pressed))
    assert taken.seconds == 50.0
    assert handed[1] - time.monotonic() == pytest.approx(taken.remaining(), abs=1.0)
    assert not taken.passed()
    pressed.append(True)
    assert taken.passed()
    past = Deadline.taken_over((50.0, time.monotonic() - 1.0), bool)
    assert past.passed()
    assert Deadline.taken_over(Deadline().handed_on(), bool).remaining() == float("inf")
