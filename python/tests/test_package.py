"""The package as its users meet it; reference numbers are closed forms."""

from __future__ import annotations

import ast
import dataclasses
import io
import math
import multiprocessing
import pickle
import signal
import threading
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import lindstedt
from lindstedt import Number, Oscillator, Series

DUFFING = "x'' + x + eps*x**3 = 0"


@pytest.fixture(scope="module")
def duffing() -> Oscillator:
    return Oscillator(DUFFING)


def test_a_derivation(duffing: Oscillator) -> None:
    answer = duffing.derive(6)
    # Nayfeh and Mook (1979), to order 2.
    assert answer.frequency.fractions[:3] == [1, Fraction(3, 8), Fraction(-21, 256)]
    assert answer.is_complete and answer.order == 6 and answer.residual["zero"]
    assert answer["solution"][0] == "cos(tau)"
    assert answer.to_dict()["series"]["frequency"][1]["exact"] == "3/8"
    latex = answer._repr_latex_()
    assert latex is not None and r"\omega &= 1 + \frac{3}{8}\varepsilon-\frac{21}{256}\varepsilon^{2}" in latex
    assert "<math" in answer._repr_html_() and "omega" in str(answer)
    assert duffing == Oscillator("x'' + x + eps*x^3 = 0")


def test_values_are_what_was_typed(duffing: Oscillator) -> None:
    values: list[lindstedt.Value] = [0.1, "0.1", "1/10", Fraction(1, 10), Decimal("0.1"), np.float64(0.1)]
    for value in values:
        assert duffing.set(eps=value).values["eps"] == "1/10"
    sympy = pytest.importorskip("sympy")
    assert duffing.set(eps=sympy.Rational(1, 10)).values["eps"] == "1/10"
    assert Oscillator.builtin("pendulum", amplitude=sympy.pi / 4).values["amplitude"] == "1/4*pi"
    # The shortest decimal of a single precision number, and what a function of arrays returns.
    assert duffing.set(eps=np.float32(0.1)).values["eps"] == duffing.set(eps=np.array(0.1)).values["eps"] == "1/10"
    for wrong in (True, math.nan, object(), np.array([0.1])):
        with pytest.raises(lindstedt.UsageError):
            duffing.set(eps=wrong)


def test_refusals_are_exceptions() -> None:
    with pytest.raises(lindstedt.UsageError) as usage:
        Oscillator.builtin("pendulun")
    assert usage.value.code == "unknown-problem" and "pendulum" in usage.value.hint
    with pytest.raises(lindstedt.NoAnswerError) as refused:
        Oscillator("x'' + k*x + eps*x' = 0").derive(2)
    assert refused.value.code == "no-method"
    again = pickle.loads(pickle.dumps(refused.value))
    assert (again.code, again.hint) == (refused.value.code, refused.value.hint)
    with pytest.raises(lindstedt.UsageError):
        Oscillator(DUFFING).derive(2, rder=3)
    # Hints are in the words of the package.
    with pytest.raises(lindstedt.UsageError) as unset:
        Oscillator(DUFFING).evaluate()
    assert "set(NAME=VALUE)" in unset.value.hint and "--" not in unset.value.hint
    with pytest.raises(lindstedt.UsageError) as given:
        Oscillator(DUFFING).evaluate(eps=0.5)
    assert given.value.hint == "set(eps=...) before"
    with pytest.raises(lindstedt.UsageError) as shown:
        Oscillator("x'' + x + ) = 0")
    assert shown.value.hint == "for example x'' + x + eps*x^3 = 0"
    assert "equation" in Oscillator.builtin("duffing").describe()["file"]


@pytest.mark.parametrize(
    ("theirs", "ours"),
    [
        ("--set NAME=VALUE, for example 1/10", "set(NAME=VALUE), for example 1/10"),
        ("--set k=1/2; --normalisation free keeps it", 'set(k=1/2); under("free") keeps it'),
        ("lower --order or raise --limit-memory", "lower order or raise memory"),
        ("--digits 30", "digits=30"),
        ("--state 1,-1/2", 'state="1,-1/2"'),
        ("`lindstedt evaluate --cycles AMPLITUDE` averages", "`evaluate cycles=AMPLITUDE` averages"),
        ("--start \"1\" is not two values", 'start="1" is not two values'),
        ("`lindstedt VERB --help` lists the options", "`help(Oscillator)` lists the options"),
        ("see `lindstedt problems --show NAME`", "see `describe()`"),
        ("more --digits, or values", "more digits, or values"),
        ("--sweep shows where", "sweep shows where"),
    ],
)
def test_hints_are_in_the_words_of_the_package(theirs: str, ours: str) -> None:
    assert lindstedt._errors._as_python(theirs) == ours


