"""A grid on Dask: several worker processes, one killed in the middle, and the answers of a local run."""

from __future__ import annotations

import functools
import os
import signal
import threading
import time
from collections import Counter
from pathlib import Path
from typing import Any

import pytest

import lindstedt
from lindstedt import Oscillator
from lindstedt._oscillator import _on_dask

distributed = pytest.importorskip("distributed")


def _counted(folder: str, part: int) -> int:
    Path(folder, f"{part}-{os.getpid()}-{time.time_ns()}").touch()
    time.sleep(0.2)
    return part * part


def test_finished_parts_survive_their_worker(tmp_path: Path) -> None:
    work = functools.partial(_counted, str(tmp_path))
    with (
        distributed.LocalCluster(n_workers=4, threads_per_worker=1, dashboard_address=None) as cluster,
        distributed.Client(cluster) as client,
    ):
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


def test_a_killed_worker_loses_nothing() -> None:
    cycle = Oscillator("x'' + x = eps*(1 - x**2)*x'")
    values: dict[str, list[lindstedt.Value]] = {"eps": [f"{n}/20" for n in range(1, 17)]}

    def plain(answers: list[Any]) -> list[dict[str, Any]]:
        return [{k: v for k, v in answer.to_dict().items() if k != "seconds"} for answer in answers]

    local = plain(lindstedt.grid(cycle, "evaluate", values, digits=8))
    with (
        distributed.LocalCluster(n_workers=4, threads_per_worker=1, dashboard_address=None) as cluster,
        distributed.Client(cluster) as client,
    ):
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
