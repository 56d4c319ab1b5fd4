"""Where a store is: a folder, by paths that pyarrow and zipfile open, or a bucket, read by few requests."""

from __future__ import annotations

import io
import os
import pathlib
import re
import urllib.parse
import zipfile
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from contextlib import AbstractContextManager, nullcontext
from typing import Any, TypeVar

import pyarrow as pa
import pyarrow.parquet as pq

from convoy import clouds
from convoy.errors import StoreError

SCHEMES = ("file", "s3", "gs", "az")
WHOLE = 1 << 20
"""Objects of up to this many bytes are read in one piece."""
TAIL = 1 << 18
"""So much of the end of larger ones is read first: footers of tables and directories of archives."""
SIDE_BY_SIDE = 8
"""Requests to a bucket at the same time, where many objects are wanted."""

T = TypeVar("T")
R = TypeVar("R")
_NOBODY = nullcontext()


class Source:
    """A file in a folder."""

    def __init__(self, path: pathlib.Path) -> None:
        self._path = path
        self.size = path.stat().st_size

    def read(self) -> bytes:
        """All of it."""
        return self._path.read_bytes()

    def table(self) -> pq.ParquetFile:
        """It as a table."""
        return pq.ParquetFile(self._path, pre_buffer=False)

    def archive(self) -> zipfile.ZipFile:
        """It as an archive."""
        return zipfile.ZipFile(self._path)


class Place:
    """A folder."""

    def __init__(self, path: pathlib.Path) -> None:
        self.path: pathlib.Path | None = path
        self._folder = path
        self.location = str(path)

    def where(self, key: str) -> str:
        """What people are told that a file is called."""
        return str(self._folder / key)

    def source(self, key: str) -> Source:
        """A file; raises OSError."""
        return Source(self._folder / key)

    def read(self, key: str) -> bytes:
        """A whole file whose size is not known; raises OSError."""
        return (self._folder / key).read_bytes()

    def json_files(self, folder: str) -> list[str]:
        """Keys that end in `.json` right in a folder, in order; none if there is no such folder."""
        return [f"{folder}/{path.name}" for path in sorted((self._folder / folder).glob("*.json"))]

    def each(self, function: Callable[[T], R], items: Iterable[T]) -> list[R]:
        """Calls a function that waits for the store with each of them."""
        return [function(item) for item in items]

    def talk(self) -> AbstractContextManager[None]:
        """Around all that reads from it and from its sources; not nested."""
        return _NOBODY

    def explain(self, fault: BaseException) -> tuple[str, str] | None:
        """What is wrong with the whole place, and what to do; None where it is one file."""
        return None

    def nothing(self) -> tuple[str, str]:
        """What to say where there is no store."""
        return "there is no finished plan here", "give the folder that `convoy run --store` wrote"


class Bucket(Place):
    """A bucket, or what lies under a prefix of it; in Azure a container."""

    def __init__(self, scheme: str, bucket: str, prefix: str) -> None:
        self.path = None
        self._scheme, self._bucket, self._prefix = scheme, bucket, prefix
        self._root = f"{bucket}/{prefix}" if prefix else bucket
        self.location = f"{scheme}://{self._root}"
        with self.talk():
            clouds.system(scheme)  # What is wrong with the environment is said at once.

    def where(self, key: str) -> str:
        return f"{self.location}/{key}"

    def source(self, key: str) -> Source:
        return _Object(clouds.system(self._scheme).open_input_file(f"{self._root}/{key}"))

    def read(self, key: str) -> bytes:
        return self.source(key).read()

    def json_files(self, folder: str) -> list[str]:
        from pyarrow.fs import FileSelector

        chosen = FileSelector(f"{self._root}/{folder}", allow_not_found=True)
        found = clouds.system(self._scheme).get_file_info(chosen)
        return sorted(f"{folder}/{info.base_name}" for info in found if info.base_name.endswith(".json"))

    def each(self, function: Callable[[T], R], items: Iterable[T]) -> list[R]:
        with ThreadPoolExecutor(SIDE_BY_SIDE) as pool:
            return list(pool.map(function, items))

    def talk(self) -> AbstractContextManager[None]:
        return clouds.talk()

    def explain(self, fault: BaseException) -> tuple[str, str] | None:
        return clouds.explain(fault, self._scheme, self._bucket)

    def nothing(self) -> tuple[str, str]:
        from pyarrow.fs import FileType

        word = "container" if self._scheme == "az" else "bucket"
        try:
            known = clouds.system(self._scheme).get_file_info(self._bucket).type != FileType.NotFound
        except OSError:
            known = True  # It may be forbidden to ask.
        if not known:
            return f"there is no {word} {self._bucket}", f"check the URL, {self.location}"
        under = f"under the prefix {self._prefix}" if self._prefix else "at its root"
        return f"{word} {self._bucket} has no store {under}", "give the URL whose plan/_manifest.json is there"