WRONG: list[tuple[str, Any]] = [
    ("no text", lambda case: Oscillator(None)),  # type: ignore[arg-type]
    ("no list", lambda case: case.evaluate({"eps": 0.5})),
    ("no list", lambda case: lindstedt.grid(case, "evaluate", {"eps": 0.5})),  # type: ignore[dict-item]
    ("no question", lambda case: lindstedt.grid(case, "evaluated", {"eps": [0.5]})),
    ("no executor", lambda case: lindstedt.grid(case, "evaluate", {"eps": [0.5]}, executor=3)),
    ("holds nothing", lambda case: lindstedt.grid(case, "evaluate", {"eps": [0.5]}, block=0)),
    ("out of range", lambda case: case.derive(2, digits=0)),
    ("out of range", lambda case: case.derive(2, digits=1_000_000)),
    ("out of range", lambda case: case.derive(2, digits=20.5)),
    ("out of range", lambda case: case.derive(2, memory=-1)),
    ("no number", lambda case: case.derive(2, digits="20")),
    ("no number", lambda case: case.derive(2, seconds="1")),
    ("not understood", lambda case: case.derive(2.5)),
    ("not understood", lambda case: case.derive(-1)),
    ("no format", lambda case: case.derive(1).page("pdf")),
    ("no array", lambda case: case.frequency_function(order=4)("1/10")),
    ("no array", lambda case: case.frequency_function(order=4)(1j)),
    ("broadcast", lambda case: case.frequency_function(order=4)([0.1, 0.2], [1, 2, 3])),
]


@pytest.mark.parametrize(("message", "ask"), WRONG)
def test_wrong_input_is_refused_with_code_and_hint(duffing: Oscillator, message: str, ask: Any) -> None:
    with pytest.raises(lindstedt.UsageError, match=message) as refused:
        ask(duffing)
    assert refused.value.code and refused.value.hint and "--" not in str(refused.value)


def test_a_value_of_the_small_parameter_is_no_obstacle(duffing: Oscillator) -> None:
    half = duffing.set(eps="1/2")
    answer = half.derive(4)
    assert answer.frequency == duffing.derive(4).frequency and "eps" not in answer.at
    assert answer.remarks == ["no coefficient depends on eps = 1/2"]
    cycle = Oscillator("x'' + x = eps*(1 - x**2)*x'")
    averaged = cycle.set(eps="1/10").average(2)
    assert averaged["series"] == cycle.average(2)["series"] and "eps" in averaged.remarks[-1]
    numeric = half.derive(2, tier="collocation", digits=10)
    assert numeric["series"]["frequency"][:2] == duffing.derive(2, tier="collocation", digits=10)["series"]["frequency"][:2]
    assert "eps" in numeric.remarks[-1]


def test_arrays_without_points(duffing: Oscillator) -> None:
    omega, x = duffing.frequency_function(order=8), duffing.solution_function(order=8)
    assert omega([]).shape == (0,) and omega(np.zeros((0, 3))).shape == (0, 3) and omega(0.1, []).shape == (0,)
    assert x([0, 1], []).shape == (0, 2) and x([], 0.1).shape == (0,) and x.at([], "1/10") == []
    assert len(omega.at_each(np.array([0.1, 0.2]), digits=8)) == 2 and omega.at_each([]) == []
    motion = duffing.set(eps="1/2").solution(order=8)
    assert motion([]).shape == (0,) and motion.at([]) == []
    # Arrays that are not contiguous.
    wide = np.linspace(0, 1, 20)[::2]
    assert np.array_equal(omega(wide), omega(wide.copy())) and np.array_equal(motion(wide), motion(wide.copy()))


