"""Perturbation expansions of nonlinear oscillators, to any order, in exact arithmetic, each substituted
back into its equation.

>>> import lindstedt
>>> duffing = lindstedt.Oscillator("x'' + x + eps*x**3 = 0")
>>> print(duffing.derive(3).frequency)
Series('eps': 1, 3/8, -21/256, 81/2048)
"""

from __future__ import annotations

import json
from typing import Any

from . import _native
from ._answers import Answer, Derivation, Figure
from ._arrays import (
    AveragedSolution,
    BifurcationDiagram,
    FrequencyFunction,
    Solution,
    SolutionFunction,
    StabilityChart,
    ThresholdSurface,
)
from ._errors import LindstedtError, NoAnswerError, StoppedError, UndecidedError, UsageError
from ._native import __version__
from ._numbers import Number, Series, Value
from ._oscillator import Oscillator, grid

__all__ = [
    "Answer",
    "AveragedSolution",
    "BifurcationDiagram",
    "Derivation",
    "Figure",
    "FrequencyFunction",
    "LindstedtError",
    "NoAnswerError",
    "Number",
    "Oscillator",
    "Series",
    "Solution",
    "SolutionFunction",
    "StabilityChart",
    "StoppedError",
    "ThresholdSurface",
    "UndecidedError",
    "UsageError",
    "Value",
    "__version__",
    "grid",
    "problems",
]


def problems() -> list[dict[str, Any]]:
    """The built-in problems: name, equation, parameters with their meaning and defaults."""
    listed: list[dict[str, Any]] = json.loads(_native.problems())["problems"]
    return listed
