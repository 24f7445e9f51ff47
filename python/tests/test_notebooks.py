"""The notebooks of the book are its pages, cell by cell, and run. `UPDATE_REFERENCE=1` writes them anew."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

import pytest

BOOK = Path(__file__).parents[2] / "docs/src/notebooks"


def notebook(page: str) -> str:
    """A page as a notebook without outputs: its Python blocks are the cells of code."""
    cells: list[dict[str, Any]] = []
    for number, part in enumerate(page.split("```")):
        code = number % 2 == 1
        text = (part.removeprefix("python\n") if code else part).strip()
        if text:
            rest: dict[str, Any] = {"execution_count": None, "outputs": []} if code else {}
            kind = "code" if code else "markdown"
            cells.append({"cell_type": kind, "metadata": {}, "source": text.splitlines(keepends=True), **rest})
    kernel = {"display_name": "Python 3", "language": "python", "name": "python3"}
    made = {"cells": cells, "metadata": {"kernelspec": kernel}, "nbformat": 4, "nbformat_minor": 4}
    return json.dumps(made, indent=1) + "\n"


@pytest.mark.parametrize("name", ["paper", "response", "van-der-pol", "stability-chart"])
def test_a_notebook_is_its_page_and_runs(name: str) -> None:
    kept, made = BOOK / f"{name}.ipynb", notebook((BOOK / f"{name}.md").read_text("utf-8"))
    if os.environ.get("UPDATE_REFERENCE"):
        kept.write_text(made, "utf-8")
    assert kept.read_text("utf-8") == made
    nbformat, nbclient = pytest.importorskip("nbformat"), pytest.importorskip("nbclient")
    nbclient.NotebookClient(nbformat.reads(made, 4), timeout=200, kernel_name="python3").execute()