def test_where_nothing_is_known_of_a_motion_it_is_no_number(duffing: Oscillator) -> None:
    motion = duffing.set(eps="1/2").solution()
    values, errors = motion([0.0, 1e3, 1e300, math.nan]), motion.error([0.0, 1e3, 1e300, math.nan])
    assert np.isfinite(values[:2]).all() and np.isnan(values[2:]).all()
    assert (errors[:2] < 1e-9).all() and np.isinf(errors[2:]).all()
    # As long as there is a number it is within its error: the same with more digits.
    far = motion.at([1e12])[0]
    assert far is not None
    assert abs(float(far) - motion(1e12)) <= motion.error(1e12) < 1e-2
    assert repr(motion) == "<Solution of <Oscillator x'' + x + eps*x^3 = 0, eps=1/2>>"
    everywhere = duffing.solution_function(order=8)
    assert np.isnan(everywhere([1e300], 0.1)).all() and "over eps, amplitude" in repr(everywhere)


def test_numbers() -> None:
    number = Number("1 - 2*ln(2)", "-0.386294361119890618834464242916", None, "exact")
    assert number.fraction is None and float(number) == pytest.approx(1 - 2 * math.log(2))
    assert str(number) == "1 - 2*ln(2)"
    mpmath = pytest.importorskip("mpmath")
    with mpmath.workdps(30):
        assert abs(number.to_mpmath() - (1 - 2 * mpmath.log(2))) < mpmath.mpf(10) ** -29
    sympy = pytest.importorskip("sympy")
    assert number.to_sympy() == 1 - 2 * sympy.log(2)
    half = Series("eps", [Number("1", "1", None, "exact"), Number("1/2", "0.5", None, "exact")])
    assert half.to_sympy() == 1 + sympy.Symbol("eps") / 2
    assert half.to_numpy().tolist() == [1, 0.5]


def test_frequencies_of_arrays(duffing: Oscillator) -> None:
    omega = duffing.frequency_function()
    rho = np.linspace(0, 3, 1000).reshape(10, 100)
    values, errors = omega.with_error(rho)
    # T = 4 K(k)/sqrt(1 + rho), k^2 = rho/(2 + 2 rho), by the arithmetic-geometric mean.
    a, b = np.ones_like(rho), np.sqrt(1 - rho / (2 + 2 * rho))
    for _ in range(6):
        a, b = (a + b) / 2, np.sqrt(a * b)
    assert values.shape == rho.shape
    assert np.all(np.abs(values - np.sqrt(1 + rho) * a) <= errors + 1e-15)
    assert errors[rho < 1].max() < 1e-9
    assert omega(0.5, 2.0) == omega(2.0)
    assert np.isnan(omega([-2.0])).all()


def test_solutions_of_parameters(duffing: Oscillator) -> None:
    x = duffing.solution_function()
    # sqrt(1 + rho) t = u, x = a cn(u, k), k^2 = rho/(2 + 2 rho), rho = eps a^2: mpmath 1.3.0.
    truth = np.array([[-0.432051131044673, 1.11775885807684], [-0.370401170086857, -0.901811833612849]])
    values, errors = x.with_error([0.7, 10], [2.0, 10.0], [2.0, 1.0])
    assert values.shape == (2, 2)
    assert np.all(np.abs(values - truth) <= errors + 1e-14) and errors.max() < 1e-10
    # Where none is given the amplitude is that of the case.
    assert x(0.7, 2.0) == x(0.7, 2.0, float(x.amplitude or 1)) and x(0.7, 2.0).shape == ()
    assert np.isnan(x([0.7], -2.0)).all()


def test_the_amplitude_is_that_of_the_case(duffing: Oscillator) -> None:
    omega = duffing.set(amplitude=2).frequency_function(order=8)
    # 0.1*2^2 in small and 0.4*1^2 are the same motion.
    assert omega(0.1) == omega(0.1, 2.0) == omega(0.4, 1.0) != omega(0.1, 1.0)
    assert float(omega(0.1)) == pytest.approx(1.1389, abs=1e-4) and omega.amplitude == 2
    quintic = Oscillator("x'' + x + eps*(x^3 + x^5) = 0").set(amplitude=2).frequency_function(order=8)
    assert float(quintic(0.01)) == pytest.approx(1.06239, abs=1e-5)
    for fixed in (quintic, Oscillator.builtin("van-der-pol").frequency_function(order=4)):
        assert fixed.parameters == ["eps"]
        with pytest.raises(lindstedt.UsageError):
            fixed(0.01, amplitude=2)


