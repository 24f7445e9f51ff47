"""Functions of arrays, charts, surfaces and diagrams."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy
from numpy.typing import ArrayLike, NDArray

from ._errors import UsageError
from ._native import Frequency, Motion, Motions

Doubles = NDArray[numpy.float64]


def _flat(values: ArrayLike) -> Doubles:
    return numpy.ascontiguousarray(values, dtype=numpy.float64).ravel()


class _OfParameters:
    """A function of the small parameter and, where a scaling carries it, the amplitude. One that is not given is
    the oscillator's; where it does not vary, none is taken."""

    def __init__(self, native: Any) -> None:
        self._native = native
        self.data: dict[str, Any] = json.loads(native.json())

    @property
    def parameters(self) -> list[str]:
        """The names of what varies."""
        return list(self.data["parameters"])

    @property
    def amplitude(self) -> float | None:
        """The amplitude where none is given: that of the oscillator."""
        amplitude: float | None = self._native.amplitude
        return amplitude

    def _amplitude(self, amplitude: ArrayLike | None) -> ArrayLike:
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

    def _points(self, small: ArrayLike, amplitude: ArrayLike | None) -> tuple[Doubles, Doubles]:
        amplitude = self._amplitude(amplitude)
        if numpy.ndim(amplitude):
            small, amplitude = numpy.broadcast_arrays(small, amplitude)
        return numpy.asarray(small, dtype=numpy.float64), numpy.asarray(amplitude, dtype=numpy.float64)


class FrequencyFunction(_OfParameters):
    """omega over the small parameter and, where a scaling carries it, the amplitude: derived once, then some
    0.2 microseconds per point and core. Doubles, each with its estimated error. An amplitude that is not given is
    the oscillator's; where it does not vary, none is taken."""

    def __init__(self, native: Frequency) -> None:
        super().__init__(native)

    def with_error(self, small: ArrayLike, amplitude: ArrayLike | None = None) -> tuple[Doubles, Doubles]:
        """omega and its estimated errors, infinite where the sum has not one digit."""
        small, amplitude = self._points(small, amplitude)
        values, errors = self._native.at(_flat(small), _flat(amplitude))
        return values.reshape(small.shape), errors.reshape(small.shape)

    def __call__(self, small: ArrayLike, amplitude: ArrayLike | None = None) -> Doubles:
        values, errors = self.with_error(small, amplitude)
        return numpy.where(numpy.isfinite(errors), values, numpy.nan)


class SolutionFunction(_OfParameters):
    """x(t) over the small parameter and, where a scaling carries it, the amplitude: derived once, then some 5
    microseconds per point and 20 to 50 nanoseconds per time and core. Doubles, each with its estimated error."""

    def __init__(self, native: Motions) -> None:
        super().__init__(native)

    def with_error(
        self, times: ArrayLike, small: ArrayLike, amplitude: ArrayLike | None = None
    ) -> tuple[Doubles, Doubles]:
        """x and its estimated errors, infinite where nothing is known: at every point of the parameters all times, in the
        shape of the parameters followed by that of the times."""
        small, amplitude = self._points(small, amplitude)
        shape = small.shape + numpy.shape(times)
        values, errors = self._native.at(_flat(times), _flat(small), _flat(amplitude))
        return values.reshape(shape), errors.reshape(shape)

    def __call__(self, times: ArrayLike, small: ArrayLike, amplitude: ArrayLike | None = None) -> Doubles:
        values, errors = self.with_error(times, small, amplitude)
        return numpy.where(numpy.isfinite(errors), values, numpy.nan)


class Solution:
    """x(t) by its harmonics: call it with an array of times."""

    def __init__(self, native: Motion) -> None:
        self._native = native
        self.data: dict[str, Any] = json.loads(native.json())

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

    def __call__(self, times: ArrayLike) -> Doubles:
        return self._native.at(_flat(times)).reshape(numpy.shape(times))

    def error(self, times: ArrayLike) -> Doubles:
        """The estimated error at times: it grows with t by what omega is wrong by."""
        return self._native.errors(_flat(times)).reshape(numpy.shape(times))

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


def _joined(parts: list[dict[str, Any]], names: list[str]) -> dict[str, Any]:
    """What all parts have in common, and these arrays one after the other."""
    joined = {name: numpy.concatenate([p[name] for p in parts]) for name in names if parts[0][name] is not None}
    return {**parts[0], **joined, "complete": all(part["complete"] for part in parts)}


@dataclass(frozen=True)
class StabilityChart:
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


@dataclass(frozen=True)
class ThresholdSurface:
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


@dataclass(frozen=True)
class BifurcationDiagram:
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
