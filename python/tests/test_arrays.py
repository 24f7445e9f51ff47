"""What array calls keep to: limits, Ctrl-C, processes, kinds of numbers."""

from __future__ import annotations

import multiprocessing
import os
import pickle
import signal
import threading
import time
from collections.abc import Callable
from decimal import Decimal
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

import lindstedt
from lindstedt import Oscillator

DUFFING = "x'' + x + eps*x**3 = 0"
CYCLE = "x'' + x = eps*(1 - x**2)*x'"


@pytest.fixture(scope="module")
def duffing() -> Oscillator:
    return Oscillator(DUFFING)


@pytest.fixture(scope="module")
def calls(duffing: Oscillator) -> dict[str, Callable[..., Any]]:
    """One array call of every kind, of as many points as are asked for."""
    omega, x = duffing.frequency_function(order=8), duffing.solution_function(order=8)
    motion = duffing.set(eps="1/2").solution(order=8)
    averaged = Oscillator(CYCLE, eps="1/10").averaged_solution(start="1,0", order=2)
    return {
        "frequency": lambda n, **limits: omega(np.linspace(0, 0.2, n), **limits),
        "solutions": lambda n, **limits: x(np.linspace(0, 9, n), [0.1, 0.2], **limits),
        "solution": lambda n, **limits: motion(np.linspace(0, 9, n), **limits),
        "error": lambda n, **limits: motion.error(np.linspace(0, 9, n), **limits),
        "averaged": lambda n, **limits: averaged(np.linspace(0, 9, n), **limits),
    }


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork")
@pytest.mark.parametrize("name", ["frequency", "solutions", "solution", "error", "averaged"])
def test_a_forked_process_is_refused(calls: dict[str, Callable[..., Any]], name: str) -> None:
    calls[name](4000)

    def child() -> None:
        try:
            calls[name](4000)
        except lindstedt.UsageError as refused:
            os._exit(0 if refused.code == "fork" else 1)
        os._exit(2)

    process = multiprocessing.get_context("fork").Process(target=child)
    process.start()
    process.join(20)
    ended = process.exitcode
    process.kill()
    assert ended == 0


@pytest.mark.parametrize("name", ["frequency", "solutions", "solution", "averaged"])
def test_arrays_have_limits(calls: dict[str, Callable[..., Any]], name: str) -> None:
    calls[name](1000, seconds=60)
    begin = time.perf_counter()
    with pytest.raises(lindstedt.StoppedError) as stopped:
        calls[name](300_000, seconds=0)
    assert time.perf_counter() - begin < 5
    assert stopped.value.code == "interrupted"
    with pytest.raises(lindstedt.UsageError):
        calls[name](10, seconds=-1)
    with pytest.raises(lindstedt.UsageError, match="no option digits"):
        calls[name](10, digits=8)


def test_arrays_keep_to_the_memory(duffing: Oscillator) -> None:
    x = duffing.solution_function(order=8)
    with pytest.raises(lindstedt.UndecidedError) as refused:
        x(np.zeros(100_000), np.full(100, 0.1), memory=1 << 20)
    assert refused.value.code == "too-large" and "raise memory" in refused.value.hint


@pytest.mark.parametrize(("name", "points"), [("frequency", 10_000_000), ("solutions", 3_000_000), ("solution", 10_000_000)])
def test_ctrl_c_stops_arrays(calls: dict[str, Callable[..., Any]], name: str, points: int) -> None:
    calls[name](1000)
    signal.signal(signal.SIGINT, signal.default_int_handler)
    begin = time.perf_counter()
    calls[name](points)
    whole = time.perf_counter() - begin
    # A look at the signals after the call, or between its two parts, comes too late; a busy machine may, too.
    for _ in range(6):
        pressed = threading.Timer(0.05, signal.raise_signal, [signal.SIGINT])
        begin = time.perf_counter()
        pressed.start()
        with pytest.raises(KeyboardInterrupt):
            calls[name](points)
            pressed.join()
        if time.perf_counter() - begin < 0.75 * whole:
            return
    pytest.fail("never before the end of the work")


