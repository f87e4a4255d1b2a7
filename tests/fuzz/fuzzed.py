"""Coverage-guided fuzzing of the readers by atheris.

``python -m tests.fuzz.fuzzed yaml CORPUS -max_total_time=60``. The corpus folder gets the files to begin
with; see `readers`.
"""

import hashlib
import sys
import tempfile
from pathlib import Path

import atheris

with atheris.instrument_imports(include=["six_wheel", "yaml"]):
    from tests.fuzz.readers import READERS, read


def main() -> None:
    target, corpus, *options = sys.argv[1:]
    for content in READERS[target][2]():
        (Path(corpus) / hashlib.sha1(content).hexdigest()).write_bytes(content)
    with tempfile.TemporaryDirectory(dir="/dev/shm" if Path("/dev/shm").is_dir() else None) as folder:
        atheris.Setup([sys.argv[0], corpus, *options], lambda content: read(target, content, Path(folder)))
        atheris.Fuzz()


if __name__ == "__main__":
    main()
