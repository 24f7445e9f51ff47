"""A chart of 1000 x 1000 points and a diagram of 400 values with 200 points each on Dask: 4 worker processes of one thread, one
killed in the middle; bit by bit the local arrays? Wall-clock seconds of a local run on one thread, on Dask, and on Dask with one
killed, whether one was, whether the arrays are the same; then what 64 blocks cost in which nothing is to be done.

    RAYON_NUM_THREADS=1 python dask_blocks.py
"""

from __future__ import annotations

import os
import signal
import threading
import time

os.environ.setdefault("RAYON_NUM_THREADS", "1")

import distributed
import lindstedt


def same(one, other) -> bool:
    def plain(found):
        return [v.tobytes() if hasattr(v, "tobytes") else v for v in vars(found).values()]

    return plain(one) == plain(other)


def main() -> None:
    impact, belt = lindstedt.Oscillator.builtin("vibro-impact"), lindstedt.Oscillator.builtin("stick-slip")
    plane = {"A": ("-0.3", "0.3", 1000), "B": ("-0.3", "0.3", 1000)}
    coarse = {name: (low, high, 250) for name, (low, high, _) in plane.items()}
    small = {"A": ("-0.3", "0.3", 2), "B": ("-0.3", "0.3", 64)}
    questions = [
        ("chart 1000 x 1000", impact.stability_chart, plane, {}),
        ("the same with multipliers, 250 x 250", impact.stability_chart, coarse, {"radius": True}),
        ("diagram 400 x 200", belt.bifurcation_diagram, {"gamma": ("0.5", "0.8", 400)}, {"skip": 200, "keep": 200}),
        ("64 blocks of nothing", impact.stability_chart, small, {"predictor": "kbm"}),
    ]
    with distributed.LocalCluster(n_workers=4, threads_per_worker=1, dashboard_address=None) as cluster:
        with distributed.Client(cluster) as client:
            client.run(lambda: lindstedt.problems())
            for name, ask, sweep, options in questions:
                start = time.perf_counter()
                local = ask(sweep, **options)
                alone = time.perf_counter() - start
                spent, all_same, killed = [], True, False
                # Left alone, then with one worker killed; of what costs nothing none is.
                for kill in (False, True)[: 1 + (alone > 1)]:
                    doomed = min(client.run(os.getpid).values())
                    if kill:
                        threading.Timer(alone / 4, os.kill, [doomed, signal.SIGKILL]).start()
                    start = time.perf_counter()
                    there = ask(sweep, executor=client, **options)
                    spent.append(f"{time.perf_counter() - start:.2f} s")
                    killed = doomed not in client.run(os.getpid).values()
                    all_same = all_same and same(local, there)
                    client.wait_for_workers(4)
                print(f"| {name} | {alone:.2f} s | {' | '.join(spent)} | {killed} | {all_same} |", flush=True)


if __name__ == "__main__":
    main()