@pytest.mark.parametrize("verb", ["solution", "solution_function"])
@pytest.mark.parametrize("equation", [DUFFING, "x'' + x + eps*x^2 = 0"])
def test_thousands_of_harmonics_keep_to_the_limits(equation: str, verb: str) -> None:
    case = Oscillator(equation, eps="1/10")
    begin = time.perf_counter()
    with pytest.raises(lindstedt.StoppedError):
        getattr(case, verb)(10_000, order=20, seconds=0.5)
    assert time.perf_counter() - begin < 4
    signal.signal(signal.SIGINT, signal.default_int_handler)
    threading.Timer(0.5, signal.raise_signal, [signal.SIGINT]).start()
    begin = time.perf_counter()
    with pytest.raises(KeyboardInterrupt):
        getattr(case, verb)(10_000, order=20)
    assert time.perf_counter() - begin < 4


def test_harmonics_that_need_too_much_memory_are_refused(duffing: Oscillator) -> None:
    with pytest.raises(lindstedt.UndecidedError, match="phases need") as refused:
        duffing.solution_function(100_000, order=4, seconds=60)
    assert refused.value.code == "too-large" and "harmonics" in refused.value.hint
    for verb in ({"code": "python"}, {"code": "python", "functions": True}):
        with pytest.raises(lindstedt.UsageError, match="too many"):
            duffing.set(eps="1/2").evaluate(harmonics=1_000_000, order=4, seconds=60, **verb)


def test_long_numbers_are_not_rounded(duffing: Oscillator) -> None:
    sympy, mpmath = pytest.importorskip("sympy"), pytest.importorskip("mpmath")
    long = Fraction(10**25 + 1, 3 * 10**25)
    for value in (long, sympy.Rational(long.numerator, long.denominator), f"{long.numerator}/{long.denominator}"):
        assert duffing.set(eps=value).values["eps"] == f"{long.numerator}/{long.denominator}"
    assert duffing.set(eps=sympy.Integer(3)).values["eps"] == "3"
    with mpmath.workdps(50):
        third = mpmath.mpf(1) / 3
    sign, mantissa, exponent, _ = third._mpf_
    exact = Fraction(int(mantissa)) * Fraction(2) ** exponent
    for value in (third, sympy.Float(third, 50)):
        found = Fraction(duffing.set(eps=value).values["eps"])
        assert found == exact and abs(found - Fraction(1, 3)) < Fraction(1, 10**49)
    with mpmath.workdps(50):
        assert Fraction(duffing.set(eps=-third).values["eps"]) == -exact
    # What is a double is what was typed.
    for value in (mpmath.mpf(0.1), sympy.Float(0.1), 0.1):
        assert duffing.set(eps=value).values["eps"] == "1/10"
    assert duffing.set(eps=mpmath.mpf(0)).values["eps"] == "0"
    assert Oscillator.builtin("pendulum", amplitude=sympy.Rational(1, 3) * sympy.pi).values["amplitude"] == "1/3*pi"
    assert duffing.set(eps=10**5000).values["eps"] == "1" + 5000 * "0"
    for wrong in (mpmath.inf, mpmath.nan, mpmath.pi, mpmath.mpf("1e100000000"), sympy.oo, sympy.sqrt(2), mpmath.mpc(1, 2)):
        with pytest.raises(lindstedt.UsageError):
            duffing.set(eps=wrong)


def test_times_are_not_rounded(duffing: Oscillator) -> None:
    third, tenth = Fraction(1, 3), Decimal("1e-30")
    case = duffing.set(eps="1/1000")
    motion, x = case.solution(order=16), duffing.solution_function(order=16)
    truth = [point["x"] for point in case.evaluate(times="1e-30,1/3", order=16)["solution"]["values"]]
    assert motion.at([tenth, third]) == x.at([tenth, "1/3"], "1/1000") == truth
    # The double is another time in the seventeenth digit.
    assert motion.at(third) == motion.at("1/3") == motion.at(np.array([third])) == truth[1:] != motion.at(1 / 3)
    one: Any
    for one in ([0.5], (Fraction(1, 2),), np.array([0.5]), "1/2", 0.5):
        assert len(case.evaluate(times=one, order=8)["solution"]["values"]) == 1
        assert case.simulate(until=1, times=one, digits=8).is_complete
    # Multiples of pi are values of some problems only.
    with pytest.raises(lindstedt.LindstedtError) as refused:
        duffing.frequency_function(order=8).at(0.1, "pi/4")
    assert refused.value.code and refused.value.hint


