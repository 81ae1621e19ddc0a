"""Fixtures shared by all tests."""

import signal

import pytest
from hypothesis import HealthCheck, Phase, settings

import ffsr_plan as fp

if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:  # as in the background of a script
    signal.signal(signal.SIGINT, signal.default_int_handler)  # programs under test inherit it

settings.register_profile(
    "ffsr", deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow]
)
settings.register_profile(  # of tools/run_mutations.py: a failing example need not be small
    "mutations", settings.get_profile("ffsr"), phases=[Phase.explicit, Phase.generate]
)
settings.load_profile("ffsr")


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config, log):
    """Tests of one file run on one worker: it compiles their kernels and makes their fixtures."""
    from xdist.scheduler import LoadFileScheduling

    config.option.loadscopereorder = False  # the last files are short
    return LoadFileScheduling(config, log)


@pytest.fixture(scope="session")
def robot():
    return fp.load_robot("planar_dual_arm")


@pytest.fixture(scope="session")
def point():
    return fp.load_robot("point")


@pytest.fixture(scope="session")
def fig2a_plan():
    scenario = fp.Scenario.load("fig2a")
    return fp.plan(scenario.problem, scenario.planner, scenario.seed, refine=scenario.refine)
