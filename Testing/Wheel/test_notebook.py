# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Runs the notebook of Examples/Notebook in its own folder, as people do: it must print the texts and draw the pictures that are stored in it.

    test_notebook.py [write]
write: stores what it prints and draws now. Look at the pictures then.
"""
import base64
import io
import os
import sys
from pathlib import Path

import nbformat
import numpy as np
from nbclient import NotebookClient
from PIL import Image

SOURCES = Path(os.environ["MCOR_TEST_SOURCES"])
FILE = SOURCES / "Examples" / "Notebook" / "dam_break.ipynb"


def texts(cell):
    """Returns the texts that the cell prints and shows, without what drivers write to stderr."""
    return "".join(output["text"] if output.output_type == "stream" else output.get("data", {}).get("text/plain", "")
                   for output in cell.get("outputs", []) if output.get("name") != "stderr"
                   and "image/png" not in output.get("data", {}))


def pictures(cell):
    return [np.asarray(Image.open(io.BytesIO(base64.b64decode(output["data"]["image/png"]))).convert("RGB"), float)
            for output in cell.get("outputs", []) if "image/png" in output.get("data", {})]


def run(notebook):
    NotebookClient(notebook, timeout=900, kernel_name="python3",
                   resources={"metadata": {"path": str(FILE.parent)}}).execute()
    for cell in notebook.cells:
        cell.metadata = {}
        if cell.cell_type == "code":
            cell.outputs = [output for output in cell.outputs if output.get("name") != "stderr"]
    return notebook


def main():
    kept = nbformat.read(FILE, 4)
    metadata = kept.metadata.copy()
    now = run(nbformat.read(FILE, 4))
    if sys.argv[1:] == ["write"]:
        now.metadata = metadata
        nbformat.write(now, FILE)
        return
    drawn = 0
    for old, new in zip(kept.cells, now.cells):
        assert texts(new) == texts(old), f"it says now\n{texts(new)}\nfor\n{texts(old)}"
        assert len(pictures(new)) == len(pictures(old))
        for picture, expected in zip(pictures(new), pictures(old)):
            assert picture.shape == expected.shape
            differ = np.mean(np.abs(picture - expected).max(axis=2) > 40)  # Renderers and fonts differ a little.
            background = np.mean((picture == picture[0, 0]).all(axis=2))
            print(f"{100 * differ:.1f} % of the pixels differ, {100 * background:.0f} % are background")
            assert differ < 0.05 and 0.3 < background < 0.97
            drawn += 1
    assert drawn == 3 and FILE.stat().st_size < 200_000, (drawn, FILE.stat().st_size)


if __name__ == "__main__":
    main()
