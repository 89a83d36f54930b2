"""Runs the notebook and writes docs/first-look.md with its pictures.

Needs `pip install './python[test]' nbconvert`, the program in ADEMAN, and a recording in RECORDING.
"""

import os
import re
from pathlib import Path

import nbformat
from nbclient import NotebookClient
from nbconvert import MarkdownExporter

FOLDER = Path(__file__).parent
DOCS = FOLDER.parents[1] / "docs"


def main():
    os.environ.pop("MPLBACKEND", None)
    notebook = nbformat.read(FOLDER / "first_look.ipynb", as_version=4)
    NotebookClient(notebook, timeout=300).execute()
    page, resources = MarkdownExporter().from_notebook_node(notebook)
    in_order = sorted(resources["outputs"].items(), key=lambda output: [int(part) for part in re.findall(r"\d+", output[0])])
    for number, (name, picture) in enumerate(in_order, 1):
        file = f"pictures/first-look-{number}.png"
        (DOCS / file).write_bytes(picture)
        page = page.replace(f"![png]({name})", f"![Picture {number} of the notebook]({file})")
    # A reader of Markdown has a style of its own for tables.
    page = re.sub(r"<style scoped>.*?</style>\n", "", page, flags=re.DOTALL)
    page = page.replace("../../docs/", "")
    page = re.sub(r"\n[ \n]*\n", "\n\n", page)
    (DOCS / "first-look.md").write_text(page, encoding="utf-8")


if __name__ == "__main__":
    main()
