"""Answers as plain data that shows itself."""

from __future__ import annotations

import csv
import io
import json
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from ._errors import NoAnswerError, UsageError
from ._native import Found
from ._numbers import Number, Series, read, shown

_FORMATS = ("text", "latex", "markdown", "html")


@dataclass(frozen=True)
class Figure:
    """A figure as SVG text; a notebook draws it."""

    svg: str

    def _repr_svg_(self) -> str:
        return self.svg

    def save(self, path: str) -> None:
        """Writes it to a file."""
        with open(path, "w", encoding="utf-8") as file:
            file.write(self.svg)


class Answer:
    """What a question is answered with: the keys of its JSON form, by index or as attributes, numbers
    as `Number`. `standing` is `complete`, or says how far the answer goes."""

    def __init__(self, found: Found) -> None:
        self._found: Found | None = found
        self._kept: dict[str, str | None] = {}
        self._data: dict[str, Any] = json.loads(found.json())
        self._read: dict[str, Any] = read(self._data)

    # What stands in every header.
    problem: str
    equation: str
    tier: str
    seconds: float
    standing: str

    @property
    def at(self) -> dict[str, str]:
        """The exact values that enter."""
        return dict(self._data["at"])

    @property
    def order(self) -> int | None:
        """The order of the expansion, where one is made."""
        order: int | None = self._data.get("order")
        return order

    @property
    def remarks(self) -> list[str]:
        """What is to be said beside the answer."""
        return list(self._data.get("remarks", []))

    @property
    def is_complete(self) -> bool:
        """Whether the answer is all that was asked for."""
        return bool(self._data["standing"] == "complete")

    def __getitem__(self, key: str) -> Any:
        return self._read[key]

    def __contains__(self, key: object) -> bool:
        return key in self._read

    def __getattr__(self, name: str) -> Any:
        try:
            return self.__dict__["_read"][name]
        except KeyError:
            raise AttributeError(f"this answer has no {name}") from None

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._read]

    def to_dict(self) -> dict[str, Any]:
        """The answer as the program's JSON, as plain data."""
        copy: dict[str, Any] = json.loads(json.dumps(self._data))
        return copy

    def to_json(self) -> str:
        """The same as text."""
        return json.dumps(self._data, indent=2)

    def _form(self, name: str) -> str | None:
        if name not in self._kept and self._found is not None:
            found = self._found
            made = found.svg() if name == "svg" else found.csv() if name == "csv" else found.page(name)
            self._kept[name] = made
        return self._kept[name]

    def page(self, format: str = "text") -> str:
        """The answer as a page: text, latex, markdown or html."""
        if not isinstance(format, str) or format not in _FORMATS:
            raise UsageError(f"there is no format {shown(format)}", "usage", ", ".join(_FORMATS))
        return self._form(format) or ""

    def __str__(self) -> str:
        return self.page()

    def __repr__(self) -> str:
        return f"<{type(self).__name__} of {self.problem}: {self.standing}>"

    def _repr_html_(self) -> str:
        return self.page("html") + (self._form("svg") or "")

    def _repr_markdown_(self) -> str:
        return self.page("markdown")

    def _repr_svg_(self) -> str | None:
        return self._form("svg")

    @property
    def figure(self) -> Figure | None:
        """The figure, where there is something to draw."""
        svg = self._form("svg")
        return None if svg is None else Figure(svg)

    def table(self) -> dict[str, list[Any]]:
        """The table behind the figure by columns: ready for `pandas.DataFrame`."""
        rows = list(csv.reader(io.StringIO(self._form("csv") or "")))
        return {name: [_cell(row[i]) for row in rows[1:]] for i, name in enumerate(rows[0])} if rows else {}

    def to_pandas(self) -> Any:
        """The same as a DataFrame."""
        import pandas

        return pandas.DataFrame(self.table())

    def plot(self, ax: Any = None, **style: Any) -> Any:
        """Draws the table over its first column of numbers with matplotlib, one line per column, of branches and orbits one each.
        Errors are not drawn."""
        columns = {n: numbers for n, c in self.table().items() if (numbers := _drawn(n, c))}
        parts = next((columns.pop(n) for n in ("branch", "orbit") if n in columns), None)
        if not columns:
            hint = "evaluate with times or a sweep, simulate, respond with a sweep"
            raise NoAnswerError("this answer has no table of numbers to draw", "figure", hint)
        import matplotlib.pyplot as plt

        ax = ax if ax is not None else plt.gca()
        (name, across), *rest = columns.items()
        for part in sorted(set(parts or [0.0])):
            inside = [parts is None or place == part for place in parts or across]
            for k, (label, column) in enumerate(rest):
                line = [[x for x, drawn in zip(c, inside) if drawn] for c in (across, column)]
                first = part == min(parts or [0.0])
                ax.plot(*line, label=label if first else None, **{"color": f"C{k % 10}", **style})
        ax.set_xlabel(name)
        if rest:
            ax.legend()
        return ax

    def __getstate__(self) -> dict[str, Any]:
        for name in (*_FORMATS, "svg", "csv"):
            self._form(name)
        return {"kept": self._kept, "data": self._data}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(_found=None, _kept=state["kept"], _data=state["data"])
        self._read = read(self._data)


