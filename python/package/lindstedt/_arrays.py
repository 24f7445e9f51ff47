"""Functions of arrays, charts, surfaces and diagrams."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from decimal import Decimal
from fractions import Fraction
from typing import TYPE_CHECKING, Any, Union

import numpy
from numpy.typing import ArrayLike, NDArray

from ._errors import LindstedtError, StoppedError, UsageError
from ._means import limited
from ._numbers import Number, Value, each, exact, several, shown

if TYPE_CHECKING:
    from ._answers import Answer
    from ._oscillator import Oscillator

Doubles = NDArray[numpy.float64]
Real = Union[float, Fraction, Decimal]
Points = Union[ArrayLike, Real, Sequence[Real], Sequence[Sequence[Real]]]
"""What an array of doubles is made of."""


def _doubles(values: Points) -> Doubles:
    if numpy.ma.is_masked(values):
        raise UsageError("masked values have no number", "value", ".filled(numpy.nan)")
    try:
        array = numpy.asarray(values)
        if array.dtype == numpy.float64:
            return array
        if array.dtype.kind == "O" and any(item is None or isinstance(item, (bool, str)) for item in array.flat):
            raise TypeError("not all are numbers")
        # Complex numbers and dates would lose a part.
        if array.dtype.kind not in "iufO":
            raise TypeError(f"{array.dtype} are no real numbers")
        return array.astype(numpy.float64, copy=False)
    except (TypeError, ValueError, ArithmeticError) as error:
        hint = "floats; exact values go into set()"
        raise UsageError(f"{shown(values)} is no array of doubles: {error}", "value", hint) from None


def _flat(values: Points) -> Doubles:
    return numpy.require(_doubles(values), requirements=["C_CONTIGUOUS", "ALIGNED"]).ravel()


class _Made:
    """What an oscillator made of options. It pickles as these: it is derived anew where it is read."""

    def __init__(self, native: Any, oscillator: Oscillator, name: str, options: dict[str, Any]) -> None:
        self._native = native
        self._from = (oscillator, name, options)
        self.data: dict[str, Any] = json.loads(native.json())

    def __reduce__(self) -> tuple[Any, ...]:
        return (_again, self._from)

    def __repr__(self) -> str:
        names = ", ".join(self.data.get("parameters", []))
        return f"<{type(self).__name__} of {self._from[0]!r}{' over ' if names else ''}{names}>"

    def _displaced(self, times: Any, digits: int, limits: dict[str, float], **values: Value) -> list[dict[str, Any]]:
        """The motion at times in any order, by `evaluate`, which takes each once and in increasing order."""
        asked = each(times)
        if not asked:
            return []
        try:
            places = [Fraction(exact(time)) for time in asked]
        except ValueError:  # What is no fraction `evaluate` refuses itself.
            points: list[dict[str, Any]] = self._evaluated(digits, {"times": asked, **limits}, **values)["solution"]["values"]
            return points
        order = sorted(set(places))
        found = self._evaluated(digits, {"times": order, **limits}, **values)["solution"]["values"]
        known: dict[Fraction, dict[str, Any]] = dict(zip(order, found))
        return [known[place] for place in places if place in known]

    def _evaluated(self, digits: int, options: dict[str, Any], **values: Any) -> Answer:
        """The answer of `evaluate` to so many digits with the same options."""
        oscillator, _, made = self._from
        asked = {name: made[name] for name in ("order", "resum", "phase", "start", "state") if name in made}
        return oscillator.set(**values).evaluate(digits=digits, **asked, **options)


def _again(oscillator: Oscillator, name: str, options: dict[str, Any]) -> Any:
    try:
        return getattr(oscillator, name)(**options)
    except LindstedtError as error:
        # An error while an argument is read kills a worker of a pool, whose caller then waits for ever.
        return _Refused(error)


class _Refused:
    """What could not be derived anew where it was read: whatever is asked of it is refused with the reason."""

    def __init__(self, error: LindstedtError) -> None:
        self._error = error

    def __call__(self, *values: Any, **limits: Any) -> Any:
        raise self._error

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        raise self._error


class _OfParameters(_Made):
    """A function of the small parameter and, where a scaling carries it, the amplitude. One that is not given is
    the oscillator's; where it does not vary, none is taken."""

    @property
    def parameters(self) -> list[str]:
        """The names of what varies."""
        return list(self.data["parameters"])

    @property
    def amplitude(self) -> float | None:
        """The amplitude where none is given: that of the oscillator."""
        amplitude: float | None = self._native.amplitude
        return amplitude

    def _amplitude(self, amplitude: Points | None) -> Points:
        varies = "amplitude" in self.parameters
        if amplitude is not None and not varies:
            raise UsageError(
                f"no amplitude varies here, only {', '.join(self.parameters)}", "usage", "set(amplitude=...) before"
            )
        if amplitude is None and varies:
            amplitude = self.amplitude
            if amplitude is None:
                raise UsageError("the amplitude has no value", "usage", "amplitude=...")
        return 1.0 if amplitude is None else amplitude

    def _values(self, small: Value, amplitude: Value | None) -> dict[str, Value]:
        """The values of one point as they are set."""
        if amplitude is not None:
            self._amplitude(amplitude)
        values: dict[str, Value] = {self.parameters[0]: small}
        return values if amplitude is None else {**values, "amplitude": amplitude}

    def _points(self, small: Points, amplitude: Points | None) -> tuple[Doubles, Doubles]:
        first, second = _doubles(small), _doubles(self._amplitude(amplitude))
        if second.ndim:
            try:
                first, second = numpy.broadcast_arrays(first, second)
            except ValueError as error:
                raise UsageError(f"{self.parameters[0]} and amplitude: {error}", "value", "arrays of one shape") from None
        return first, second


