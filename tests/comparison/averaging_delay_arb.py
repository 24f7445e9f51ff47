"""The rates of averaging_delay_flint.py at values, in balls of 50 digits, by Arb.

    python averaging_delay_arb.py ORDER [LINDSTEDT.json]

A = 3/10, B = 7/10, c = 1/5, alpha = 17/10 and T = 2 pi, one period of the force, as in

    lindstedt derive vibro-impact --order 50 --digits 50 --set A=3/10 --set B=7/10 --set c=1/5 \\
        --set alpha=17/10 --set omega=1 --set k=1 --set P0=1 --format json
"""

import importlib.metadata
import time

from flint import acb, arb, ctx, fmpq

import report


def expand(order):
    """lambda, order by order: 2 i alpha d_n = G_(n-1) - sum over 0 < j < n of d_j d_(n-j)."""
    a, b, c, alpha = (
        acb(arb(fmpq(*q))) for q in ((3, 10), (7, 10), (1, 5), (17, 10))
    )
    delay = 2 * acb.pi()
    root = [acb(0, alpha.real)]
    shifted = [(-root[0] * delay).exp()]
    for n in range(1, order + 1):
        m = n - 1
        total = (a if m == 0 else 0) - a * shifted[m] + (b - c) * root[m]
        total -= b * sum((root[j] * shifted[m - j] for j in range(n)), acb(0))
        total -= sum((root[j] * root[n - j] for j in range(1, n)), acb(0))
        root.append(total / (2 * root[0]))
        step = sum((j * root[j] * shifted[n - j] for j in range(1, n + 1)), acb(0))
        shifted.append(-delay * step / n)
    return root


def main():
    order, ours = report.arguments()
    ctx.dps = 64
    start = time.process_time()
    roots = expand(order)
    seconds = time.process_time() - start
    print(f"python-flint {importlib.metadata.version('python-flint')}")
    for n, root in enumerate(roots if ours is not None else []):
        for name, part in (("growth_rate", root.real), ("frequency", root.imag)):
            here = ours["series"][name][n]["decimal"]
            if abs(arb(here) - part) > arb("1e-45") * (1 + abs(part)):
                raise SystemExit(f"{name}, order {n}: {part} here, not {here}")
    if ours is not None:
        print(f"rates: {len(roots)} coefficients as in the file")
    print(f"growth_rate, order {order}: {roots[order].real.str(50)}")
    print(f"CPU seconds: {seconds:.4f}")


if __name__ == "__main__":
    main()