def _drawn(name: str, column: list[Any]) -> list[float] | None:
    """A column as numbers; None of what is not drawn."""
    if name.endswith("error") or name == "refused":
        return None
    try:
        numbers = [float(Fraction(x)) if isinstance(x, str) else float(x) for x in column]
    except (TypeError, ValueError, ZeroDivisionError):
        return None
    return numbers if any(x == x for x in numbers) else None


def _cell(text: str) -> Any:
    try:
        return float(text)
    except ValueError:
        return text if text else float("nan")


class Derivation(Answer):
    """An expansion: series by name, the solution order by order."""

    @property
    def series(self) -> dict[str, Series]:
        """The series by name whose coefficients are numbers: frequency, frequency_squared, period_over_2pi, ...
        What depends on the amplitude, as the rates of averaging, is in `answer["series"]`."""
        parameter = str(self._data.get("parameter", "eps"))
        found: dict[str, Any] = self._read.get("series", {})
        numbers = {name: item for name, item in found.items() if isinstance(item, list)}
        numbers = {name: item for name, item in numbers.items() if all(isinstance(x, Number) for x in item)}
        return {name: Series(parameter, coefficients) for name, coefficients in numbers.items()}

    @property
    def frequency(self) -> Series:
        """The series of omega."""
        found = self.series.get("frequency")
        if found is None:
            hint = f"its series: {', '.join(self._read.get('series', {})) or 'none'}"
            raise NoAnswerError("this expansion has no series of a frequency in numbers", "no-series", hint)
        return found

    def table(self) -> dict[str, list[Any]]:
        """The coefficients of the series in numbers, order by order: ready for `pandas.DataFrame`."""
        series = {name: [float(number) for number in found] for name, found in self.series.items()}
        longest = max(map(len, series.values()), default=0)
        padded = {name: column + [float("nan")] * (longest - len(column)) for name, column in series.items()}
        return {"order": list(range(longest)), **padded} if series else {}

    def _repr_latex_(self) -> str | None:
        names = {"frequency": r"\omega", "frequency_squared": r"\omega^2", "period_over_2pi": r"T/2\pi"}
        lines = [f"{names.get(name, name)} &= {series.latex()}" for name, series in self.series.items()]
        return r"$\displaystyle\begin{aligned}" + r"\\ ".join(lines) + r"\end{aligned}$" if lines else None

    def to_sympy(self) -> dict[str, Any]:
        """All series as expressions."""
        return {name: series.to_sympy() for name, series in self.series.items()}
