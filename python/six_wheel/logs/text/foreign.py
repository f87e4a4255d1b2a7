"""Files that are packed, and files that are no tables of text."""

import bz2
import gzip
import lzma
from collections.abc import Callable, Mapping
from typing import Any

PACKED: Mapping[bytes, Callable[[Any], Any]] = {
    b"\x1f\x8b": gzip.open,
    b"BZh": bz2.open,
    b"\xfd7zXZ": lzma.open,
}
IN_PYTHON = 'read it in Python and give its columns, as dead_reckon(rover, {"time": ..., "left [rad]": ...})'
FOREIGN: Mapping[bytes, str] = {
    b"PK\x03\x04": "an office document or an archive: save it as CSV (UTF-8), or unpack it",
    b"\xd0\xcf\x11\xe0": "an office document: save it as CSV (UTF-8)",
    b"PAR1": "Parquet: let its name end in .parquet",
    b"ARROW1": "Arrow: let its name end in .arrow",
    b"\x89HDF": f"HDF5: {IN_PYTHON}",
    b"MATLAB": f"a MATLAB file: {IN_PYTHON}",
    b"\x93NUMPY": f"an array of NumPy: {IN_PYTHON}",
    b'{"': "JSON: let its name end in .jsonl, with one object in a line",
    b"[{": "JSON: make it .jsonl, with one object in a line, or give a frame of it to dead_reckon",
    b"<": "a page of the web or XML",
}


def other_form(ending: str) -> str:
    """Line about what to do with a file that nothing here reads."""
    if ending in (".xlsx", ".xls", ".xlsm", ".ods"):
        return "save it as CSV (UTF-8), a file for each sheet"
    if ending in (".zip", ".7z", ".rar", ".tar", ".tgz", ".zst"):
        return "unpack it"
    if ending in (".mat", ".npz", ".npy", ".h5", ".hdf5", ".pkl", ".json", ".tdms", ".ulg"):
        return f"{IN_PYTHON}, or a DataFrame"
    return "if it is a table of text, let its name end in .csv or .txt"
