"""The notebook, run as a reader would run it."""

from pathlib import Path

import nbformat
from nbclient import NotebookClient

NOTEBOOK = Path(__file__).parents[1] / "notebooks" / "first_look.ipynb"


def test_the_notebook_runs(recorded, tmp_path, monkeypatch):
    monkeypatch.setenv("RECORDING", str(recorded("openxr")))
    monkeypatch.setenv("MPLBACKEND", "agg")
    notebook = nbformat.read(NOTEBOOK, as_version=4)
    NotebookClient(notebook, timeout=120, resources={"metadata": {"path": str(tmp_path)}}).execute()
    printed = "".join(output.get("text", "") for cell in notebook.cells for output in cell.get("outputs", []))
    assert "typed: hi" in printed
    assert "qwerty-flat-22: " in printed


def test_the_page_shows_the_notebook():
    """`notebooks/write_page.py` writes the page."""
    page = (NOTEBOOK.parents[2] / "docs" / "first-look.md").read_text(encoding="utf-8")
    for cell in nbformat.read(NOTEBOOK, as_version=4).cells:
        if cell.cell_type == "code":
            assert cell.source in page