class FrequencyFunction(_OfParameters):
    """omega over the small parameter and, where a scaling carries it, the amplitude: derived once, then some
    0.2 microseconds per point and core. Doubles, each with its estimated error. An amplitude that is not given is
    the oscillator's; where it does not vary, none is taken. Limits are `seconds` and `memory`."""

    def at(self, small: Value, amplitude: Value | None = None, digits: int = 30, **limits: float) -> Number | None:
        """omega at one point to so many digits, with its error: by `evaluate`. None where not one digit is known."""
        found: Number | None = self._evaluated(digits, limits, **self._values(small, amplitude))["frequency"]
        return found

    def at_each(
        self, small: Sequence[Value] | Doubles, amplitude: Value | None = None, digits: int = 30, **limits: float
    ) -> list[Number | None]:
        """omega at many values of the small parameter to so many digits, each with its error, derived once: by the sweep of
        `evaluate`. None where the sum has not one digit, or the point is refused; `evaluate(sweep=...)` tells why."""
        name = self.parameters[0]
        points = several(small, name)
        if not points:
            return []
        values = self._values(points[0], amplitude)
        del values[name]
        found = self._evaluated(digits, {"sweep": {name: points}, **limits}, **values)
        if str(found["standing"]).startswith("stopped"):
            raise StoppedError("stopped before all values were there", "stopped", "more seconds")
        return [point.get("frequency") for point in found["points"]]

    def with_error(
        self, small: Points, amplitude: Points | None = None, **limits: float
    ) -> tuple[Doubles, Doubles]:
        """omega and its estimated errors, infinite where the sum has not one digit."""
        first, second = self._points(small, amplitude)
        values, errors = self._native.at(_flat(first), _flat(second), limited(limits))
        return values.reshape(first.shape), errors.reshape(first.shape)

    def __call__(self, small: Points, amplitude: Points | None = None, **limits: float) -> Doubles:
        values, errors = self.with_error(small, amplitude, **limits)
        return numpy.where(numpy.isfinite(errors), values, numpy.nan)


