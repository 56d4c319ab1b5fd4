"""Files of a store: believed where a manifest names them, opened once per thread of each process."""

from __future__ import annotations

import functools
import hashlib
import io
import json
import os
import shlex
import threading
import zipfile
from collections import OrderedDict
from collections.abc import Callable, Sequence
from typing import Any, TypeVar

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from convoy.errors import StoreError
from convoy.places import Place, Source
from convoy.poses import Array

FORMAT_VERSIONS = (1, 2)
"""Those that this package reads. Tables of format 1 lack some columns: docs/versions.md."""
OPEN_FILES = 96
"""Handles that a thread keeps open."""
TABLES = 16
"""Decoded pieces of tables that a thread keeps."""

_STAGES = {
    "sensors": "render-sensors",
    "bev": "bev-gt",
    "bev_paint": "bev-gt",
    "bev_ids": "bev-gt",
    "bev_heights": "bev-gt",
    "occupancy": "occupancy-gt",
    "occupancy_cells": "occupancy-gt",
    "occupancy_ids": "occupancy-gt",
    "occupancy_flow": "occupancy-gt",
    "occupancy_filled": "postprocess-valid",
    "occupancy_observed": "postprocess-valid",
    "boxes_valid.parquet": "postprocess-valid",
    "tracks.parquet": "merge-tracks",
    "tracks_frames.parquet": "merge-tracks",
    "tracks_agents.parquet": "merge-tracks",
    "tracks_windows.parquet": "merge-tracks",
}

T = TypeVar("T")


class _Handles(threading.local):
    """What this thread of this process has open. A forked child starts with nothing: descriptors that it shared with its
    parent would have one position for both."""

    def __init__(self) -> None:
        self.clear()

    def clear(self) -> None:
        self.pid = os.getpid()
        self.files: OrderedDict[str, Any] = OrderedDict()
        self.tables: OrderedDict[tuple[Any, ...], pa.Table] = OrderedDict()

    def keep(self, kept: OrderedDict[Any, T], key: Any, make: Callable[[], T], limit: int) -> T:
        if key in kept:
            kept.move_to_end(key)
            return kept[key]
        value = kept[key] = make()
        while len(kept) > limit:
            kept.popitem(last=False)
        return value

    def fresh(self) -> _Handles:
        """Itself, without what the parent process had opened."""
        if self.pid != os.getpid():
            self.clear()
        return self


_handles = _Handles()


def stage_of(key: str) -> str:
    """The stage that writes a file of a scene."""
    parts = key.split("/")
    return _STAGES.get(parts[2], "simulate-and-log") if parts[0] == "scenes" else "spawn-planner"