def test_an_averaged_motion_has_no_series_of_numbers() -> None:
    answer = Oscillator("x'' + x = eps*(1 - x**2)*x'").average(2)
    assert answer.series == {} and answer._repr_latex_() is None and answer.to_sympy() == {}
    with pytest.raises(lindstedt.NoAnswerError) as refused:
        answer.frequency
    assert "phase_rate" in refused.value.hint and answer["series"]["phase_rate"]
    assert "<math" in answer._repr_html_()


@pytest.mark.parametrize("seconds", [-1, -1e-300, math.nan, -math.inf])
def test_limits_that_are_none_are_refused(duffing: Oscillator, seconds: float) -> None:
    with pytest.raises(lindstedt.UsageError):
        duffing.derive(2, seconds=seconds)
    assert duffing.derive(2, seconds=math.inf).is_complete


SWEEP = "eps=1/10,1/5"
CODE = {"code": "python"}


@pytest.mark.parametrize(
    ("verb", "options", "together"),
    [
        ("evaluate", {}, {"prove": 1}),
        ("evaluate", {}, {"prove": "yes"}),
        ("evaluate", {"prove": True}, CODE),
        ("evaluate", {"sweep": SWEEP}, CODE),
        ("evaluate", {"sweep": SWEEP}, {"times": "0..1:3"}),
        ("evaluate", {"sweep": SWEEP}, {"phase": 1}),
        ("evaluate", {}, {"harmonics": 5}),
        ("derive", {"order": 1}, {"tier": "nonsense"}),
        ("derive", {"order": 1}, {"harmonics": 16}),
        ("derive", {"order": 1, "tier": "fourier"}, {"route": "energy"}),
        ("average", {"order": 1}, {"tier": "nonsense"}),
        ("average", {"order": 1}, {"route": "energy"}),
        ("simulate", {"until": 1, "digits": 8}, {"periods": 1}),
        ("simulate", {"periods": 1, "digits": 8}, {"impacts": 1}),
        ("simulate", {"until": 1, "digits": 8}, {"sweep": SWEEP}),
        ("simulate", {"until": 1, "digits": 8}, {"lyapunov": True}),
        ("frequency_function", {"order": 4}, {"times": "0..1:3"}),
        ("frequency_function", {"order": 4}, {"phase": 1}),
        ("solution", {"order": 4}, {"times": "0..1:3"}),
    ],
)
def test_options_that_do_not_go_together_are_refused(
    duffing: Oscillator, verb: str, options: dict[str, Any], together: dict[str, Any]
) -> None:
    case = duffing if verb in ("derive", "average") else duffing.set(eps="1/10")
    ask = getattr(case, verb)
    assert ask(**options)
    with pytest.raises(lindstedt.UsageError, match="beside the others|at a time|none of|is no flag"):
        ask(**options, **together)


def test_modes_and_unknowns_stand_alone() -> None:
    chain = Oscillator("x'' + 2*x - y + eps*x^3 = 0; y'' + 2*y - x = 0")
    assert chain.derive(1, mode=1)
    for besides in ({"tier": "nonsense"}, {"route": "clock"}, {"harmonics": 8}, {"unknown": "a"}):
        with pytest.raises(lindstedt.UsageError, match="beside the others|at a time"):
            chain.derive(1, mode=1, **besides)
    tongue = Oscillator("x'' + (a + eps*cos(2*t))*x = 0")
    with pytest.raises(lindstedt.UsageError, match="no option tier"):
        tongue.derive(1, unknown="a", tier="nonsense")


def test_starts_and_axes_are_counted() -> None:
    cycle = Oscillator("x'' + x = eps*(1 - x**2)*x'", eps="1/10").under("free")
    assert cycle.evaluate(start="1,0", times="0..1:3").is_complete
    with pytest.raises(lindstedt.UsageError, match="start, state"):
        cycle.evaluate(start="1,0", state="1,0", times="0..1:3")
    forced = Oscillator("x'' + x + eps*(x'/5 + x^3) = eps*cos((1 + eps*sigma)*t)/2", eps=0.1, sigma=1)
    with pytest.raises(lindstedt.UsageError, match="at most two"):
        forced.respond("sigma=0..1:3;eps=0..1:3;sigma=0..1:3")