class _Object(Source):
    """An object of a bucket. Opening it has asked for its size."""

    def __init__(self, file: Any) -> None:
        self._file = file
        self.size = int(file.size())

    def read(self) -> bytes:
        data: bytes = self._file.read_at(self.size, 0)
        return data

    def table(self) -> pq.ParquetFile:
        if self.size <= WHOLE:
            return pq.ParquetFile(pa.BufferReader(self.read()), pre_buffer=False)
        # Parquet itself would read 64 KiB, then the rest of a footer that is longer.
        length = min(TAIL, self.size)
        tail = self._file.read_at(length, self.size - length)
        length = min(int.from_bytes(tail[-8:-4], "little") + 8, self.size)
        if length > len(tail):
            tail = self._file.read_at(length, self.size - length)
        # Columns that lie side by side are one request.
        return pq.ParquetFile(self._file, metadata=pq.read_metadata(pa.BufferReader(tail)), pre_buffer=True)

    def archive(self) -> zipfile.ZipFile:
        if self.size <= WHOLE:
            return zipfile.ZipFile(io.BytesIO(self.read()))
        return _Archive(_Ranges(self._file, self.size))


class _Ranges(io.RawIOBase):
    """An object as a file, by the range that was fetched last."""

    def __init__(self, file: Any, size: int) -> None:
        self._file, self._size, self._at = file, size, 0
        self._begin, self._held = 0, b""
        self.fetch(size - min(TAIL, size), size)

    def fetch(self, begin: int, end: int) -> None:
        """Fetches a range, unless it is there."""
        end = min(end, self._size)
        if begin < self._begin or end > self._begin + len(self._held):
            self._held, self._begin = self._file.read_at(end - begin, begin), begin

    def readable(self) -> bool:
        return True

    def seekable(self) -> bool:
        return True

    def tell(self) -> int:
        return self._at

    def seek(self, offset: int, whence: int = io.SEEK_SET) -> int:
        base = {io.SEEK_SET: 0, io.SEEK_CUR: self._at, io.SEEK_END: self._size}[whence]
        if base + offset < 0:
            raise OSError("seeks before the beginning")
        self._at = base + offset
        return self._at

    def read(self, size: int | None = -1) -> bytes:
        end = self._size if size is None or size < 0 else min(self._at + size, self._size)
        if end <= self._at:
            return b""
        self.fetch(self._at, end)
        data = self._held[self._at - self._begin : end - self._begin]
        self._at += len(data)
        return data


class _Archive(zipfile.ZipFile):
    """An archive in a bucket: its directory is one request, each member another one."""

    def __init__(self, file: _Ranges) -> None:
        self._ranges = file
        super().__init__(file)

    def read(self, name: str | zipfile.ZipInfo, pwd: bytes | None = None) -> bytes:
        about = name if isinstance(name, zipfile.ZipInfo) else self.getinfo(name)
        # A local header has 30 bytes and a name, and sometimes more extra fields than the directory says.
        length = 30 + len(about.filename.encode()) + len(about.extra) + 64 + about.compress_size
        self._ranges.fetch(about.header_offset, about.header_offset + length)
        return super().read(about, pwd)


def place_of(store: str | os.PathLike[str]) -> Place:
    """The place that a path or a URL names. Faults do not repeat a URL that may hold a secret."""
    text = os.fspath(store)
    if not isinstance(store, str):
        if re.match(rf"({'|'.join(SCHEMES)}):/", text):
            raise StoreError("a URL was made a path, which costs it a slash", do="give it as a str")
        return Place(pathlib.Path(text).absolute())
    scheme, found, rest = text.partition("://")
    if not found or not re.fullmatch(r"[A-Za-z][A-Za-z0-9+.-]*", scheme):
        return Place(pathlib.Path(text).absolute())
    if scheme not in SCHEMES:
        raise StoreError(f"there is no store of kind {scheme}://", do=f"give a folder or {_listed()}")
    if scheme == "file":
        return Place(_folder(rest))
    bucket, _, prefix = rest.partition("/")
    if "@" in bucket or ":" in bucket:
        raise StoreError(f"a {scheme}:// URL takes no credentials", do="give them by variables: docs/python.md")
    if "?" in rest or "#" in rest:
        raise StoreError(
            f"a {scheme}:// URL takes no options after ? or #", do="give them by variables: docs/python.md"
        )
    word = "container" if scheme == "az" else "bucket"
    if not bucket:
        raise StoreError(f"a {scheme}:// URL names no {word}", do=f"give {scheme}://{word.upper()}/PREFIX")
    if not re.fullmatch(r"[A-Za-z0-9._$-]+", bucket):
        raise StoreError(f"a {word} has no such name as {bucket!r}", do=f"give {scheme}://{word.upper()}/PREFIX")
    prefix = prefix.rstrip("/")
    if prefix and {"", ".", ".."} & set(prefix.split("/")):
        raise StoreError(f"a prefix has no such parts as {prefix!r} has", do="leave out what is empty, . or ..")
    return Bucket(scheme, bucket, prefix)


def _listed() -> str:
    return " or ".join(", ".join(f"{scheme}://" for scheme in SCHEMES).rsplit(", ", 1))


def _folder(rest: str) -> pathlib.Path:
    path = rest.removeprefix("localhost")
    if not path.startswith("/"):
        raise StoreError("a file:// URL takes a whole path", do="give file:///FOLDER")
    return pathlib.Path(urllib.parse.unquote(path))
