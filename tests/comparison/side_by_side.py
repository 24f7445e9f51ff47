"""Both sides of the table, interleaved: least CPU seconds, their ratio, its spread over the rounds.

    python side_by_side.py LINDSTEDT [ROUNDS]

LINDSTEDT is the binary; of every pair ours and theirs run one after the other, ROUNDS times (3). CPU
seconds are those of the whole process, user and system, on all cores; of the FLINT scripts those that
they print, which are without the start of Python.
"""

import re
import resource
import statistics
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).parent

PAIRS = [
    ("Duffing, order 100", "derive duffing --order 100", "duffing_flint.py 100"),
    ("Duffing, order 200", "derive duffing --order 200", "duffing_flint.py 200"),
    ("Duffing, order 400", "derive duffing --order 400", "duffing_flint.py 400"),
    ("van der Pol, order 80", "derive van-der-pol --order 80", "van_der_pol_flint.py 80"),
    ("van der Pol, order 164", "derive van-der-pol --order 164", "van_der_pol_flint.py 164"),
    *(
        (
            f"averaging with a delay, all symbols, order {n}",
            f"derive vibro-impact --order {n}",
            f"averaging_delay_flint.py {n}",
        )
        for n in (4, 6, 8)
    ),
    (
        "the same, 50 orders with 50 digits",
        "derive vibro-impact --order 50 --digits 50 --set A=3/10 --set B=7/10 --set c=1/5 "
        "--set alpha=17/10 --set omega=1 --set k=1 --set P0=1",
        "averaging_delay_arb.py 50",
    ),
]


def ours(binary: str, command: str) -> float:
    """CPU seconds of a run of the binary, printing included."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([binary, *command.split(), "--quiet"], stdout=subprocess.DEVNULL, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def theirs(script: str) -> float:
    """CPU seconds that a script prints."""
    name, order = script.split()
    run = subprocess.run(
        [sys.executable, HERE / name, order], capture_output=True, text=True, check=True
    )
    found = re.search(r"CPU seconds: ([0-9.]+)", run.stdout)
    if found is None:
        raise SystemExit(f"{script} printed no CPU seconds:\n{run.stdout}")
    return float(found.group(1))


def main() -> None:
    binary = sys.argv[1]
    rounds = int(sys.argv[2]) if len(sys.argv) > 2 else 3
    print("| work | FLINT script | here | ratio | its spread |")
    print("|---|---|---|---|---|")
    for name, command, script in PAIRS:
        runs = [(ours(binary, command), theirs(script)) for _ in range(rounds)]
        ratios = [them / us for us, them in runs]
        least = [min(side) for side in zip(*runs)]
        print(
            f"| {name} | {least[1]:.2g} | {least[0]:.2g} | {statistics.median(ratios):.2f} "
            f"| {min(ratios):.2f} to {max(ratios):.2f} |",
            flush=True,
        )


if __name__ == "__main__":
    main()