def test_a_tuple_is_a_range(duffing: Oscillator) -> None:
    swept = duffing.evaluate({"eps": (0, "1/5", 3)}, order=4, digits=8)
    answers = lindstedt.grid(duffing, "evaluate", {"eps": (0, "1/5", 3)}, order=4, digits=8)
    assert [answer.at["eps"] for answer in answers] == ["0", "1/10", "1/5"]
    assert [answer["period"] for answer in answers] == [point["period"] for point in swept["points"]]
    for wrong in ((0.1, 0.2), (0.1, 0.2, 0.3), (0, 1, 2.5), (0.1, 0.2, 0.3, 0.4), ("a", "b", "c")):
        for ask in (duffing.evaluate, lambda axes: lindstedt.grid(duffing, "evaluate", axes)):
            with pytest.raises(lindstedt.UsageError):
                ask({"eps": wrong})


def test_results_of_arrays_are_compared() -> None:
    impact, belt = Oscillator.builtin("vibro-impact"), Oscillator.builtin("stick-slip")
    for ask, one, other in (
        (impact.stability_chart, {"A": (-0.3, 0.3, 5), "B": (-0.3, 0.3, 4)}, {"A": (-0.3, 0.3, 5), "B": (-0.3, 0.2, 4)}),
        (belt.threshold_surface, {"vstar": (0, 1, 3)}, {"vstar": (0, 2, 3)}),
    ):
        made = ask(one)
        assert made == ask(one) and made == pickle.loads(pickle.dumps(made)) and made != ask(other) and made != 1
    chart = impact.stability_chart({"A": [0.1, 2], "B": [0.1]}, radius=True)
    assert chart == impact.stability_chart({"A": [0.1, 2], "B": [0.1]}, radius=True)
    assert chart != impact.stability_chart({"A": [0.1, 2], "B": [0.1]})
    short = {"skip": 2, "keep": 2}
    diagram = belt.bifurcation_diagram("gamma=0.5..0.6:2", **short)
    assert diagram == belt.bifurcation_diagram("gamma=0.5..0.6:2", **short) != chart


def test_fractions_and_decimals_are_numbers_of_arrays(duffing: Oscillator) -> None:
    # What the types say, too: mypy reads this.
    omega, x = duffing.frequency_function(order=8), duffing.solution_function(order=8)
    assert omega(Fraction(1, 10)) == omega(Decimal("0.1")) == omega([Fraction(1, 10)])[0] == omega(0.1)
    mixed: list[float | Fraction | Decimal] = [Decimal(0), Fraction(1, 10), 0.2]
    assert omega(mixed, Decimal(2)).shape == x(mixed, Fraction(1, 10)).shape == (3,)
    motion = duffing.set(eps="1/2").solution(order=8)
    assert motion(Fraction(1, 2)) == motion(0.5) and motion.error([Decimal("0.5")]).shape == (1,)
    assert motion.at(Fraction(1, 2)) == motion.at([Decimal("0.5")])


def _averaged() -> lindstedt.AveragedSolution:
    return Oscillator(CYCLE, eps="1/10").averaged_solution(start="1,0", order=2)


