"""Limit cycle of van der Pol's oscillator by Maxima's program `lc` (Rand and Armbruster, 1987).

    python van_der_pol_lc.py ORDER [LINDSTEDT.json]

`lc` asks its questions on standard input: the function f of x'' + x + e f(x, x') = 0, the order,
and which of the amplitudes -2, 2 and 0 to take.
"""

import re
import resource
import subprocess
import sys

import report

order, ours = report.arguments()
if order % 2:
    sys.exit("the order must be even: omega is even in e")
orders = range(0, order + 1, 2)
questions = ['load("lc")$', "lc()$", "y*(x^2-1);", f"{order};", "2;"]
questions += [f'printf(true, "omega ~d ~a~%", {k}, coeff(w, e, {k}))$' for k in orders]

version = subprocess.run(["maxima", "--version"], capture_output=True, text=True, check=True)
before = resource.getrusage(resource.RUSAGE_CHILDREN)
answer = subprocess.run(
    ["maxima", "--very-quiet"],
    input="\n".join(questions) + "\n",
    capture_output=True,
    text=True,
    check=True,
).stdout
after = resource.getrusage(resource.RUSAGE_CHILDREN)
seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime

omega = {int(k): value for k, value in re.findall(r"^omega (\d+) (\S+)$", answer, re.MULTILINE)}
if list(omega) != list(orders):
    sys.exit(f"no answer at every order; Maxima said:\n{answer}")
report.known(omega, report.VAN_DER_POL)
report.report(version.stdout.strip(), "frequency", omega, order, ours, seconds)