def test_a_stopped_grid_has_its_shape() -> None:
    # Of uneven steps: point by point, some seconds in all.
    axes: dict[str, Any] = {"A": [-0.3, -0.2, *np.linspace(0, 0.3, 35).round(3)], "B": (-0.3, 0.3, 2000)}
    chart = Oscillator.builtin("vibro-impact").stability_chart(axes, seconds=0.3, radius=True)
    assert chart.radius is not None and not chart.complete
    assert chart.exact.shape == chart.radius.shape == (2000, 37)
    assert chart.exact[0, 0] != 2 and chart.exact[-1, -1] == chart.predicted[-1, -1] == 2
    assert np.isnan(chart.radius[-1, -1])
    belt = Oscillator.builtin("stick-slip")
    surface = belt.threshold_surface({"vstar": (0, 1, 60), "omega": (1, 2, 50)}, seconds=0)
    assert not surface.complete and surface.signed.shape == (50, 60) and np.isnan(surface.signed[-1, -1])
    assert belt.threshold_surface({"vstar": (0, 1, 3)}).complete


def test_solutions_of_arrays(duffing: Oscillator) -> None:
    x = duffing.set(eps=Fraction(1, 2)).solution()
    t = np.linspace(0, 20, 1001)
    direct = sum(c * np.cos(k * x.frequency * t) for k, (c, _) in enumerate(x.harmonics))
    assert np.abs(x(t) - direct).max() < 1e-13
    assert x.to_callable()(0.0) == pytest.approx(1, abs=1e-9) and x(t).shape == t.shape
    # The energy x'^2/2 + x^2/2 + x^4/8 is constant: x' by differences.
    v = (x(t + 1e-4) - x(t - 1e-4)) / 2e-4
    energy = v**2 / 2 + x(t) ** 2 / 2 + x(t) ** 4 / 8
    assert np.ptp(energy) < 1e-6 and np.all(x.error(t) < 1e-9)


def test_an_averaged_motion_in_arrays() -> None:
    cycle = Oscillator("x'' + x = eps*(1 - x**2)*x'", eps="1/10")
    motion = cycle.averaged_solution(start="1,0", order=3)
    times = np.array([[60.0, 0.0], [5.0, 25.0]])
    found = motion.with_error(times)
    assert all(value.shape == times.shape for pair in found.values() for value in pair)
    # Another route: the equation itself in time, from x(0) and x'(0) of the motion by differences.
    scipy = pytest.importorskip("scipy.integrate")
    a, psi, x = motion(times)
    assert (a[0, 1], psi[0, 1]) == (1, 0)
    step = 1e-3
    near = motion(np.array([-step, 0, step]))[2]
    start = [near[1], (near[2] - near[0]) / (2 * step)]
    truth = scipy.solve_ivp(
        lambda t, y: [y[1], -y[0] + 0.1 * (1 - y[0] ** 2) * y[1]], (0, 60), start, rtol=1e-10, atol=1e-12,
        t_eval=[0, 5, 25, 60],
    ).y[0]
    assert np.abs(np.array([x[0, 1], x[1, 0], x[1, 1], x[0, 0]]) - truth).max() < 1e-3
    for place, moment in zip(((1, 0), (1, 1)), motion.at([5.0, 25.0], digits=25)):
        for name, values in (("a", a), ("psi", psi), ("x", x)):
            number = moment[name]
            assert number is not None
            assert abs(float(number) - values[place]) <= float(number.error or 0) < 1e-2
    again = pickle.loads(pickle.dumps(motion))
    assert np.array_equal(again(times)[0], a)
    assert np.isfinite(found["a"][1]).all() and found["a"][1].max() < 1e-2


