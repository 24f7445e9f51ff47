"""Duffing's oscillator x'' + x + rho x^3 = 0, x(0) = 1, x'(0) = 0, with FLINT's polynomials.

    python duffing_flint.py ORDER [LINDSTEDT.json]

Lindstedt-Poincare in the squared frequency: W x'' + x + rho x^3 = 0 in tau = omega t, and W and x
are series in rho. x_k is cos(tau) p_k(cos(tau)^2), p_k a polynomial of degree k. The whole of
order k is kept over one denominator, 32^k: with rho = 32 r all coefficients are integers, and
every division is checked to leave no remainder.
"""

import importlib.metadata
import sys
import time

from flint import fmpq, fmpq_series, fmpz, fmpz_poly

import report

SCALE = 32


def minus_second_derivative(p):
    """-d^2/dtau^2 of c p(c^2), where (c^n)'' = -n^2 c^n + n(n-1) c^(n-2)."""
    a = [*p.coeffs(), 0]
    return fmpz_poly(
        [(2 * j + 1) ** 2 * a[j] - (2 * j + 3) * (2 * j + 2) * a[j + 1] for j in range(len(a) - 1)]
    )


def expand(order):
    """The coefficients of W in r = rho/32, integers."""
    x = [fmpz_poly([1])]
    bent = [minus_second_derivative(x[0])]
    square = []  # of x, without its factor c^2
    w = [fmpz(1)]
    for k in range(1, order + 1):
        m = k - 1
        total = fmpz_poly()
        for i in range((m + 1) // 2):
            total += x[i] * x[m - i]
        total *= 2
        if m % 2 == 0:
            total += x[m // 2] ** 2
        square.append(total)
        cube = fmpz_poly()
        for i in range(k):
            cube += x[i] * square[m - i]

        # x_k'' + x_k = right side + w_k c, the right side without what has w_k.
        right = -SCALE * cube * fmpz_poly([0, 1])
        for j in range(1, k):
            right += w[j] * bent[k - j]
        a = [fmpz(0)] * (k + 2)
        for j in range(k, 0, -1):
            a[j], remainder = divmod(
                right[j] - (2 * j + 3) * (2 * j + 2) * a[j + 1], 1 - (2 * j + 1) ** 2
            )
            if remainder != 0:
                sys.exit(f"order {k} has another denominator than {SCALE}^{k}")
        w.append(6 * a[1] - right[0])  # no secular term: 6 a_1 = right side's c^1 + w_k
        a[0] = -sum(a, fmpz(0))  # x_k(0) = 0
        x.append(fmpz_poly(a))
        bent.append(minus_second_derivative(x[k]))
    return w


order, ours = report.arguments()
start = time.process_time()
w = [fmpq(value, fmpz(SCALE) ** k) for k, value in enumerate(expand(order))]
seconds = time.process_time() - start

omega = fmpq_series(w[:5], prec=min(order, 4) + 1).sqrt()
report.known({k: str(omega[k]) for k in range(min(order, 4) + 1)}, report.DUFFING)
report.report(
    f"python-flint {importlib.metadata.version('python-flint')}",
    "frequency_squared",
    {k: str(value) for k, value in enumerate(w)},
    order,
    ours,
    seconds,
)
