"""Refusals: why there is no answer, with a code for programs and a hint for people."""

from __future__ import annotations

import re


class LindstedtError(Exception):
    """A refusal: `code` does not change between versions, `hint` says what to do about it."""

    def __init__(self, message: str, code: str = "", hint: str = "") -> None:
        super().__init__(message)
        self.message = message
        self.code = code
        self.hint = hint

    def __str__(self) -> str:
        return f"{self.message} [{self.code}]\nhint: {self.hint}" if self.hint else self.message

    def __reduce__(self) -> tuple[type[LindstedtError], tuple[str, str, str]]:
        return type(self), (self.message, self.code, self.hint)


class UsageError(LindstedtError, ValueError):
    """The question makes no sense as it is put."""


class NoAnswerError(LindstedtError):
    """There is no such value, and the message says why."""


class UndecidedError(LindstedtError):
    """It could not be decided, or not with the digits, the memory or the time given."""


class StoppedError(LindstedtError):
    """The work was stopped before anything was finished."""


_KINDS: dict[str, type[LindstedtError]] = {
    "usage": UsageError,
    "no answer": NoAnswerError,
    "undecided": UndecidedError,
    "interrupted": StoppedError,
}


# Options of the command line that are called otherwise here.
_NAMES = {"limit-seconds": "seconds", "limit-memory": "memory", "f64": "doubles", "normalisation": "under"}

# What the command line says otherwise than by an option.
_WORDS = [
    (r"`lindstedt problems --show [A-Z]+`", "`describe()`"),
    (r"`lindstedt problems --show ([a-z-]+)`", r'`print(Oscillator.builtin("\1").describe()["file"])`'),
    (r"`lindstedt problems`", "`describe()`"),
    (r"`lindstedt VERB --help`", "`help(Oscillator)`"),
    (r"`lindstedt ([^`]*)`", r"`\1`"),
    (r"--normalisation ([a-z]+)", r'under("\1")'),
    (r"--set ([A-Za-z_]\w*)=([^\s,;`]+)", r"set(\1=\2)"),
]


def _as_python(text: str) -> str:
    """A message or hint in the words of this package: `set(NAME=VALUE)`, keywords without dashes."""
    for theirs, ours in _WORDS:
        text = re.sub(theirs, ours, text)

    def option(found: re.Match[str]) -> str:
        name, value = _NAMES.get(found[1], found[1]).replace("-", "_"), found[2]
        if value is None:
            return name
        return f"{name}={value}" if re.fullmatch(r"[\d.e+-]+|[A-Z]+|\".*\"", value) else f'{name}="{value}"'

    return re.sub(r"(?<![^\s`(])--([a-z][a-z0-9-]*)(?:[ =](\"[^\"]*\"|[\dA-Z+-][^\s`;)]*[^\s`;),.:?]|[\dA-Z]))?", option, text)


def refusal(kind: str, code: str, message: str, hint: str) -> LindstedtError:
    """The exception for a refusal of that kind."""
    return _KINDS.get(kind, LindstedtError)(_as_python(message), code, _as_python(hint))