HUGE = 10**400
WRONG: list[Callable[[Oscillator], Any]] = [
    lambda case: case.frequency_function(order=4)(np.array([1 + 1j])),
    lambda case: case.frequency_function(order=4)(np.complex128(1 + 1j)),
    lambda case: case.frequency_function(order=4)(0.1, np.array([1 + 0j])),
    lambda case: case.frequency_function(order=4)([HUGE]),
    lambda case: case.frequency_function(order=4)([None]),  # type: ignore[arg-type]
    lambda case: case.frequency_function(order=4)(np.datetime64("2020-01-01")),
    lambda case: case.frequency_function(order=4)([[0.1, 0.2], [0.3]]),
    lambda case: case.frequency_function(order=4).at_each(0.1),  # type: ignore[arg-type]
    lambda case: case.solution_function(order=4)([[0, 1], [2]], 0.1),
    lambda case: case.solution_function(order=4).at([None], 0.1),
    lambda case: case.set(eps=0.1).solution(order=4)(np.array([1j])),
    lambda case: case.set(eps=0.1).solution(order=4).at("next week"),
    lambda case: _averaged()(np.array([1j])),
    lambda case: _averaged()([object()]),  # type: ignore[arg-type]
    lambda case: _averaged().at([Fraction(1, 3), "soon"]),
    lambda case: case.set(eps=np.array([1j])),
    lambda case: case.set(eps="\ud800"),
    lambda case: Oscillator("x'' + x\ud800"),
    lambda case: Oscillator.file(3),  # type: ignore[arg-type]
    lambda case: Oscillator.file("a\0b"),
    lambda case: case.under(3),  # type: ignore[arg-type]
    lambda case: case.derive(10**5000),
    lambda case: case.derive(2, digits=HUGE),
    lambda case: case.derive(2, memory=HUGE),
    lambda case: case.derive(2, seconds=-HUGE),
    lambda case: case.derive(2, doubles="yes"),
    lambda case: case.derive(2).page(["text"]),  # type: ignore[arg-type]
    lambda case: case.evaluate(3),  # type: ignore[arg-type]
    lambda case: case.evaluate([1, 2]),  # type: ignore[list-item]
    lambda case: case.evaluate({"eps": (0, 1, "many")}),
    lambda case: case.set(eps=0.1).evaluate(times=[[1, 2], [None]]),
    lambda case: case.set(eps=0.1).evaluate(times=[]),
    lambda case: case.set(eps=0.1).simulate(until=1, state=[[1, 2], [3]]),
    lambda case: lindstedt.grid(3, "evaluate", {"eps": [0.1]}),  # type: ignore[arg-type]
    lambda case: lindstedt.grid(case, ["evaluate"], {"eps": [0.1]}),  # type: ignore[arg-type]
    lambda case: lindstedt.grid(case, "evaluate", ["eps"]),  # type: ignore[arg-type]
    lambda case: lindstedt.grid(case, "evaluate", {1: [0.1]}),  # type: ignore[dict-item]
    lambda case: lindstedt.grid(case, "evaluate", {"eps": [0.1]}, block=2.5),  # type: ignore[arg-type]
]


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("ask", WRONG)
def test_wrong_input_of_any_kind_is_a_usage_error(duffing: Oscillator, ask: Callable[[Oscillator], Any]) -> None:
    with pytest.raises(lindstedt.LindstedtError) as refused:
        ask(duffing)
    assert isinstance(refused.value, ValueError) and refused.value.code


def test_times_have_any_order_and_unknown_numbers_are_none(duffing: Oscillator) -> None:
    x = duffing.set(eps="1/2").solution()
    late, early, again = x.at([2, "1/2", 2.0], digits=12)
    assert late == again and late is not None and early is not None
    assert abs(float(early) - float(x(0.5))) < 1e-11 and abs(float(late) - float(x(2.0))) < 1e-11
    assert x.at("1e60", digits=12) == [None]
    # A binary number of more bits than a double is what it is.
    third = np.longdouble(1) / 3
    assert lindstedt._numbers.exact(third) == f"{Fraction(*third.as_integer_ratio())}"


def test_the_frequency_alone(duffing: Oscillator) -> None:
    alone = duffing.derive(30, only="frequency").frequency.fractions
    assert alone[:9] == duffing.derive(8).frequency.fractions and len(alone) == 31
    with pytest.raises(lindstedt.UsageError):
        duffing.derive(4, only="frequency", route="driver")
