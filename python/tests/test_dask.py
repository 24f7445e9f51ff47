"""A grid on Dask: several worker processes, one killed in the middle, and the answers of a local run."""

from __future__ import annotations

import os
import signal
import threading
import time
from typing import Any

import pytest

import lindstedt
from lindstedt import Oscillator

distributed = pytest.importorskip("distributed")


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