class SolutionFunction(_OfParameters):
    """x(t) over the small parameter and, where a scaling carries it, the amplitude: derived once, then some 5
    microseconds per point and 20 to 50 nanoseconds per time and core. Doubles, each with its estimated error. Limits are
    `seconds` and `memory`."""

    def at(
        self, times: Points | Value, small: Value, amplitude: Value | None = None, digits: int = 30, **limits: float
    ) -> list[Number | None]:
        """x at times and one point to so many digits, each with its error: by `evaluate`. None where not one digit is known."""
        return [point["x"] for point in self._displaced(times, digits, limits, **self._values(small, amplitude))]

    def with_error(
        self, times: Points, small: Points, amplitude: Points | None = None, **limits: float
    ) -> tuple[Doubles, Doubles]:
        """x and its estimated errors, infinite where nothing is known: at every point of the parameters all times, in the
        shape of the parameters followed by that of the times."""
        first, second = self._points(small, amplitude)
        times = _doubles(times)
        shape = first.shape + times.shape
        values, errors = self._native.at(_flat(times), _flat(first), _flat(second), limited(limits))
        return values.reshape(shape), errors.reshape(shape)

    def __call__(self, times: Points, small: Points, amplitude: Points | None = None, **limits: float) -> Doubles:
        values, errors = self.with_error(times, small, amplitude, **limits)
        return numpy.where(numpy.isfinite(errors), values, numpy.nan)


class Solution(_Made):
    """x(t) by its harmonics: call it with an array of times. It is no number where its error is more than the motion.
    Limits are `seconds` and `memory`."""

    def at(self, times: Points | Value, digits: int = 30, **limits: float) -> list[Number | None]:
        """x at times to so many digits, each with its error: by `evaluate`. None where not one digit is known."""
        return [point["x"] for point in self._displaced(times, digits, limits)]

    @property
    def frequency(self) -> float:
        """omega."""
        return float(self.data["frequency"])

    @property
    def period(self) -> float:
        """2 pi/omega."""
        return 2 * numpy.pi / self.frequency

    @property
    def harmonics(self) -> Doubles:
        """(c_k, s_k), k = 0, 1, ..., of c_k cos(k omega t) + s_k sin(k omega t)."""
        return numpy.array(self.data["harmonics"])

    def __call__(self, times: Points, **limits: float) -> Doubles:
        times = _doubles(times)
        flat, means = _flat(times), limited(limits)
        values: Doubles = self._native.at(flat, means)
        # The error grows with |t|: what the two ends know, all know.
        ends = [flat.min(), flat.max()] if flat.size else []
        if not numpy.isfinite(self._native.errors(_flat(ends), means)).all():
            values[~numpy.isfinite(self._native.errors(flat, means))] = numpy.nan
        return values.reshape(times.shape)

    def error(self, times: Points, **limits: float) -> Doubles:
        """The estimated error at times: it grows with t by what omega is wrong by, and is infinite where x is not known."""
        times = _doubles(times)
        errors: Doubles = self._native.errors(_flat(times), limited(limits))
        return errors.reshape(times.shape)

    def to_callable(self) -> Callable[[float], float]:
        """x as a function of one time, for comparisons with `scipy.integrate.solve_ivp`."""
        return lambda t: float(self(t))

    def plot(self, ax: Any = None, periods: float = 2.0, **style: Any) -> Any:
        """Draws x over so many periods with matplotlib."""
        import matplotlib.pyplot as plt

        ax = ax if ax is not None else plt.gca()
        t = numpy.linspace(0, periods * self.period, 512)
        ax.plot(t, self(t), **style)
        ax.set_xlabel("t")
        ax.set_ylabel("x")
        return ax


