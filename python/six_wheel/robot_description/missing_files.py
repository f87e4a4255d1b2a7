"""The message for a file that is not there, with a hint at one that may be meant."""

import difflib
from os import PathLike
from pathlib import Path

NAMED = 3  # files of the same ending that are named


def no_file(path: str | PathLike[str]) -> str:
    """The message for a path where no file is."""
    return f"{path}: no such file{near_file(Path(path))}"


def near_file(path: Path) -> str:
    """A hint for a path where no file is: a file of the same folder, or the folder that is missing.

    The file has the nearest name, or those of the same ending are named where they are few. Empty where the
    path is a file, or nothing is near.
    """
    try:
        if path.exists():
            return ""
        if not path.parent.is_dir():
            return f'; there is no folder "{path.parent}"'
        names = sorted(each.name for each in path.parent.iterdir())
    except (OSError, ValueError):  # a folder that nobody may read
        return ""
    folded = {name.casefold(): name for name in names}
    if close := difflib.get_close_matches(path.name.casefold(), folded, 1):
        return f'; did you mean "{path.with_name(folded[close[0]])}"?'
    ending = path.suffix.casefold()
    alike = [str(path.with_name(name)) for name in names if ending and name.casefold().endswith(ending)]
    if not 0 < len(alike) <= NAMED:
        return ""
    return f"; there {'is' if len(alike) == 1 else 'are'} {', '.join(alike)}"
