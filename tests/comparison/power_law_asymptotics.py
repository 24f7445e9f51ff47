"""The paper's x'' + x (x^2)^d = 0 by the package `asymptotics`: is what it calls a frequency one?

    python power_law_asymptotics.py
"""

import importlib.metadata
import sys
import warnings

import sympy
from asymptotics import ODE

with warnings.catch_warnings(record=True) as caught:
    warnings.simplefilter("always")
    omega = (
        ODE(
            "u'' + u*(u**2)**d",
            small_param="d",
            conditions=["u(0) = 1", "u'(0) = 0"],
        )
        .expand_lindstedt(order=1)
        .omega_expansion
    )

print(f"asymptotics {importlib.metadata.version('asymptotics')}, sympy {sympy.__version__}")
print(f"omega = {omega}")
time = {symbol for symbol in omega.free_symbols if symbol.name == "tau"}
print(f"depends on the time: {'yes' if time else 'no'}; warnings: {len(caught)}")
