"""A grid on Dask: several worker processes, one killed in the middle, and the answers of a local run."""

from __future__ import annotations

import functools
import os
import signal
import threading
import time
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import lindstedt
from lindstedt import Oscillator
from lindstedt._oscillator import _on_dask

distributed = pytest.importorskip("distributed")


@pytest.fixture(scope="module")
def client() -> Iterator[Any]:
    """Four worker processes; one that is killed is started again, however long that takes: after 15 seconds the cluster
    would give it up, and close it just when it comes, on a busy machine."""
    import dask

    with (
        dask.config.set({"distributed.deploy.lost-worker-timeout": "10 minutes"}),
        distributed.LocalCluster(n_workers=4, threads_per_worker=1, dashboard_address=None) as cluster,
        distributed.Client(cluster) as client,
    ):
        yield client


def _counted(folder: str, part: int) -> int:
    Path(folder, f"{part}-{os.getpid()}-{time.time_ns()}").touch()
    time.sleep(0.2)
    return part * part


def test_finished_parts_survive_their_worker(client: Any, tmp_path: Path) -> None:
    work = functools.partial(_counted, str(tmp_path))
    client.wait_for_workers(4)
    doomed = min(client.run(os.getpid).values())

    def kill() -> None:
        while len(list(tmp_path.glob(f"*-{doomed}-*"))) < 5:
            time.sleep(0.02)
        os.kill(doomed, signal.SIGKILL)

    thread = threading.Thread(target=kill)
    thread.start()
    assert _on_dask(client, work, list(range(32))) == [part * part for part in range(32)]
    thread.join(60)
    runs = Counter(int(run.name.split("-")[0]) for run in tmp_path.iterdir())
    started = len(list(tmp_path.glob(f"*-{doomed}-*")))
    # What it was working on runs twice, and perhaps what was on its way; what it had finished before does not.
    assert started >= 5 and sum(runs.values()) - 32 <= 3, runs


def _bytes(found: Any) -> list[Any]:
    return [value.tobytes() if hasattr(value, "tobytes") else value for value in vars(found).values()]


def test_charts_are_the_same_bit_by_bit(client: Any) -> None:
    impact, belt = Oscillator.builtin("vibro-impact"), Oscillator.builtin("stick-slip")
    plane: Any = {"A": (-0.3, 0.3, 40), "B": (-0.3, 0.3, 60)}
    # In uneven steps it is computed point by point.
    uneven: Any = {"A": (-0.3, 0.3, 5), "B": [-0.3, -0.1, 0, 0.3]}
    questions: list[tuple[Any, Any, dict[str, Any]]] = [
        (impact.stability_chart, plane, {"radius": True}),
        (impact.stability_chart, uneven, {}),
        (belt.threshold_surface, {"vstar": (0, 1, 30), "omega": (1, 3, 50)}, {}),
        # A frequency that is not positive: no value, and no fast way for the others.
        (belt.threshold_surface, {"vstar": (0, 1, 3), "omega": (-1, 1, 5)}, {}),
        (belt.bifurcation_diagram, {"gamma": ("0.5", "0.8", 12)}, {"skip": 20, "keep": 4}),
    ]
    local = [_bytes(ask(sweep, **options)) for ask, sweep, options in questions]
    client.wait_for_workers(4)
    doomed = min(client.run(os.getpid).values())
    for number, (ask, sweep, options) in enumerate(questions):
        if number == 1:
            os.kill(doomed, signal.SIGKILL)
        assert _bytes(ask(sweep, executor=client, block=3, **options)) == local[number], number
    with pytest.raises(lindstedt.UsageError, match="follow"):
        belt.bifurcation_diagram("gamma=0.5..0.6:2", executor=client, follow=True)


def test_a_killed_worker_loses_nothing(client: Any) -> None:
    cycle = Oscillator("x'' + x = eps*(1 - x**2)*x'")
    values: dict[str, list[lindstedt.Value]] = {"eps": [f"{n}/20" for n in range(1, 17)]}

    def plain(answers: list[Any]) -> list[dict[str, Any]]:
        return [{k: v for k, v in answer.to_dict().items() if k != "seconds"} for answer in answers]

    local = plain(lindstedt.grid(cycle, "evaluate", values, digits=8))
    client.wait_for_workers(4)
    before = client.run(os.getpid)
    answered: list[Any] = []
    work = threading.Thread(
        target=lambda: answered.extend(lindstedt.grid(cycle, "evaluate", values, client, block=2, digits=8))
    )
    work.start()
    deadline = time.monotonic() + 60
    busy: list[str] = []
    while not busy and time.monotonic() < deadline:
        busy = [address for address, keys in client.processing().items() if keys]
    assert busy and not answered, "the worker is to be killed in the middle"
    os.kill(before[busy[0]], signal.SIGKILL)
    work.join(120)
    assert not work.is_alive() and plain(answered) == local
    assert before[busy[0]] not in client.run(os.getpid).values()
