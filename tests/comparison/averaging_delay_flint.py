"""Averaging with a delay, x'' + alpha^2 x = eps (A (x - x(t - T)) + B (x' - x'(t - T)) - c x'), by FLINT's polynomials.

    python averaging_delay_flint.py ORDER [LINDSTEDT.json]

The equation is linear: a'/a + i psi' is its characteristic root lambda = i alpha + d, d = O(eps), of
lambda^2 + alpha^2 = eps G(lambda), G = (A + B lambda)(1 - e^(-lambda T)) - c lambda, to all orders in eps:

    2 i alpha d_n = G_(n-1) - sum over 0 < j < n of d_j d_(n-j).

All symbols stay. In the time alpha t, A/alpha^2, B/alpha, c/alpha and alpha T take the places of A, B, c and T; coefficients
are polynomials over Q in these and E = e^(-i alpha T), real and imaginary part each. With a file the growth rate and
the frequency are compared at values, to 1e-9.
"""

import importlib.metadata
import math
import re
import time

from flint import fmpq_mpoly_ctx

import report

RING = fmpq_mpoly_ctx.get(["A", "B", "c", "T", "E"], "degrevlex")
A, B, C, T, E = RING.gens()
ZERO, ONE = RING.constant(0), RING.constant(1)


def times(f, g):
    """The product of two complex polynomials, E a symbol."""
    return f[0] * g[0] - f[1] * g[1], f[0] * g[1] + f[1] * g[0]


def plus(f, g):
    return f[0] + g[0], f[1] + g[1]


def scaled(f, factor):
    return f[0] * factor, f[1] * factor


def expand(order):
    """lambda/alpha, order by order."""
    root = [(ZERO, ONE)]
    shifted = [(E, ZERO)]  # e^(-lambda T), with E = e^(-i T)
    for n in range(1, order + 1):
        m = n - 1
        total = (ZERO, ZERO)
        for j in range(n):
            total = plus(total, scaled(times(root[j], shifted[m - j]), -B))
        total = plus(total, scaled(shifted[m], -A))
        total = plus(total, scaled(root[m], B - C))
        if m == 0:
            total = plus(total, (A, ZERO))
        for j in range(1, n):
            total = plus(total, scaled(times(root[j], root[n - j]), -1))
        # Divided by 2 i.
        root.append((total[1] / 2, -total[0] / 2))
        step = (ZERO, ZERO)
        for j in range(1, n + 1):
            step = plus(step, scaled(times(root[j], shifted[n - j]), -j * T))
        shifted.append(scaled(step, ONE / n))
    return root


def value(root, at):
    """lambda_n at values of A, B, c, T, alpha."""
    turn = complex(math.cos(at["alpha"] * at["T"]), -math.sin(at["alpha"] * at["T"]))
    alpha = at["alpha"]
    point = [at["A"] / alpha**2, at["B"] / alpha, at["c"] / alpha, alpha * at["T"], turn]
    parts = [
        sum(
            int(q.p) / int(q.q) * math.prod(x ** int(k) for x, k in zip(point, powers))
            for powers, q in part.to_dict().items()
        )
        for part in root
    ]
    return alpha * (parts[0] + 1j * parts[1])


def main():
    order, ours = report.arguments()
    start = time.process_time()
    roots = expand(order)
    seconds = time.process_time() - start
    print(f"python-flint {importlib.metadata.version('python-flint')}")
    if ours is not None:
        at = {"A": 0.3, "B": 0.7, "c": 0.2, "T": 1.3, "alpha": 1.7, "sin": math.sin, "cos": math.cos}
        for n, root in enumerate(roots):
            pair = [ours["series"][name][n]["exact"] for name in ("growth_rate", "frequency")]
            here = [eval(re.sub(r"\^", "**", text), {}, at) for text in pair]
            if abs(value(root, at) - complex(*here)) > 1e-9:
                raise SystemExit(f"order {n}: {value(root, at)} here, not {complex(*here)}")
        print(f"rates: {len(roots)} coefficients as in the file")
    print(f"terms at order {order}: {sum(len(part.to_dict()) for part in roots[order])}")
    print(f"CPU seconds: {seconds:.4f}")


if __name__ == "__main__":
    main()
