"""`six-wheel show --layout`: how viewers show records of a rover."""

from pathlib import Path

from six_wheel.cli.shared import Reading, choose


def write_layout(rover: str, reading: Reading, target: Path) -> Path:
    """Write a layout for the rover of a parameter file, a preset or a record; where it is."""
    from six_wheel.logs.writing import replacing
    from six_wheel.records import layouts

    record = Path(rover) if Path(rover).suffix.lower() == ".mcap" else None
    if record is None:
        chosen = choose(rover, reading)
        shown, source = chosen.rover, chosen.path
    else:
        from six_wheel.records import Record
        from six_wheel.replay.again import settings_of

        if not record.is_file():
            raise ValueError(f"{record}: no such file")
        shown, source = settings_of(Record(record)).rover, record
    layouts.check(target, record)
    with replacing(target, [source] if source else []) as temporary:
        layouts.write(temporary, shown, record)
    return target.resolve()
