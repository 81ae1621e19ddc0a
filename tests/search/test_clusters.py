"""Colonies on the workers of a Dask cluster."""

import os
import signal
import threading
import time

import pytest

import ffsr_plan as fp
from ffsr_plan.search import cluster_colonies
from ffsr_plan.search.records import SearchRequest
from ffsr_plan.time_limit.deadline import Deadline

pytest.importorskip("distributed")
ANTS = fp.AntSystem(cycles=3, ants=4)


@pytest.fixture(scope="module")
def client():
    from ffsr_plan.studies.engines.dask_cluster import local

    with local(2) as client:
        yield client


@pytest.fixture(scope="module")
def problem(point):
    goal = point.configuration((4.0, 0.0, 0.0))
    lattice = fp.Lattice(8, fp.Axis(3, 0.3))
    scene = fp.Scene([[2.0, 0.1, 0.0]], [0.4])
    return fp.Problem(point, scene, point.neutral(), goal, lattice=lattice)


def test_colonies_on_a_cluster_give_the_plan_of_one_process(problem, client):
    here = fp.plan(problem, ANTS, seed=3, colonies=3)
    there = fp.plan(problem, ANTS, seed=3, colonies=3, scheduler=client)
    assert there == here
    address = client.scheduler.address
    assert fp.plan(problem, ANTS, seed=3, colonies=3, scheduler=address) == here


@pytest.mark.parametrize("deaths", [0, 3])
def test_colonies_of_a_worker_that_dies_are_run_again_or_named(client, tmp_path, deaths):
    request, job = SearchRequest(colonies=2, scheduler=client), str(tmp_path / "died")
    client.cluster.scheduler.allowed_failures = deaths
    if deaths:
        assert cluster_colonies.run_on_cluster(dies_once, job, [1, 2], request) == [1, 2]
    else:
        with pytest.raises(fp.WorkerDied, match=r"worker 0 \(colonies 0\) died") as caught:
            cluster_colonies.run_on_cluster(dies_once, job, [1, 2], request)
        assert "tcp://" in caught.value.status


def dies_once(marker, rngs, monitor):
    if rngs == [1] and not os.path.exists(marker):
        with open(marker, "w"):
            pass
        os.kill(os.getpid(), signal.SIGKILL)
    return rngs


def test_ctrl_c_and_the_time_reach_the_workers(client):
    pressed = threading.Event()
    threading.Timer(0.5, pressed.set).start()
    request = SearchRequest(colonies=2, scheduler=client, deadline=Deadline(60.0, pressed.is_set))
    found = cluster_colonies.run_on_cluster(works_until_told, None, [1, 2], request)
    assert found == ["stopped", "stopped"]
    request = request._replace(deadline=Deadline(1.0))
    found = cluster_colonies.run_on_cluster(works_until_told, None, [1, 2], request)
    assert found == ["out of time", "out of time"]


def works_until_told(job, rngs, monitor):
    while not monitor.expired():
        time.sleep(0.01)
    return ["stopped" if monitor.deadline.stopped() else "out of time"] * len(rngs)


@pytest.mark.parametrize(
    ("given", "match"),
    [
        ({"scheduler": "tcp://127.0.0.1:9"}, "scheduler: .*one colony"),
        ({"scheduler": "tcp://127.0.0.1:9", "colonies": 2, "workers": 2}, "workers: .*1 with a"),
        ({"scheduler": "127.0.0.1:9", "colonies": 2}, "scheduler: .*an address such as"),
        ({"scheduler": 7, "colonies": 2}, "scheduler: .*an address such as"),
    ],
)
def test_a_scheduler_that_does_not_fit_is_refused(problem, given, match):
    with pytest.raises(fp.InvalidInput, match=match):
        fp.plan(problem, ANTS, **given)