def test_functions_to_many_digits(duffing: Oscillator) -> None:
    omega, x = duffing.frequency_function(order=16), duffing.solution_function(order=16)
    with pytest.raises(lindstedt.UsageError):
        Oscillator.builtin("van-der-pol").frequency_function(order=4).at("1/10", amplitude=2)
    many = omega.at_each(["1/4", "1/2"], 1, digits=25)
    single = omega.at("1/2", 1, digits=25)
    assert len(many) == 2 and many[1] is not None and many[1] == single and many[0] != single
    number = omega.at("1/2", 1, digits=40)
    assert number is not None
    assert abs(float(number) - float(omega(0.5, 1.0))) <= float(number.error or 0) + omega.with_error(0.5, 1.0)[1] < 1e-6
    (far,) = x.at([10.0], "1/4", 2)
    assert far is not None
    # a cn(u, k) with sqrt(1 + rho) t = u, k^2 = rho/(2 + 2 rho), rho = eps a^2 = 1: mpmath 1.3.0.
    known = Decimal("1.59774953799482865242137")
    assert far.decimal is not None and far.error is not None
    assert abs(Decimal(far.decimal) - known) <= Decimal(far.error) < Decimal("1e-18")
    solution = duffing.set(eps="1/4", amplitude=2).solution(order=16)
    assert solution.at(10.0) == [far] and abs(float(solution(10.0)) - float(far)) <= float(solution.error(10.0))
    again = pickle.loads(pickle.dumps(omega))
    assert again(0.3) == omega(0.3) and again.parameters == omega.parameters
    code = duffing.evaluate(code="python", functions=True, order=12)
    space: dict[str, Any] = {}
    exec(code.code, space)
    t = np.linspace(0, 6, 50)
    assert np.abs(space["displacement"](t, 0.02, 1.5) - x(t, 0.02, 1.5)).max() < 1e-12


def test_every_question() -> None:
    cycle = Oscillator("x'' + x = eps*(1 - x**2)*x'")
    assert cycle.average(2).tier == "exact"
    assert cycle.verify(1, small="1/100,1/200").observed_order == pytest.approx(2, abs=0.1)
    cycle = cycle.set(eps="1/10")
    assert float(cycle.evaluate(digits=12).period) == pytest.approx(2 * math.pi * (1 + 0.01 / 16), rel=1e-6)
    assert cycle.prove(digits=10)["period"].status == "proved"
    assert len(cycle.evaluate({"eps": (0, 1, 3)}, order=6)["points"]) == 3
    assert cycle.simulate(until=1, digits=8).is_complete
    assert cycle.describe()["name"]
    forced = Oscillator("x'' + x + eps*(x'/5 + x^3) = eps*cos((1 + eps*sigma)*t)/2", eps=0.1, sigma=1)
    assert forced.respond()["states"][0]["count"] == 3
    belt = Oscillator.builtin("stick-slip", b=5)
    assert float(belt.threshold(digits=12).gamma_c) == pytest.approx(0.105347876877)
    saddle = Oscillator("x'' = x**2 - 4 + eps*x'*(x + tau)").threshold(unknown="tau", order=2)
    assert [number.fraction for number in saddle["series"]["tau"]] == [Fraction(10, 7), 0, Fraction(288, 2401)]
    # First order where no series is asked for and there is none: 4 delta/pi.
    pendulum = Oscillator("x'' + sin(x) = eps*(torque - x'/5)")
    first = pendulum.threshold(unknown="torque")["orbits"][0]["value"]
    assert float(first) == pytest.approx(0.8 / math.pi, rel=1e-12)
    with pytest.raises(lindstedt.NoAnswerError):
        pendulum.threshold(unknown="torque", order=2)
    plan = {"orders": [2, 4], "digits": [16], "harmonics": [], "repeats": 1}
    assert Oscillator.builtin("duffing", eps="1/10").trade(**plan)["rows"]
    assert {"duffing", "stick-slip"} <= {problem["name"] for problem in lindstedt.problems()}


def test_charts_are_arrays() -> None:
    impact = Oscillator.builtin("vibro-impact")
    chart = impact.stability_chart({"A": (-0.3, 0.3, 5), "B": (-0.3, 0.3, 4)})
    assert chart.names == ("A", "B") and chart.exact.shape == (4, 5) and chart.x[0] == -0.3
    assert set(np.unique(chart.exact)) <= {-1, 0, 1, 2} and chart.complete and chart.radius is None
    # The largest multiplier is inside the unit circle where the verdict, by the number of roots outside it, is stable.
    radius = impact.stability_chart({"A": (-0.3, 0.3, 5), "B": (-0.3, 0.3, 4)}, radius=True).radius
    assert radius is not None and {-1, 1} <= set(np.unique(chart.exact))
    assert np.all(radius[chart.exact == 1] < 1) and np.all(radius[chart.exact == -1] > 1)
    assert np.isnan(radius[chart.exact == 2]).all()
    surface = Oscillator.builtin("stick-slip").threshold_surface({"vstar": (0, 1, 5), "omega": [1, 2]})
    assert surface.signed.shape == (2, 5) and surface.names == ["vstar", "omega"]
    for made in (chart, surface):
        again = pickle.loads(pickle.dumps(made))
        assert isinstance(again, type(made)) and np.array_equal(again.x, made.x)
        with pytest.raises(dataclasses.FrozenInstanceError):
            made.complete = False  # type: ignore[misc]
    one = Oscillator.builtin("stick-slip", vstar=0.5, omega=2).threshold(doubles=True)
    assert surface.signed[1, 2] == pytest.approx(float(one.signed), rel=1e-12)
    diagram = Oscillator.builtin("stick-slip").bifurcation_diagram("gamma=0.5..0.6:2", skip=20, keep=4)
    assert diagram.values.tolist() == [0.5, 0.6] and len(diagram.x) == len(diagram.value) == 8


