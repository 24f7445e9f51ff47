"""Exact values on the way in, numbers with their class on the way out."""

from __future__ import annotations

import importlib.util
import math
import numbers
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from typing import Any, Union

import numpy

from ._errors import UsageError

Value = Union[int, Fraction, Decimal, float, str, Any]
"""An exact value: int, Fraction, Decimal, str (`"1/3"`, `"pi/4"`, `"2.5e-3"`), a SymPy number; a
float is its shortest decimal, what was typed: 0.1 is 1/10, not 0x1.999999999999ap-4; NumPy's single ones likewise.
Numbers of mpmath and Floats of SymPy that are doubles count as these; those with more bits are what they are."""

# More than are read.
_MOST_BITS = 3_300_000


def shown(value: Any) -> str:
    """A value in a message."""
    try:
        text = repr(value)
    except Exception:  # Of a long integer, and whatever others do.
        text = f"<{type(value).__name__}>"
    return text if len(text) <= 80 else text[:77] + "..."


def plain(text: Any, example: str) -> str:
    """Refuses what is no text, and text with half a character."""
    try:
        if isinstance(text, str):
            text.encode()
            return text
    except UnicodeEncodeError:
        pass
    raise UsageError(f"{shown(text)} is no text", "usage", example)


def several(values: Any, name: str) -> list[Any]:
    """Values that are a list."""
    if isinstance(values, (str, bytes)) or not isinstance(values, Iterable) or getattr(values, "ndim", 1) == 0:
        raise UsageError(f"{name}: {shown(values)} is no list of values", "usage", f"[{shown(values)}]")
    return list(values)


def each(values: Any) -> list[Any]:
    """The values of an array, or of lists in lists, or the only one."""
    if isinstance(values, numpy.ndarray):
        return list(values.ravel())
    if isinstance(values, (str, bytes)) or not isinstance(values, Iterable):
        return [values]
    return [value for part in values for value in each(part)]


def exact(value: Value) -> str:
    """The text of an exact value.

    >>> exact(0.1), exact(Fraction(1, 3)), exact("2**3")
    ('0.1', '1/3', '2^3')
    """
    if isinstance(value, numpy.ndarray) and value.ndim == 0:
        value = value[()]
    if isinstance(value, str):
        return plain(value, "1/3").replace("**", "^")
    if isinstance(value, Decimal) and value.is_finite():
        return str(value).lower()
    if isinstance(value, numpy.longdouble) and math.isfinite(value) and value != float(value):
        value = Fraction(*value.as_integer_ratio())
    if isinstance(value, (float, numpy.floating)) and math.isfinite(value):
        # A single precision number has a shorter decimal than the double that it is.
        return str(value) if isinstance(value, numpy.floating) else repr(float(value))
    if isinstance(value, numbers.Real) and hasattr(value, "_mpf_") and not hasattr(value, "name"):
        sign, mantissa, exponent, bits = map(int, value._mpf_)
        mantissa = -mantissa if sign else mantissa
        if bits <= 53 and -1074 <= exponent <= 1024 - bits and (mantissa or not exponent):
            return repr(math.ldexp(mantissa, exponent))
        if mantissa and abs(exponent) <= _MOST_BITS:
            value = mantissa * Fraction(2) ** exponent
    if isinstance(value, numbers.Rational) and not isinstance(value, bool):
        parts = [int(value.numerator), int(value.denominator)]
        if max(part.bit_length() for part in parts) <= _MOST_BITS:
            # `str` takes no long integer.
            above, below = (str(Decimal(part)) for part in parts)
            return above if isinstance(value, numbers.Integral) else f"{above}/{below}"
    if hasattr(value, "as_coeff_Mul") and not getattr(value, "free_symbols", True):
        coefficient, rest = value.as_coeff_Mul()
        if str(rest) == "pi":
            return f"{exact(coefficient)}*pi"
    raise UsageError(
        f"{shown(value)} is no exact number", "value", "an int, Fraction, str, Decimal, float or SymPy number"
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
    """JSON with its numbers as `Number`; None for those of which not one digit is known."""
    if isinstance(value, dict):
        if {"exact", "decimal", "error", "status"} == value.keys() and value["decimal"] is not None:
            return Number(value["exact"], value["decimal"], value["error"], value["status"])
        # A formula in symbols has no decimal; a number without one has no digit.
        unknown = {"decimal", "status"} <= value.keys() and value.get("exact") is value["decimal"] is None
        return None if unknown else {key: read(item) for key, item in value.items()}
    return [read(item) for item in value] if isinstance(value, list) else value
