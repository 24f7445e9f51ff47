"""The case: an equation with its values, and a method per question."""

from __future__ import annotations

import functools
import itertools
import json
import numbers
import os
import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Union

import numpy

from ._answers import Answer, Derivation
from ._arrays import (
    AveragedSolution,
    BifurcationDiagram,
    FrequencyFunction,
    Solution,
    SolutionFunction,
    StabilityChart,
    ThresholdSurface,
)
from ._errors import LindstedtError, UsageError
from ._means import NAMES, taken, working
from ._native import Case
from ._numbers import Value, each, exact, plain, several, shown

Sweep = Union[str, Mapping[str, Any], Sequence[str]]
"""`"eps=0..1:11"`, `{"eps": (0, 1, 11)}` (ends and number), `{"eps": [0, "1/3", 1]}` (a list of values).
A tuple is a range and nothing else, in `grid`, too."""


def _sweep(sweep: Sweep) -> str:
    if isinstance(sweep, Mapping):
        return ";".join(_axis(name, values) for name, values in sweep.items())
    axes = [sweep] if isinstance(sweep, str) else several(sweep, "sweep")
    return ";".join(plain(axis, '"eps=0..1:11"') for axis in axes)


def _axis(name: str, values: Any) -> str:
    if not isinstance(values, tuple):
        return f"{name}={','.join(map(exact, several(values, name)))}"
    if len(values) != 3:
        raise UsageError(f"{name}: {shown(values)} is no range", "usage", "(low, high, number), or a list of values")
    low, high, count = map(exact, values)
    return f"{name}={low}..{high}:{count}"


def _text(name: str, value: Any) -> str:
    if name == "sweep":
        return _sweep(value)
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (list, tuple)) or isinstance(value, numpy.ndarray) and value.ndim:
        return ",".join(map(exact, each(value) if name == "times" else value))
    return exact(value)


