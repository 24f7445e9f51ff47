"""What every script here does with its coefficients: check them, compare them, print the last."""

import json
import sys

# Frequencies in the literature, coefficient by coefficient.
DUFFING = {1: "3/8", 2: "-21/256", 3: "81/2048", 4: "-6549/262144"}
VAN_DER_POL = {2: "-1/16", 4: "17/3072", 6: "35/884736", 8: "-678899/5096079360"}


def arguments():
    """The order, and the answer of `lindstedt derive ... --format json` to compare with, if given."""
    if len(sys.argv) not in (2, 3) or not sys.argv[1].isdecimal() or int(sys.argv[1]) == 0:
        sys.exit(f"usage: python {sys.argv[0]} ORDER [LINDSTEDT.json]")
    ours = None
    if len(sys.argv) == 3:
        with open(sys.argv[2], encoding="utf-8") as file:
            ours = json.load(file)
    return int(sys.argv[1]), ours


def known(omega, expected):
    """Stops if a coefficient of the frequency, a map from order to text, is not the known one."""
    for k, value in expected.items():
        if k in omega and omega[k] != value:
            sys.exit(f"omega_{k} is {omega[k]}, not {value}")


def report(versions, series, coefficients, order, ours, seconds):
    """Prints the last coefficient of a series of `lindstedt`, compared with its answer if given."""
    print(versions)
    if ours is not None:
        theirs = [c["exact"] for c in ours["series"][series]]
        for k, value in coefficients.items():
            if k >= len(theirs) or theirs[k] != value:
                sys.exit(f"{series}, order {k}: {value} here, not so in the file")
        print(f"{series}: {len(coefficients)} coefficients as in the file")
    last = coefficients[order]
    if len(last) > 100:
        last = f"{last[:30]} ... {last[-30:]} ({len(last)} characters)"
    print(f"{series}, order {order}: {last}")
    print(f"CPU seconds: {seconds:.4g}")