class AveragedSolution(_Made):
    """a(t), psi(t) and x(t) of an averaged motion: derived once, integrated at every call from its start.
    Limits are `seconds` and `memory`."""

    def with_error(self, times: Points, **limits: float) -> dict[str, tuple[Doubles, Doubles]]:
        """`a`, `psi`, `x` with their estimated errors at times in any order; no numbers where the motion does not come."""
        times = _doubles(times)
        order, back = numpy.unique(times.ravel(), return_inverse=True)
        found = self._native.at(order, limited(limits, digits=16))[:, back]
        rows = [row.reshape(times.shape) for row in found]
        return {"a": (rows[0], rows[1]), "psi": (rows[2], rows[3]), "x": (rows[4], rows[5])}

    def __call__(self, times: Points, **limits: float) -> tuple[Doubles, Doubles, Doubles]:
        """a, psi and x at times."""
        found = self.with_error(times, **limits)
        return found["a"][0], found["psi"][0], found["x"][0]

    def at(self, times: Points | Value, digits: int = 30, **limits: float) -> list[dict[str, Number | None]]:
        """a, psi, x at times to so many digits, each with its error: by `evaluate`. None where not one digit is known."""
        found = self._displaced(times, digits, limits)
        return [{name: point[name] for name in ("a", "psi", "x")} for point in found]


def _joined(parts: list[dict[str, Any]], names: list[str]) -> dict[str, Any]:
    """What all parts have in common, and these arrays one after the other."""
    joined = {name: numpy.concatenate([p[name] for p in parts]) for name in names if parts[0][name] is not None}
    return {**parts[0], **joined, "complete": all(part["complete"] for part in parts)}


class _Same:
    """Equal where all that it holds is, NaN to NaN."""

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        names = [field.name for field in fields(self)]  # type: ignore[arg-type]
        return all(_same(getattr(self, name), getattr(other, name)) for name in names)


def _same(one: Any, other: Any) -> bool:
    if isinstance(one, numpy.ndarray) and isinstance(other, numpy.ndarray):
        return numpy.array_equal(one, other, equal_nan=True)
    return type(one) is type(other) and bool(one == other)


@dataclass(frozen=True, eq=False)
class StabilityChart(_Same):
    """Verdicts over two parameters, row y, column x: 1 stable, -1 unstable, 0 neutral or undecided, 2 without
    an orbit or not computed (stopped: not `complete`); `radius` the largest multiplier of the true system, where it
    was asked for."""

    names: tuple[str, str]
    x: Doubles
    y: Doubles
    predicted: NDArray[numpy.int8]
    exact: NDArray[numpy.int8]
    radius: Doubles | None
    complete: bool

    @classmethod
    def joined(cls, parts: list[dict[str, Any]]) -> StabilityChart:
        """The chart of its blocks of rows."""
        return cls(**_joined(parts, ["y", "predicted", "exact", "radius"]))


@dataclass(frozen=True, eq=False)
class ThresholdSurface(_Same):
    """The signed threshold gamma_c over one or two parameters, row y, column x; no number where there is none,
    and `blanks` says why, or where it was stopped before (not `complete`)."""

    names: list[str]
    x: Doubles
    y: Doubles | None
    signed: Doubles
    certified: bool
    blanks: list[str]
    complete: bool

    @classmethod
    def joined(cls, parts: list[dict[str, Any]]) -> ThresholdSurface:
        """The surface of its blocks of rows."""
        blanks = sorted({reason for part in parts for reason in part["blanks"]})
        return cls(**{**_joined(parts, ["y", "signed"]), "blanks": blanks})


@dataclass(frozen=True, eq=False)
class BifurcationDiagram(_Same):
    """The points (value, x, velocity) of a section, one after the other; `values` are those of the parameter, and
    `ended` those whose motion ended, with the reason."""

    name: str
    values: Doubles
    value: Doubles
    x: Doubles
    velocity: Doubles
    ended: list[tuple[float, str]]
    complete: bool

    @classmethod
    def joined(cls, parts: list[dict[str, Any]]) -> BifurcationDiagram:
        """The diagram of its blocks of values."""
        ended = [end for part in parts for end in part["ended"]]
        return cls(**{**_joined(parts, ["values", "value", "x", "velocity"]), "ended": ended})