def test_figures_and_tables(duffing: Oscillator, tmp_path: Path) -> None:
    answer = duffing.set(eps=1).evaluate(order=8, times="0..6:7", digits=8)
    assert answer.figure is not None and answer._repr_svg_() == answer.figure.svg
    assert answer.figure.svg.lstrip().startswith("<svg")
    answer.figure.save(str(tmp_path / "figure.svg"))
    table = answer.table()
    assert len(next(iter(table.values()))) == 7
    pandas = pytest.importorskip("pandas")
    assert isinstance(answer.to_pandas(), pandas.DataFrame)
    again = pickle.loads(pickle.dumps(answer))
    assert again.to_dict() == answer.to_dict() and str(again) == str(answer)
    times: dict[str, Any] = {"order": 8, "digits": 8}
    assert duffing.set(eps=1).evaluate(times=np.linspace(0, 6, 7), **times).table() == table
    derived = duffing.derive(2)
    assert derived.table()["frequency"] == [1, 0.375, -21 / 256] and list(derived.to_pandas()["order"]) == [0, 1, 2]
    with pytest.raises(lindstedt.NoAnswerError):
        duffing.set(eps=1).evaluate(order=8, digits=8).plot()
    # Values like 1/3 are numbers there, and the curve is over them.
    swept = duffing.evaluate({"eps": [0, "1/3", "1/2"]}, order=8, digits=8)
    assert swept.table()["eps"] == [0, 1 / 3, 0.5]
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("agg")
    assert answer.plot().get_xlabel() == next(iter(table))
    assert swept.plot().get_xlabel() == "eps"


def test_ctrl_c_stops_long_work() -> None:
    law = Oscillator.builtin("power-law")
    # A shell that starts the tests in the background has them ignore it.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    # In full it takes minutes.
    threading.Timer(0.3, signal.raise_signal, [signal.SIGINT]).start()
    with pytest.raises(KeyboardInterrupt):
        law.derive(30)


def test_other_threads_run_meanwhile_and_limits_hold() -> None:
    law = Oscillator.builtin("power-law")
    told: list[tuple[str, int, int]] = []
    ticks: list[None] = []
    done = threading.Event()

    def tick() -> None:
        while not done.wait(0.01):
            ticks.append(None)

    other = threading.Thread(target=tick)
    other.start()
    try:
        answer = law.derive(40, seconds=0.5, progress=lambda *words: told.append(words))
        assert not answer.is_complete
    except lindstedt.StoppedError:
        pass
    finally:
        done.set()
        other.join()
    assert told and ticks


def test_a_bar_where_tqdm_is(monkeypatch: pytest.MonkeyPatch) -> None:
    tqdm = pytest.importorskip("tqdm.auto")
    bars: list[Any] = []

    class Bar(tqdm.tqdm):  # type: ignore[misc, name-defined]
        def __init__(self, **options: Any) -> None:
            super().__init__(disable=False, file=io.StringIO(), **options)
            bars.append(self)

    monkeypatch.setattr(tqdm, "tqdm", Bar)
    Oscillator.builtin("power-law").derive(12, progress=True)
    assert len(bars) == 1 and bars[0].desc


