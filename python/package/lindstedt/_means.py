"""Digits, memory, time, and whom to tell."""

from __future__ import annotations

import math
import numbers
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from ._errors import UsageError
from ._native import Means
from ._numbers import shown

NAMES = {"digits", "doubles", "memory", "seconds", "progress"}
_COUNTS = {"digits": 10_000, "memory": 2**63 - 1}


def taken(options: dict[str, Any]) -> dict[str, Any]:
    """Takes digits, doubles, memory, seconds and progress out of the options; what is nothing is as usual."""
    means = {name: options.pop(name) for name in NAMES if name in options}
    means = {name: value for name, value in means.items() if value is not None}
    for name, value in means.items():
        if name == "doubles" and not isinstance(value, bool):
            raise UsageError(f"doubles = {shown(value)} is no flag", "usage", "True or False")
        if name in ("digits", "memory", "seconds"):
            means[name] = _number(name, value)
    return means


def _number(name: str, value: Any) -> float:
    real = isinstance(value, numbers.Real) and not isinstance(value, bool)
    if not real:
        raise UsageError(f"{name} = {shown(value)} is no number", "usage", f"{name}=30")
    try:
        number = float(value)
    except OverflowError:
        number = math.inf if value > 0 else -math.inf
    if name == "seconds":
        return number
    if not (math.isfinite(number) and value == int(value) and 1 <= value <= _COUNTS[name]):
        raise UsageError(f"{name} = {shown(value)} is out of range", name, f"a whole number from 1 to {_COUNTS[name]}")
    whole: int = int(value)
    return whole


@contextmanager
def working(means: dict[str, Any]) -> Iterator[Means]:
    """For a question."""
    progress = means.pop("progress", False)
    with _bar(progress) as told:
        yield Means(progress=told, **means)


def limited(limits: dict[str, float], digits: int = 30) -> Means:
    """For arrays: `seconds` and `memory`."""
    for name in limits:
        if name not in ("seconds", "memory"):
            raise UsageError(f"arrays have no option {name}", "usage", "seconds, memory")
    # Of a single point the rest takes as long as the point.
    return Means(digits, **taken(dict(limits))) if limits else Means(digits)


@contextmanager
def _bar(show: bool | Callable[[str, int, int], None]) -> Iterator[Callable[[str, int, int], None] | None]:
    """What is told of the work: a function, or a bar of tqdm where that is installed."""
    if not show or callable(show):
        yield show or None
        return
    try:
        from tqdm.auto import tqdm
    except ImportError:
        yield None
        return
    with tqdm(leave=False) as bar:

        def told(words: str, done: int, parts: int) -> None:
            bar.total = parts or None
            bar.set_description_str(words, refresh=False)
            bar.n = done
            bar.refresh()

        yield told
