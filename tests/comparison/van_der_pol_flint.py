"""Limit cycle of van der Pol's oscillator x'' + x = eps (1 - x^2) x' with FLINT's polynomials.

    python van_der_pol_flint.py ORDER [LINDSTEDT.json]

Lindstedt-Poincare, written for this equation alone. In tau = omega t, with eta = eps/omega and
L = 1/omega^2,

    x'' + L x = eta (x - x^3/3)'

and x and L are series in eta; omega as a series in eps is a reversion at the end. Even orders of x
are c p(c^2), odd orders s p(c^2), where c = cos(tau), s = sin(tau): p has half as many coefficients
as there are exponentials. An order is one integer polynomial over one denominator. The phase is
the one without a term s in odd orders: the frequency does not depend on it.
"""

import importlib.metadata
import math
import sys
import time

from flint import ctx, fmpq, fmpq_series, fmpz, fmpz_poly

import report

U = fmpz_poly([0, 1])  # c^2
V = fmpz_poly([1, -1])  # s^2


def reduced(p, d):
    g = p.content().gcd(d)
    return (p, d) if g == 1 else (p // g, d // g)


def product(a, b):
    return (a[0] * b[0], a[1] * b[1])


def total(terms):
    """The sum of numerator/denominator pairs, small denominators first: short factors."""
    p, d = fmpz_poly(), fmpz(1)
    for q, e in sorted(terms, key=lambda term: term[1].bit_length()):
        g = d.gcd(e)
        grow, fit = e // g, d // g
        if grow != 1:
            p *= grow
            d *= grow
        p += q if fit == 1 else q * fit
    return reduced(p, d)


def times(a, p):
    return (a[0] * p, a[1])


def square_of_order(x, m):
    """(x^2)_m without its factor c s for odd m."""
    pairs = [(i, m - i) for i in range(m // 2 + 1)]
    terms = [times(product(x[i], x[j]), 1 if i == j else 2) for i, j in pairs]
    if m % 2:
        return total(terms)
    return total([times(total(terms[::2]), U), times(total(terms[1::2]), V)])


def cube_of_order(x, square, m):
    """(x^3)_m without its factor c, or s for odd m."""
    terms = [product(x[i], square[m - i]) for i in range(m + 1)]
    even, odd = total(terms[::2]), total(terms[1::2])
    return total([times(even, U), odd] if m % 2 else [even, times(odd, V)])


def derivative(p, parity):
    """d/dtau of c p(c^2), s times the result; for `parity` 1 of s p(c^2), c times the result."""
    a = [*p.coeffs(), 0]
    if parity == 0:
        return fmpz_poly([-(2 * j + 1) * a[j] for j in range(len(a) - 1)])
    return fmpz_poly([(2 * j + 1) * a[j] - (2 * j + 2) * a[j + 1] for j in range(len(a) - 1)])


def solve(r, parity):
    """y'' + y = r but for its first harmonic: the coefficients of y from c^3 or s c^2 upwards.

    Returns them as numerators, with their denominator; the first, that of c or s, is 0.
    """
    n = r.degree() + 1
    shift = 1 - parity
    values, scale = [fmpz(0)] * max(n, 2), fmpz(1)
    scales = [scale] * len(values)
    above = fmpz(0)
    for j in range(n - 1, 0, -1):
        # (1 - (2j+1)^2) y_j + (2j+2)(2j+1) y_(j+1) = r_j; of a cosine (2j+3)(2j+2) y_(j+1)
        value = (2 * j + 2 + shift) * (2 * j + 1 + shift) * above - r[j] * scale
        divisor = 4 * j * (j + 1)
        grow = divisor // math.gcd(divisor, int(value % divisor))
        scale *= grow
        above = value * grow // divisor
        values[j], scales[j] = above, scale
    return [value * (scale // s) for value, s in zip(values, scales)], scale


def expand(order):
    """The coefficients of L in eta."""
    x = [(fmpz_poly([2]), fmpz(1))]
    square = []
    lam = {0: fmpq(1)}
    for k in range(1, order + 1):
        m, parity = k - 1, k % 2
        square.append(square_of_order(x, m))
        cube = cube_of_order(x, square, m)
        force = total([x[m], (-cube[0], 3 * cube[1])])
        right, d = total(
            [(derivative(force[0], m % 2), force[1])]
            + [(x[k - j][0] * -lam[j].p, x[k - j][1] * lam[j].q) for j in range(2, k, 2)]
        )
        y, scale = solve(right, parity)
        d *= scale
        if parity == 0:
            # No secular term: 6 y_1 = r_0 - L_k x_0.
            lam[k] = fmpq(right[0] * scale - 6 * y[1], 2 * d)
            x.append(reduced(fmpz_poly(y), d))
        else:
            # No secular term: 2 y_1 = r_0, where x_m has a c to choose. It adds a s (12 c^2 - 1)
            # to the force, -3/2 a to y_1, and so a = y_1 - r_0/2.
            a = fmpq(2 * y[1] - right[0] * scale, 2 * d)
            x[m] = total([x[m], (fmpz_poly([a.p]), a.q)])
            square[m] = total([square[m], (4 * a.p * U, a.q)])
            x.append(total([(fmpz_poly(y), d), (-3 * a.p * U, 2 * a.q)]))
    return lam


def frequency(lam, order):
    """omega as a series in eps^2, from eps^2 = eta^2/L(eta^2) and omega^2 = 1/L(eta^2)."""
    half = order // 2
    ctx.cap = half + 2  # FLINT's limit of the length of series
    series = fmpq_series([lam[2 * j] for j in range(half + 1)], prec=half + 1)
    eta_squared = (fmpq_series([0, 1], prec=half + 2) / series).reversion()
    return (1 / series.sqrt())(eta_squared)


order, ours = report.arguments()
if order % 2:
    sys.exit("the order must be even: omega is even in eps")
start = time.process_time()
omega = frequency(expand(order), order)
seconds = time.process_time() - start

omega = {2 * j: str(omega[j]) for j in range(order // 2 + 1)}
report.known(omega, report.VAN_DER_POL)
report.report(
    f"python-flint {importlib.metadata.version('python-flint')}",
    "frequency",
    omega,
    order,
    ours,
    seconds,
)