class Oscillator:
    """An oscillator: an equation, a problem file or a built-in name, with exact values for parameters.

    >>> Oscillator("x'' + x + eps*x**3 = 0").derive(2).frequency.fractions
    [Fraction(1, 1), Fraction(3, 8), Fraction(-21, 256)]

    Immutable: `set` and `under` return another one. It pickles as its text and its values.
    """

    def __init__(self, equation: str, **values: Value) -> None:
        self._init("equation", equation.replace("**", "^") if isinstance(equation, str) else equation, {}, None)
        self.__dict__.update(self.set(**values).__dict__)

    def _init(self, kind: str, text: str, values: dict[str, str], condition: str | None) -> None:
        plain(text, "\"x'' + x + eps*x**3 = 0\"")
        self._state = (kind, text, dict(values), condition)
        self._case = Case(kind, text, list(values.items()), condition)

    @classmethod
    def _made(cls, kind: str, text: str, values: dict[str, str], condition: str | None) -> Oscillator:
        made = cls.__new__(cls)
        made._init(kind, text, values, condition)
        return made

    @classmethod
    def builtin(cls, name: str, **values: Value) -> Oscillator:
        """The built-in oscillator of that name, see `problems()`."""
        return cls._made("builtin", name, {}, None).set(**values)

    @classmethod
    def file(cls, path: str | os.PathLike[str], **values: Value) -> Oscillator:
        """An oscillator from a problem file (TOML)."""
        try:
            with open(plain(os.fspath(path), '"problem.toml"'), encoding="utf-8") as file:
                text = file.read()
        except (TypeError, ValueError) as error:
            raise UsageError(f"{shown(path)} is no problem file: {error}", "usage", "the path of a TOML file") from None
        return cls.toml(text, **values)

    @classmethod
    def toml(cls, text: str, **values: Value) -> Oscillator:
        """An oscillator from the text of a problem file."""
        return cls._made("file", text, {}, None).set(**values)

    def set(self, **values: Value) -> Oscillator:
        """The same oscillator with values for parameters."""
        kind, text, known, condition = self._state
        known = {**known, **{name: exact(value) for name, value in values.items()}}
        return self._made(kind, text, known, condition)

    def under(self, normalisation: str) -> Oscillator:
        """The same with another meaning of the amplitude: `initial`, `fundamental`, or `free` (averaging)."""
        kind, text, known, _ = self._state
        plain(normalisation, "initial, fundamental or free")
        return self._made(kind, text, known, normalisation)

    def __getstate__(self) -> dict[str, Any]:
        return {"state": self._state}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self._init(*state["state"])

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Oscillator) and self._state == other._state

    def __hash__(self) -> int:
        kind, text, values, condition = self._state
        return hash((kind, text, tuple(sorted(values.items())), condition))

    def __repr__(self) -> str:
        values = "".join(f", {name}={value}" for name, value in self._state[2].items())
        return f"<Oscillator {self.equation}{values}>"

    def __str__(self) -> str:
        return self.equation

    @property
    def name(self) -> str:
        """The name of the problem."""
        return self._case.name

    @property
    def equation(self) -> str:
        """Its equation, `... = 0`."""
        return self._case.equation

    @property
    def values(self) -> dict[str, str]:
        """The exact values that are set, and those that the problem has."""
        return self._case.values()

    @property
    def parameters(self) -> list[str]:
        """The names of the parameters."""
        return self._case.parameters()

    def describe(self) -> dict[str, Any]:
        """The problem, its file, what its equation is made of, and which methods take it."""
        described: dict[str, Any] = json.loads(self._case.entry())["problems"][0]
        return described

    # Questions.

    def _ask(self, verb: str, options: dict[str, Any], means: dict[str, Any]) -> Answer:
        kind = Derivation if verb == "derive" else Answer
        try:
            with working(means) as work:
                answer = kind(self._case.ask(verb, _options(options), work))
        except UsageError as error:
            for name in options.keys() & {*self.parameters, self._case.small}:
                if f"option {name}" in error.message:
                    error.hint = f"set({name}=...) before"
            raise
        for remark in answer.remarks if not answer.is_complete else []:
            warnings.warn(remark, stacklevel=3)
        return answer

    def derive(self, order: int = 4, **options: Any) -> Derivation:
        """The expansion to an order, substituted back: exact, or `tier="collocation"`, `"fourier"`.

        Averaged with a free amplitude (`under("free")`) and at resonance. `mode=k` is a normal mode,
        `unknown="a"` a parameter that solvability fixes; `route` is auto, clock, driver or energy;
        `only="frequency"` leaves the solution out and goes to much higher orders.
        """
        means = taken(options)
        answer = self._ask("derive", {"order": order, **options}, means)
        assert isinstance(answer, Derivation)
        return answer

    def average(self, order: int = 2, **options: Any) -> Derivation:
        """The averaged equations of Krylov, Bogoliubov and Mitropolsky to an order."""
        return self.under("free").derive(order, **options)

    def evaluate(self, sweep: Sweep | None = None, **options: Any) -> Answer:
        """Period and frequency at the values set, by resummation; `times="0..10:101"`, `order`, `resum`,
        `phase`, `code="python"` with `harmonics`; with a sweep at every point of it, without times, phase and code,
        derived once where only the small parameter varies. Of an averaged motion the rates at its start.

        With `cycles=2` alone: first-order averaging of any law, the cycles up to that amplitude.
        """
        means = taken(options)
        return self._ask("evaluate", {"sweep": sweep, **options}, means)

    def prove(self, sweep: Sweep | None = None, **options: Any) -> Answer:
        """The periodic orbit as a theorem: existence, uniqueness, a bound of every number; a family with a sweep."""
        means = taken(options)
        return self._ask("evaluate", {"sweep": sweep, "prove": True, **options}, means)

    def respond(self, sweep: Sweep | None = None, **options: Any) -> Answer:
        """The steady states at resonance: all in a box (`box`), or branches over a sweep; `order`, `start`, `follow`."""
        means = taken(options)
        return self._ask("respond", {"sweep": sweep, **options}, means)

    def verify(self, order: int = 4, **options: Any) -> Answer:
        """The expansion against an integration in time: the observed order of accuracy; `small`, `periods`,
        `samples`, and `digits` of the integration."""
        means = taken({name: options.pop(name) for name in list(options) if name in NAMES - {"digits"}})
        return self._ask("verify", {"order": order, **options}, means)

    def trade(self, **options: Any) -> Answer:
        """Speed against accuracy, every method and order; `orders`, `digits`, `harmonics`, `error`, `within`."""
        means = taken({name: options.pop(name) for name in list(options) if name in NAMES - {"digits"}})
        return self._ask("trade", options, means)

    def simulate(self, **options: Any) -> Answer:
        """The motion in time: `until`, `periods` or `impacts`; `times`, `state`, `history`, `section`, `skip`,
        `lyapunov=True`, `zero_one=True`, `perturb`, `branch`, `figure`."""
        means = taken(options)
        return self._ask("simulate", options, means)

    def threshold(self, sweep: Sweep | None = None, **options: Any) -> Answer:
        """Melnikov's threshold of homoclinic chaos; `zeros="vstar=0..1"`, `subharmonics`, `second_order=True`.

        With `unknown="mu"` and `order`: the parameter for which the orbit stays homoclinic, as a series.
        """
        means = taken(options)
        return self._ask("threshold", {"sweep": sweep, **options}, means)

    def stability(self, sweep: Sweep | None = None, **options: Any) -> Answer:
        """The impact orbit, its predicted and its true stability; `order`, `variant`, `kick`, `predictor`."""
        means = taken(options)
        return self._ask("stability", {"sweep": sweep, **options}, means)

    # Functions and arrays.

    def frequency_function(self, **options: Any) -> FrequencyFunction:
        """omega over the small parameter and the amplitude, for arrays; `order`, `resum`. Where no amplitude is
        given it is this oscillator's."""
        means = taken(options)
        with working(means) as work:
            made = self._case.frequency_function(_options(options), work)
            return FrequencyFunction(made, self, "frequency_function", options)

    def solution_function(self, harmonics: int = 15, **options: Any) -> SolutionFunction:
        """x(t) over the small parameter and the amplitude, for arrays, by so many harmonics; `order`, `resum`. Where
        no amplitude is given it is this oscillator's."""
        means = taken(options)
        with working(means) as work:
            options = {"harmonics": harmonics, **options}
            made = self._case.solution_function(_options(options), work)
            return SolutionFunction(made, self, "solution_function", options)

    def solution(self, harmonics: int = 15, **options: Any) -> Solution:
        """x(t) at the values set, for arrays; `order`, `resum`, `phase`."""
        means = taken(options)
        with working(means) as work:
            options = {"harmonics": harmonics, **options}
            made = self._case.periodic_solution(_options(options), work)
            return Solution(made, self, "solution", options)

    def averaged_solution(self, **options: Any) -> AveragedSolution:
        """a(t), psi(t), x(t) of the averaged motion at the values set, for arrays; `order`, and `start="A,PSI"` or
        `state="X,V"`."""
        means = taken(options)
        with working({"digits": 16, **means}) as work:
            made = self.under("free")._case.averaged_motion(_options(options), work)
            return AveragedSolution(made, self.under("free"), "averaged_solution", options)

    def _arrays(self, verb: str, sweep: Sweep, options: dict[str, Any], executor: Any, block: int | None) -> Any:
        """As arrays, on an executor by blocks of rows, or of the values of a diagram."""
        options = {"sweep": _sweep(sweep), **options}
        kind: Any = {"stability": StabilityChart, "threshold": ThresholdSurface}.get(verb, BifurcationDiagram)
        counts = [len(axis) for axis in self._case.axes(options["sweep"])]
        if options.get("follow") and executor is not None:
            raise UsageError("values that follow each other are not split", "usage", "without executor")
        if executor is None or kind is not BifurcationDiagram and len(counts) < 2:
            return kind(**_part(self, verb, options, None))
        count = counts[-1]
        block = max(1, -(-count // _BLOCKS)) if block is None else block
        parts = [(first, min(block, count - first)) for first in _starts(count, block)]
        return kind.joined(_split(executor, functools.partial(_part, self, verb, options), parts))

    def stability_chart(
        self, sweep: Sweep, executor: Any = None, block: int | None = None, **options: Any
    ) -> StabilityChart:
        """Prediction and truth over one or two parameters, as arrays; the options of `stability`, and `radius=True` for
        the largest multipliers, which cost more than the verdicts.

        With an executor or Dask client (see `grid`) by blocks of rows; bit by bit the same."""
        chart: StabilityChart = self._arrays("stability", sweep, options, executor, block)
        return chart

    def threshold_surface(
        self, sweep: Sweep, executor: Any = None, block: int | None = None, **options: Any
    ) -> ThresholdSurface:
        """The signed threshold over one or two parameters, as arrays; `executor` and `block` as for `stability_chart`."""
        surface: ThresholdSurface = self._arrays("threshold", sweep, options, executor, block)
        return surface

    def bifurcation_diagram(
        self, sweep: Sweep, executor: Any = None, block: int | None = None, **options: Any
    ) -> BifurcationDiagram:
        """The points of a section over a parameter, as arrays; `skip`, `keep`, `section`, `state`. `executor` and `block`
        as for `stability_chart`, by blocks of values; with `follow` it is not split."""
        diagram: BifurcationDiagram = self._arrays("simulate", sweep, options, executor, block)
        return diagram


def _options(options: dict[str, Any]) -> dict[str, str]:
    return {name: _text(name, value) for name, value in options.items() if value is not None}


def grid(
    oscillator: Oscillator,
    verb: str,
    values: Mapping[str, Iterable[Value] | tuple[Value, Value, int]],
    executor: Any = None,
    block: int = 16,
    **options: Any,
) -> list[Any]:
    """The answers to a question at every point of a grid, the first parameter slowest; values are a list, or a range
    `(low, high, number)` as in a sweep.

    `executor` is any `concurrent.futures.Executor` or a Dask client; points go to it in blocks of `block`,
    and the answers are those of a local run but for the seconds. A point that is refused stands as its exception.
    Processes are started with "spawn", not forked.
    """
    if not isinstance(oscillator, Oscillator):
        raise UsageError(f"{shown(oscillator)} is no oscillator", "usage", "Oscillator(...)")
    if not isinstance(verb, str) or verb not in _VERBS:
        raise UsageError(f"there is no question {shown(verb)}", "usage", ", ".join(sorted(_VERBS)))
    if not isinstance(values, Mapping):
        raise UsageError(f"{shown(values)} are no values of parameters", "usage", '{"eps": [...]}')
    names = [plain(name, "the name of a parameter") for name in values]
    ranges = {name: oscillator._case.axes(_axis(name, axis))[0] for name, axis in values.items() if isinstance(axis, tuple)}
    axes = [ranges.get(name) or several(axis, name) for name, axis in values.items()]
    points = list(itertools.product(*axes))
    blocks = [points[i : i + block] for i in _starts(len(points), block)]
    work = functools.partial(_block, oscillator, verb, names, options=options)
    return [found for part in _split(executor, work, blocks) for found in part]


_VERBS = {
    *("derive", "average", "evaluate", "prove", "respond", "verify", "trade", "simulate", "threshold", "stability"),
    *("frequency_function", "solution_function", "solution", "averaged_solution"),
}


def _starts(count: int, block: int) -> range:
    """Where blocks of so many begin."""
    if not isinstance(block, numbers.Integral) or block < 1:
        raise UsageError(f"block = {shown(block)} holds nothing", "usage", "a whole number from 1")
    return range(0, count, block)


# Of a chart without `block`: enough for some tens of workers, few enough for what a block costs beside its work.
_BLOCKS = 64


def _part(oscillator: Oscillator, verb: str, options: dict[str, Any], part: tuple[int, int] | None) -> dict[str, Any]:
    options = {**options, "part": part}
    means = taken(options)
    with working({"doubles": True, **means}) as work:
        return oscillator._case.arrays(verb, _options(options), work)


def _split(executor: Any, work: Callable[[Any], Any], parts: list[Any]) -> list[Any]:
    """The results of all parts, here, on an executor or by a Dask client."""
    if executor is None:
        return [work(part) for part in parts]
    if hasattr(executor, "get_executor"):
        return _on_dask(executor, work, parts)
    if not hasattr(executor, "submit"):
        raise UsageError(f"{shown(executor)} is no executor", "usage", "a concurrent.futures.Executor or a Dask client")
    futures = [executor.submit(work, part) for part in parts]
    return [future.result() for future in futures]


def _on_dask(client: Any, work: Callable[[Any], Any], parts: list[Any]) -> list[Any]:
    """The results of all parts. Each is fetched when it is finished and given up on the cluster: a worker that is killed
    later takes nothing with it but what it is working on."""
    from distributed import as_completed

    futures = [client.submit(work, part, pure=False) for part in parts]
    places = {future.key: place for place, future in enumerate(futures)}
    found: list[Any] = [None] * len(parts)
    try:
        for future, result in as_completed(futures, with_results=True):  # type: ignore[no-untyped-call]
            found[places[future.key]] = result
            future.release()
    finally:
        client.cancel([future for future in futures if not future.done()])
    return found


def _block(
    oscillator: Oscillator, verb: str, names: list[str], points: list[tuple[Value, ...]], options: dict[str, Any]
) -> list[Any]:
    found: list[Any] = []
    for point in points:
        try:
            case = oscillator.set(**dict(zip(names, point)))
            found.append(getattr(case, verb)(**options))
        except LindstedtError as error:
            found.append(error)
    return found
