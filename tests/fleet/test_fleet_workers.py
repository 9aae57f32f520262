import os

import pytest
from fleet_tasks import doubled, mortal, own_pid, own_threads, picky

from nxt_twin.fleet.errors import FleetError
from nxt_twin.fleet.workers.each import each
from nxt_twin.fleet.workers.place import Cluster, Here, Processes, place_of


def results(work, tasks, place):
    return {outcome.task: outcome.result for outcome in each(work, tasks, place)}


def test_processes_and_this_one_answer_alike():
    tasks = range(5)
    assert (
        results(doubled, tasks, Processes(2)) == results(doubled, tasks, Here()) == {n: 2 * n for n in tasks}
    )


@pytest.mark.parametrize("place", [Here(), Processes(1)])
def test_a_task_that_raises_costs_no_other(place):
    outcomes = {outcome.task: outcome for outcome in each(picky, [2, 3, 4], place)}
    assert [outcomes[n].result for n in (2, 4)] == [2, 4]
    assert outcomes[3].failure.text == "ValueError: not three"


def test_a_killed_worker_costs_no_result(tmp_path):
    tasks = [(n, str(tmp_path / f"mark{n}") if n == 1 else "") for n in range(3)]
    assert results(mortal, tasks, Processes(1)) == {task: task[0] for task in tasks}


def test_a_task_that_kills_every_worker_fails_alone(tmp_path):
    poison = (9, str(tmp_path / "never"))
    outcomes = {outcome.task: outcome for outcome in each(mortal, [(1, ""), poison], Processes(1))}
    assert outcomes[(1, "")].result == 1
    assert outcomes[poison].failure.kind == "died"


def test_tasks_are_taken_as_workers_become_free():
    taken = []

    def tasks():
        for number in range(100):
            taken.append(number)
            yield number

    outcomes = each(doubled, tasks(), Processes(1))
    next(outcomes)
    outcomes.close()
    assert len(taken) <= 2


def test_an_early_end_leaves_no_process_behind():
    outcomes = each(own_pid, [1, 2, 3], Processes(1))
    pid = next(outcomes).result
    next(outcomes)
    outcomes.close()
    with pytest.raises(ProcessLookupError):
        os.kill(pid, 0)


def test_options_name_the_place():
    assert place_of(1, None) == Here()
    assert place_of(3, None) == Processes(3)
    assert place_of(3, "tcp://127.0.0.1:1") == Cluster("tcp://127.0.0.1:1")


def test_a_cluster_does_what_processes_do():
    from distributed import LocalCluster

    options = {"n_workers": 1, "threads_per_worker": 2, "protocol": "tcp", "dashboard_address": None}
    with LocalCluster(processes=False, silence_logs=50, host="127.0.0.1", **options) as cluster:
        place = Cluster(cluster.scheduler_address)
        assert results(doubled, range(20), place) == {n: 2 * n for n in range(20)}
        outcomes = {outcome.task: outcome for outcome in each(picky, [2, 3], place)}
        assert results(own_threads, [0], place)[0][1] == 1
    assert outcomes[2].result == 2
    assert outcomes[3].failure.text == "ValueError: not three"


def test_a_cluster_that_is_not_there_is_told_in_one_line(monkeypatch):
    monkeypatch.setattr("nxt_twin.fleet.workers.cluster._CONNECT_S", 0.2)
    with pytest.raises(FleetError, match="no Dask scheduler answers"):
        list(each(doubled, [1], Cluster("tcp://127.0.0.1:9")))


@pytest.mark.parametrize(("asked", "given"), [({}, "1"), ({"OPENBLAS_NUM_THREADS": "2"}, "2")])
def test_a_worker_simulates_in_one_thread_and_does_linear_algebra_in_one_unless_the_user_says_otherwise(
    monkeypatch, asked, given
):
    for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
        monkeypatch.setenv(name, "")  # so that it is as before when the test ends
        monkeypatch.delenv(name)
    for name, value in asked.items():
        monkeypatch.setenv(name, value)
    assert results(own_threads, [0], Processes(1)) == {0: (given, 1)}
