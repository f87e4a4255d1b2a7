"""`six-wheel example`: files to try the commands on."""

from importlib import resources
from pathlib import Path
from typing import Annotated

import typer

from six_wheel.robot_description.named_rover import closest


def example(
    name: Annotated[
        str | None, typer.Argument(metavar="NAME", help="Which one; without it, what there is.")
    ] = None,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="Where it goes. Default: its name, in this folder.")
    ] = None,
) -> None:
    folder = resources.files("six_wheel.cli") / "data" / "examples"
    known = sorted(file.name for file in folder.iterdir() if not file.name.endswith(".md"))
    if name is None:
        print(*known, sep="\n")
        return
    if name not in known:
        raise ValueError(f'NAME must be an example, got "{name}"; {closest(name, known)}')
    target = output or Path(name)
    if target.exists():  # it may be the user's own
        raise ValueError(f"{target}: the file is there already; --output says where else")
    from six_wheel.kinematics.objects.whole_files import replacing

    with replacing(target) as temporary:
        temporary.write_bytes((folder / name).read_bytes())
    print(target.resolve())