class Files:
    """The finished files of a store, or of one of its scenes."""

    def __init__(self, place: Place, scene: int | None) -> None:
        self.place, self.scene = place, scene
        self.outputs: dict[str, int] = {}
        self.stages: set[str] = set()
        self.digests: dict[str, str] = {}
        """Of each stage: SHA-256 of what its files are."""
        names = ["plan/_manifest.json"] if scene is None else self._manifests(f"scenes/{scene:04d}/_manifests")
        for name, manifest in zip(names, place.each(self._manifest, names), strict=True):
            file = place.where(name)
            try:
                self.check_format(manifest, file)
                self.outputs.update({output["key"]: int(output["bytes"]) for output in manifest["outputs"]})
                self.stages.add(manifest["stage"])
                lines = sorted(
                    f"{output['key']} {output.get('blake3', output['bytes'])}\n" for output in manifest["outputs"]
                )
                self.digests[manifest["stage"]] = hashlib.sha256("".join(lines).encode()).hexdigest()
            except (KeyError, TypeError, ValueError) as fault:
                raise self.error(f"is no manifest ({fault!r})", file=file, do=self._redo()) from fault

    def _manifests(self, folder: str) -> list[str]:
        try:
            with self.place.talk():
                return self.place.json_files(folder)
        except OSError as fault:
            raise self._unread(fault, self.place.where(folder)) from fault

    def _manifest(self, name: str) -> Any:
        file = self.place.where(name)
        try:
            with self.place.talk():
                return json.loads(self.place.read(name))
        except FileNotFoundError as fault:
            with self.place.talk():
                what, do = self.place.nothing()
            raise self.error(what, file=file, do=do) from fault
        except (OSError, ValueError) as fault:
            raise self._unread(fault, file) from fault

    def error(self, what: str, *, do: str, file: str | None = None) -> StoreError:
        """A fault in this scene."""
        return StoreError(what, do=do, file=file, scene=self.scene)

    def check_format(self, document: dict[str, Any], file: str) -> None:
        """Refuses a store whose files may look otherwise."""
        found = document.get("format_version")
        if found not in FORMAT_VERSIONS:
            raise self.error(
                f"its format version is {found}, this package reads {FORMAT_VERSIONS[0]} to {FORMAT_VERSIONS[-1]}",
                file=file,
                do="install the Python package of the Convoy that made the store",
            )

    def _redo(self, key: str | None = None) -> str:
        again = "`convoy run` with the store's configuration"
        if key and self.scene is not None:
            again = f"`{stage_of(key)} --store {shlex.quote(self.place.location)} --scenes {self.scene} --force`"
        return f"{self.verify} says what is damaged, {again} makes it again"

    @property
    def go_on(self) -> str:
        """The command that makes what is missing or stale."""
        return f"`convoy run --store {shlex.quote(self.place.location)} --stages scenes,stats`"

    @property
    def verify(self) -> str:
        """The command that looks for damage."""
        return f"`convoy verify --store {shlex.quote(self.place.location)}`"

    def _unread(self, fault: BaseException, file: str, key: str | None = None) -> StoreError:
        """What is wrong with a file that cannot be read, or with the whole place."""
        if (known := self.place.explain(fault)) is not None:
            return self.error(known[0], file=file, do=known[1])
        said = "No such file" if isinstance(fault, FileNotFoundError) else " ".join(str(fault).split())
        return self.error(f"cannot be read ({said})", file=file, do=self._redo(key))

    def has(self, key: str) -> bool:
        """Whether a finished stage wrote a file."""
        return key in self.outputs

    def source(self, key: str) -> Source:
        """A file that a finished stage wrote and that is still there as it was written, by its size."""
        if key not in self.outputs:
            stage = stage_of(key)
            if stage in self.stages:
                raise self.error(
                    f"{stage} wrote no such file",
                    file=key,
                    do="see which sensors and labels the configuration (dataset.json) switches on",
                )
            raise self.error(
                f"{stage} is not finished for it",
                file=key,
                do=f"{self.go_on} makes what is missing",
            )
        try:
            source = self.place.source(key)
        except OSError as fault:
            raise self._unread(fault, key, key) from fault
        if source.size != self.outputs[key]:
            raise self.error(
                f"has {source.size} bytes, its manifest says {self.outputs[key]}", file=key, do=self._redo(key)
            )
        return source

    def read(self, key: str, read: Callable[[Any], T], open_file: Callable[[Source], Any]) -> T:
        """Reads from a file by a handle that is kept."""
        handles, where = _handles.fresh(), self.place.where(key)
        try:
            # What is open was looked at when it was opened.
            with self.place.talk():
                file = handles.keep(handles.files, where, lambda: open_file(self.source(key)), OPEN_FILES)
                return read(file)
        except StoreError:
            raise
        except (OSError, ValueError, KeyError, IndexError, EOFError, pa.ArrowException, zipfile.BadZipFile) as fault:
            handles.files.pop(where, None)
            raise self._unread(fault, key, key) from fault
        except Exception as fault:  # zlib.error and its like have no common class.
            handles.files.pop(where, None)
            raise self.error(f"is damaged ({fault})", file=key, do=self._redo(key)) from fault

    def json(self, key: str) -> Any:
        """A JSON file."""
        try:
            with self.place.talk():
                return json.loads(self.source(key).read())
        except (OSError, ValueError) as fault:
            raise self._unread(fault, key, key) from fault

    def parquet(self, key: str, read: Callable[[pq.ParquetFile], T]) -> T:
        """Reads from a table's file."""
        return self.read(key, read, lambda source: source.table())

    def row(self, key: str, row_group: int, columns: Sequence[str] | None) -> pa.Table:
        """One row group."""
        wanted = None if columns is None else list(columns)
        return self.parquet(key, lambda file: file.read_row_group(row_group, columns=wanted, use_threads=False))

    def at_frame(self, key: str, frame: int, columns: Sequence[str]) -> pa.Table:
        """The rows of a frame, in a table with a column `frame` that ascends."""

        def read(file: pq.ParquetFile) -> pa.Table:
            names = file.schema_arrow.names
            wanted = [name for name in dict.fromkeys(["frame", *columns]) if name in names]
            pieces = []
            for group in range(file.num_row_groups):
                about = file.metadata.row_group(group).column(names.index("frame")).statistics
                if about is not None and about.has_min_max and not about.min <= frame <= about.max:
                    continue
                load = functools.partial(file.read_row_group, group, columns=wanted, use_threads=False)
                piece = handles.keep(handles.tables, (where, group, *wanted), load, TABLES)
                frames = piece["frame"].to_numpy()
                begin, end = np.searchsorted(frames, [frame, frame + 1])
                pieces.append(piece.slice(begin, end - begin))
            return pa.concat_tables(pieces) if pieces else file.schema_arrow.empty_table().select(wanted)

        handles, where = _handles.fresh(), self.place.where(key)
        return self.parquet(key, read)

    def table(self, key: str, columns: Sequence[str] | None = None) -> pa.Table:
        """A whole table."""
        wanted = None if columns is None else list(columns)
        return self.parquet(key, lambda file: file.read(columns=wanted, use_threads=False))

    def metadata(self, key: str) -> dict[bytes, bytes]:
        """What a table's file says about itself."""
        found: dict[bytes, bytes] = self.parquet(key, lambda file: file.metadata.metadata or {})
        return found

    def comment(self, key: str) -> dict[str, Any]:
        """The JSON object in an archive's comment."""

        def read(archive: zipfile.ZipFile) -> dict[str, Any]:
            about: dict[str, Any] = json.loads(archive.comment or b"{}")
            return about

        return self.read(key, read, lambda source: source.archive())

    def member(self, key: str, frame: int) -> Array:
        """The array of a frame."""

        def read(archive: zipfile.ZipFile) -> Array:
            array: Array = np.lib.format.read_array(io.BytesIO(archive.read(f"{frame:04d}.npy")), allow_pickle=False)
            return array

        return self.read(key, read, lambda source: source.archive())
