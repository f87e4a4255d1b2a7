"""Files of maps as they lie on disk: plain, in a ZIP file, or compressed by gzip."""

import gzip
import zipfile
import zlib
from pathlib import Path, PurePosixPath
from typing import IO, NamedTuple

from six_wheel.maps.files import TerrainFileError

BESIDE = (".prj", ".xml", ".txt", ".pdf", ".tfw", ".pgw", ".md", ".html", ".aux")  # files about a map
FIRST = 512  # bytes by which a form is known


class Source(NamedTuple):
    """A file, or the only map in it."""

    path: Path  # the file itself, by which messages call it
    name: PurePosixPath | Path  # name of the map: that of the file, or the one in it
    packing: str = ""  # `zip`, `gz` or nothing

    @property
    def suffix(self) -> str:
        """The end of the name, in small letters."""
        return self.name.suffix.lower()

    @property
    def gdal(self) -> str:
        """Name under which GDAL opens it."""
        return {"zip": f"/vsizip/{self.path}/{self.name}", "gz": f"/vsigzip/{self.path}"}.get(
            self.packing, str(self.path)
        )

    def read(self, size: int = -1) -> bytes:
        """Its first bytes, or all. Fails where it is not packed as its name says."""
        try:
            with self.open() as file:
                return file.read(size)
        except (gzip.BadGzipFile, zipfile.BadZipFile, zlib.error, EOFError, RuntimeError) as error:
            told = f"{self.path} must be packed as its name says: fetch it again, or unpack it ({error})"
            raise TerrainFileError(told) from None

    def open(self) -> IO[bytes] | gzip.GzipFile:
        """The file, or the one in it, as bytes."""
        if self.packing == "zip":
            return zipfile.ZipFile(self.path).open(str(self.name))
        if self.packing == "gz":
            return gzip.GzipFile(self.path)
        return self.path.open("rb")

    def text(self) -> str:
        """All of it as text, in UTF-8, UTF-16 or Latin-1."""
        data = self.read()
        encoding = "utf-16" if data.startswith((b"\xff\xfe", b"\xfe\xff")) else "utf-8-sig"
        try:
            return data.decode(encoding)
        except UnicodeDecodeError:
            if b"\0" in data:
                raise TerrainFileError(f"{self.path} must be text") from None
            return data.decode("latin-1")

    def beside(self, suffix: str) -> str | None:
        """Text of the file of the same name with another suffix, in small or capital letters."""
        for end in (suffix, suffix.upper()):
            other = self.name.with_suffix(end)
            if self.packing == "zip":
                with zipfile.ZipFile(self.path) as folder:
                    if str(other) in folder.namelist():
                        return folder.read(str(other)).decode(errors="replace")
            elif (file := self.path.with_name(other.name)).exists():
                return file.read_text(errors="replace")
        return None


def open_source(path: Path) -> Source:
    """The map in a file. Fails unless a packed one holds exactly one."""
    suffix = path.suffix.lower()
    if suffix == ".gz":
        return Source(path, Path(path.stem), "gz")
    if suffix != ".zip":
        return Source(path, path)
    try:
        with zipfile.ZipFile(path) as folder:
            names = [PurePosixPath(name) for name in folder.namelist() if not name.endswith("/")]
    except zipfile.BadZipFile:
        raise TerrainFileError(f"{path} must be a ZIP file: download it again, or unpack it") from None
    # Files that macOS adds are none of the archive.
    names = [name for name in names if "__MACOSX" not in name.parts and not name.name.startswith(".")]
    maps = [name for name in names if name.suffix.lower() not in BESIDE] or names
    if len(maps) != 1:
        listed = ": unpack it, and give one of " + ", ".join(map(str, maps[:5])) if maps else ""
        raise TerrainFileError(f"{path} must hold one file of a map, it has {len(maps)}{listed}")
    return Source(path, maps[0], "zip")