def test_the_stub_names_what_there_is() -> None:
    native = lindstedt._native
    stub = ast.parse(Path(str(native.__file__)).with_name("_native.pyi").read_text())
    written: set[str] = set()
    for item in stub.body:
        if isinstance(item, (ast.ClassDef, ast.FunctionDef)):
            written.add(item.name)
            assert hasattr(native, item.name), item.name
        if isinstance(item, ast.ClassDef):
            own = getattr(native, item.name)
            methods = {part.name for part in item.body if isinstance(part, ast.FunctionDef)}
            assert all(hasattr(own, method) for method in methods), item.name
            assert {name for name in vars(own) if not name.startswith("_")} <= methods, item.name
    assert {name for name in vars(native) if not name.startswith("_")} <= written
    assert all(hasattr(lindstedt, name) for name in lindstedt.__all__)


def test_a_grid_is_the_same_on_other_processes(duffing: Oscillator) -> None:
    values: dict[str, list[lindstedt.Value]] = {"eps": ["1/10", "1/5"], "amplitude": [1, 2]}
    local = lindstedt.grid(duffing, "evaluate", values, order=4)
    with ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("spawn")) as pool:
        there = lindstedt.grid(duffing, "evaluate", values, executor=pool, block=2, order=4)
    assert [a["period"] for a in local] == [a["period"] for a in there]
    assert [a.at["amplitude"] for a in there] == ["1", "2", "1", "2"]
    refused = lindstedt.grid(duffing, "evaluate", {"eps": [-2]}, order=4)
    assert isinstance(refused[0], lindstedt.LindstedtError)
    assert pickle.loads(pickle.dumps(duffing.set(eps=2))) == duffing.set(eps=2)


def test_the_readme_is_true() -> None:
    import doctest

    found = doctest.testfile(
        str(Path(__file__).parent.parent / "README.md"),
        module_relative=False,
        optionflags=doctest.NORMALIZE_WHITESPACE | doctest.ELLIPSIS,
    )
    assert found.attempted >= 7 and found.failed == 0
    for module in (lindstedt, lindstedt._numbers, lindstedt._oscillator):
        assert doctest.testmod(module).failed == 0


def test_arrays_as_they_come(duffing: Oscillator) -> None:
    omega = duffing.frequency_function(order=12)
    shifted = np.frombuffer(b"\0" + np.array([0.1, 0.5]).tobytes(), offset=1)
    assert not shifted.flags.aligned and (omega(shifted, 1.0) == omega([0.1, 0.5], 1.0)).all()
    with pytest.raises(lindstedt.UsageError, match="masked"):
        omega(np.ma.masked_array([0.1, 1e3], mask=[False, True]), 1.0)
    assert omega(np.ma.masked_array([0.1], mask=[False]), 1.0) == omega([0.1], 1.0)
    with pytest.raises(lindstedt.StoppedError):
        omega.at_each([f"{k}/1000" for k in range(1, 301)], 1, digits=100, seconds=0.05)
    many = np.ones(200_000)
    solution = duffing.set(eps="1/2").solution()
    calls: list[Callable[[], object]] = [
        lambda: omega(many, 1.0, memory=1),
        lambda: solution(many, memory=1),
        lambda: solution.error(many, memory=1),
    ]
    for call in calls:
        with pytest.raises(lindstedt.LindstedtError, match="MiB|memory"):
            call()


def test_what_is_refused_where_it_is_read_is_refused_when_asked(duffing: Oscillator) -> None:
    make, values = duffing.frequency_function(order=12).__reduce__()
    oscillator, name, options = values
    refused = make(oscillator, name, {**options, "order": 10**9})
    with pytest.raises(lindstedt.LindstedtError):
        refused([0.1], 1.0)
    with pytest.raises(lindstedt.LindstedtError):
        refused.parameters


def test_plots_are_over_what_varies() -> None:
    plt = pytest.importorskip("matplotlib.pyplot")
    forced = Oscillator("x'' + x + eps*(x'/5 + x^3) = eps*F*cos((1 + eps*sigma)*t)", eps="1/10", F="1/2")
    axes = forced.respond("sigma=-1..3").plot(plt.figure().gca())
    assert axes.get_xlabel() == "sigma"
    places = axes.lines[0].get_xdata()
    assert min(places) == -1 and max(places) == 3
    swept = Oscillator.builtin("duffing").evaluate(sweep="eps=0..1:5").plot(plt.figure().gca())
    assert {line.get_label() for line in swept.lines} == {"period", "frequency", "exact_period"}
    plt.close("all")
