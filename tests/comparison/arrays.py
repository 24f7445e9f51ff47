"""x(t) and omega in arrays: the Python package, NumPy with the printed polynomials, heyoka's integration; interleaved.

CPU seconds of one thread, the least of ROUNDS; errors against elliptic integrals and functions (SciPy), of van der Pol's
frequency against `evaluate` with 20 digits.

    python arrays.py [ROUNDS]
"""

from __future__ import annotations

import os
import sys
import time

os.environ.setdefault("RAYON_NUM_THREADS", "1")
os.environ.setdefault("OMP_NUM_THREADS", "1")

import heyoka
import numpy as np
from scipy.special import ellipj, ellipk

import lindstedt

ROUNDS = int(sys.argv[1]) if len(sys.argv) > 1 else 3
TIMES, POINTS = 1_000_000, 100_000
ORDER = 12
# heyoka takes one oscillator at a time: so many are measured, and the time is that of all.
SOME = 1000


def seconds(work):
    start = time.process_time()
    found = work()
    return time.process_time() - start, found


def program(case, order):
    """The printed program of the expansion."""
    space = {}
    exec(case.evaluate(code="python", functions=True, order=order, harmonics=15).code, space)
    return space


def duffing_motion(t, eps):
    k2 = eps / (2 + 2 * eps)
    return ellipj(np.sqrt(1 + eps) * t, k2)[1]


def duffing_frequency(eps):
    return np.pi / 2 * np.sqrt(1 + eps) / ellipk(eps / (2 + 2 * eps))


def duffing_system():
    x, v = heyoka.make_vars("x", "v")
    return [(x, v), (v, -x - heyoka.par[0] * x**3)]


def van_der_pol_system():
    x, v = heyoka.make_vars("x", "v")
    return [(x, v), (v, -x + heyoka.par[0] * (1 - x**2) * v)]


def integrated_frequencies(system, starts, values):
    """omega by the time of one turn from a maximum of x to the next, the event v = 0 downwards."""
    x, v = heyoka.make_vars("x", "v")
    found = []
    crossed = heyoka.nt_event(v, lambda ta, t, d: found.append(t), direction=heyoka.event_direction.negative)
    ta = heyoka.taylor_adaptive(system, [2.0, 0.0], pars=[0.0], nt_events=[crossed])

    def all_of_them():
        omegas = np.empty(len(values))
        for i, (start, value) in enumerate(zip(starts, values)):
            ta.time, ta.state[:], ta.pars[0] = 0.0, start, value
            found.clear()
            ta.propagate_for(8.0)
            # From the start, which is a maximum.
            omegas[i] = 2 * np.pi / next(t for t in found if t > 1)
        return omegas

    return all_of_them


def main() -> None:
    eps = 0.1
    duffing = lindstedt.Oscillator("x'' + x + eps*x**3 = 0", eps="1/10", amplitude=1)
    cycle = lindstedt.Oscillator("x'' + x = eps*(1 - x**2)*x'")
    made = [duffing.solution, duffing.frequency_function, cycle.frequency_function]
    once, (x, omega_d, omega_v) = zip(*(seconds(make) for make in made))
    print_d, print_v = program(duffing, ORDER), program(cycle, ORDER)
    t = np.linspace(0, 1000, TIMES)
    many_d, many_v = np.linspace(0, 0.2, POINTS), np.linspace(0.01, 1, POINTS)
    some_d, some_v = many_d[:: POINTS // SOME], many_v[:: POINTS // SOME]
    motion = heyoka.taylor_adaptive(duffing_system(), [1.0, 0.0], pars=[eps])
    # On the cycle: x(0) is the amplitude of the expansion, x'(0) = 0.
    amplitude = cycle.solution_function(order=40)
    on_cycle = [(float(amplitude(0.0, e)), 0.0) for e in some_v]
    turns_d = integrated_frequencies(duffing_system(), [(1.0, 0.0)] * len(some_d), some_d)
    turns_v = integrated_frequencies(van_der_pol_system(), on_cycle, some_v)

    def grid():
        motion.time, motion.state[:] = 0.0, [1.0, 0.0]
        return motion.propagate_grid(t)[5][:, 0]

    few = [0, SOME // 2, SOME - 1]
    places = [n * (POINTS // SOME) for n in few]
    true_v = [float(cycle.set(eps=e).evaluate(digits=20).frequency) for e in some_v[few]]
    truth_x, truth_d = duffing_motion(t, eps), duffing_frequency(many_d)
    rows = [
        ("x(t), 10^6 times, Duffing eps = 0.1", "lindstedt, 15 harmonics", lambda: x(t), 1, lambda y: abs(y - truth_x).max()),
        ("", f"NumPy, printed, order {ORDER}", lambda: print_d["displacement"](t, eps, 1.0), 1, lambda y: abs(y - truth_x).max()),
        ("", "heyoka, propagate_grid", grid, 1, lambda y: abs(y - truth_x).max()),
        ("omega, 10^5 eps, Duffing 0..0.2", "lindstedt", lambda: omega_d(many_d), 1, lambda y: abs(y - truth_d).max()),
        ("", f"NumPy, printed, order {ORDER}", lambda: print_d["frequency"](many_d, 1.0), 1, lambda y: abs(y - truth_d).max()),
        ("", "heyoka, a turn each", turns_d, POINTS / len(some_d), lambda y: abs(y - duffing_frequency(some_d)).max()),
        ("omega, 10^5 eps, van der Pol 0.01..1", "lindstedt", lambda: omega_v(many_v), 1, lambda y: abs(y[places] - true_v).max()),
        ("", f"NumPy, printed, order {ORDER}", lambda: print_v["frequency"](many_v), 1, lambda y: abs(y[places] - true_v).max()),
        ("", "heyoka, a turn each", turns_v, POINTS / len(some_v), lambda y: abs(y[few] - true_v).max()),
    ]
    least = [float("inf")] * len(rows)
    errors = [0.0] * len(rows)
    for _ in range(ROUNDS):
        for place, (_, _, work, factor, error) in enumerate(rows):
            spent, found = seconds(work)
            least[place], errors[place] = min(least[place], spent * factor), error(found)
    print(f"lindstedt {lindstedt.__version__}, NumPy {np.__version__}, heyoka {heyoka.__version__}, least of {ROUNDS}")
    print("derived once: " + ", ".join(f"{spent:.2f} s" for spent in once))
    for place, ((what, how, *_), spent, error) in enumerate(zip(rows, least, errors)):
        one = 1e9 * spent / (TIMES if place < 3 else POINTS)
        print(f"| {what} | {how} | {spent:.3f} s | {one:.0f} ns | {error:.0e} |")


if __name__ == "__main__":
    main()
