"""Exact values on the way in, numbers with their class on the way out."""

from __future__ import annotations

import importlib.util
import math
import numbers
from collections.abc import Sequence
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from typing import Any, Union

import numpy

from ._errors import UsageError

Value = Union[int, Fraction, Decimal, float, str, Any]
"""An exact value: int, Fraction, Decimal, str (`"1/3"`, `"pi/4"`, `"2.5e-3"`), a SymPy number; a
float is its shortest decimal, what was typed: 0.1 is 1/10, not 0x1.999999999999ap-4; NumPy's single ones likewise."""


def exact(value: Value) -> str:
    """The text of an exact value.

    >>> exact(0.1), exact(Fraction(1, 3)), exact("2**3")
    ('0.1', '1/3', '2^3')
    """
    if isinstance(value, numpy.ndarray) and value.ndim == 0:
        value = value[()]
    if isinstance(value, bool):
        raise UsageError(f"{value!r} is no number", "value", "an int, Fraction, str, Decimal or float")
    if isinstance(value, str):
        return value.replace("**", "^")
    if isinstance(value, numbers.Integral):
        return str(int(value))
    if isinstance(value, Fraction):
        return f"{value.numerator}/{value.denominator}"
    if isinstance(value, Decimal) and value.is_finite():
        return str(value).lower()
    if isinstance(value, numbers.Real):
        number = float(value)
        if math.isfinite(number):
            # A single precision number has a shorter decimal than the double that it is.
            return str(value) if isinstance(value, numpy.floating) else repr(number)
    if hasattr(value, "as_coeff_Mul") and hasattr(value, "free_symbols") and not value.free_symbols:
        coefficient, rest = value.as_coeff_Mul()
        if rest == 1 or str(rest) == "pi":
            text = str(coefficient)
            return text if rest == 1 else f"{text}*pi"
    raise UsageError(
        f"{value!r} is no exact number", "value", "an int, Fraction, str, Decimal, float or SymPy number"
    )


@dataclass(frozen=True)
class Number:
    """A number: `exact` in closed form or nothing, `decimal` with as many digits as are known, `error` a
    bound of its distance from the truth, `status` one of exact, certified, proved, estimated."""

    exact: str | None
    decimal: str
    error: str | None
    status: str

    def __float__(self) -> float:
        return float(self.decimal)

    def __str__(self) -> str:
        return self.exact or self.decimal

    @property
    def fraction(self) -> Fraction | None:
        """The rational number that it is, or nothing."""
        try:
            return Fraction(self.exact) if self.exact is not None else None
        except ValueError:
            return None

    def to_mpmath(self) -> Any:
        """As mpmath.mpf with all digits of the decimal, whatever mpmath's own precision is."""
        import mpmath

        with mpmath.workdps(max(len(self.decimal), 15)):
            return mpmath.mpf(self.decimal)

    def to_sympy(self) -> Any:
        """The closed form, else the decimal with its digits."""
        import sympy

        if self.exact is None or " = " in self.exact or ", " in self.exact:
            return sympy.Float(self.decimal, max(len(self.decimal), 15))
        return sympy.sympify(self.exact.replace("^", "**"), locals={"ln": sympy.log})

    def latex(self) -> str:
        """In LaTeX: a fraction, else what SymPy makes of the closed form, else the decimal."""
        fraction = self.fraction
        if fraction is not None:
            sign, size = "-" if fraction < 0 else "", abs(fraction)
            whole = size.denominator == 1
            return sign + (str(size) if whole else rf"\frac{{{size.numerator}}}{{{size.denominator}}}")
        if self.exact is None or importlib.util.find_spec("sympy") is None:
            mantissa, _, exponent = self.decimal.partition("e")
            return rf"{mantissa}\cdot 10^{{{exponent}}}" if exponent else mantissa
        import sympy

        text: str = sympy.latex(self.to_sympy())
        return rf"\left({text}\right)"

    def _repr_latex_(self) -> str:
        return f"${self.latex()}$"


class Series(Sequence[Number]):
    """Coefficients from order 0 of a series in `parameter`.

    >>> s = Series("eps", [Number("1", "1.0", None, "exact"), Number("3/8", "0.375", None, "exact")])
    >>> s.fractions
    [Fraction(1, 1), Fraction(3, 8)]
    """

    def __init__(self, parameter: str, coefficients: Sequence[Number]) -> None:
        self.parameter = parameter
        self.coefficients = list(coefficients)

    def __len__(self) -> int:
        return len(self.coefficients)

    def __getitem__(self, index: Any) -> Any:
        return self.coefficients[index]

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Series):
            return NotImplemented
        return (self.parameter, self.coefficients) == (other.parameter, other.coefficients)

    def __repr__(self) -> str:
        return f"Series({self.parameter!r}: {', '.join(map(str, self.coefficients))})"

    @property
    def fractions(self) -> list[Fraction | None]:
        """The rational coefficients; nothing for those that are irrational."""
        return [number.fraction for number in self.coefficients]

    def to_numpy(self) -> Any:
        """The coefficients as doubles."""
        import numpy

        return numpy.array([float(number) for number in self.coefficients])

    def to_sympy(self) -> Any:
        """The truncated series as an expression."""
        import sympy

        x = sympy.Symbol(self.parameter)
        return sum((c.to_sympy() * x**n for n, c in enumerate(self.coefficients)), sympy.Integer(0))

    def latex(self) -> str:
        """In LaTeX, terms that vanish left out."""
        greek = {"eps": r"\varepsilon"}
        letters = {"rho", "delta", "mu", "epsilon", "lambda"}
        x = greek.get(self.parameter, f"\\{self.parameter}" if self.parameter in letters else self.parameter)
        text = ""
        for n, number in enumerate(self.coefficients):
            if number.fraction == 0:
                continue
            power = "" if n == 0 else x if n == 1 else f"{x}^{{{n}}}"
            term = number.latex()
            if power and term in ("1", "-1"):
                term = term[:-1]
            text += term + power if not text or term.startswith("-") else f" + {term}{power}"
        return text or "0"

    def _repr_latex_(self) -> str:
        return f"${self.latex()}$"


def read(value: Any) -> Any:
    """JSON with its numbers as `Number`."""
    if isinstance(value, dict):
        if {"exact", "decimal", "error", "status"} == value.keys() and value["decimal"] is not None:
            return Number(value["exact"], value["decimal"], value["error"], value["status"])
        return {key: read(item) for key, item in value.items()}
    return [read(item) for item in value] if isinstance(value, list) else value
