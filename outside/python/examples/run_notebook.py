"""Runs the notebooks of this folder from their first cell to their last; an error of a cell ends it.

Says that it skips where nbclient or ipykernel is missing. `python examples/run_notebook.py`
"""

import pathlib
import sys

try:
    import ipykernel  # noqa: F401
    import nbclient
    import nbformat
except ImportError as missing:
    print(f'skipped: {missing}; pip install "haptical[notebook]"')
    sys.exit(0)

for path in sorted(pathlib.Path(__file__).parent.glob("*.ipynb")):
    notebook = nbformat.read(path, as_version=4)
    nbclient.NotebookClient(notebook, timeout=600, kernel_name="python3").execute()
    cells = [cell for cell in notebook.cells if cell.cell_type == "code"]
    kinds = {kind for cell in cells for output in cell.outputs for kind in output.get("data", {})}
    print(f"{path.name}: {len(cells)} cells ran; shown: {', '.join(sorted(kinds))}")
