"""Duffing's oscillator by the package `asymptotics`, used as its own documentation does.

    python duffing_asymptotics.py ORDER [LINDSTEDT.json]
"""

import importlib.metadata
import time

import sympy
from asymptotics import ODE

import report

order, ours = report.arguments()
start = time.process_time()
equation = ODE(
    "u'' + u + eps*u**3",
    small_param="eps",
    conditions=["u(0) = 1", "u'(0) = 0"],
)
solution = equation.expand_lindstedt(order=order)
seconds = time.process_time() - start

omega = sympy.expand(solution.omega_expansion)
[eps] = omega.free_symbols
omega = {k: str(omega.coeff(eps, k)) for k in range(order + 1)}
report.known(omega, report.DUFFING)
report.report(
    f"asymptotics {importlib.metadata.version('asymptotics')}, sympy {sympy.__version__}",
    "frequency",
    omega,
    order,
    ours,
    seconds,
)
