"""A store and its scenes."""

from __future__ import annotations

import functools
import os
import pathlib
from collections import Counter
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any, overload

import numpy as np
import pyarrow as pa

from convoy.boxes import polars
from convoy import older
from convoy.errors import StoreError
from convoy.files import Files
from convoy.places import place_of
from convoy.poses import Array, pose

if TYPE_CHECKING:
    from convoy.frame import Frame


_ROSTER = "plan/roster.json"
_STEP_S = 0.05


class Dataset:
    """A store: a folder that `convoy run` wrote, or the URL of one: s3://BUCKET/PREFIX, gs://BUCKET/PREFIX,
    az://CONTAINER/PREFIX, file:///FOLDER. Nothing is read before it is asked for; may be pickled."""

    def __init__(self, store: str | os.PathLike[str]) -> None:
        self._place = place_of(store)
        self.location = self._place.location
        """Its whole path, or its URL."""
        self._files = Files(self._place, None)
        self._files.check_format(self._files.json("dataset.json"), "dataset.json")
        rows = self._files.table("plan/scenes.parquet", ["scene", "split", "map", "frames"]).to_pylist()
        self._plan = {row["scene"]: row for row in rows}
        self._kinds = self._read_kinds()
        self._scenes: dict[int, Scene] = {}
        self._maps: dict[str, pa.Table] = {}

    def __repr__(self) -> str:
        splits = ", ".join(f"{len(numbers)} {split}" for split, numbers in self.splits.items())
        return f"Dataset({self.location!r}, scenes planned: {splits})"

    def __reduce__(self) -> tuple[Any, ...]:
        return (Dataset, (self.location,))

    @property
    def path(self) -> pathlib.Path | None:
        """Its folder; a store in a bucket has none."""
        return self._place.path

    def _read_kinds(self) -> dict[int, tuple[int, str]]:
        """Edition and group of each scene; stores of older releases have one edition and no groups."""
        if not self._files.has(_ROSTER):
            return {}
        slots = self._files.json(_ROSTER)
        return {slot["scene"]: (slot.get("edition", 0), slot.get("group", "")) for slot in slots}

    @functools.cached_property
    def config(self) -> dict[str, Any]:
        """The whole resolved configuration; of several editions the newest."""
        config: dict[str, Any] = self._files.json("dataset.json")["config"]
        return config

    @functools.cached_property
    def editions(self) -> list[dict[str, Any]]:
        """The resolved configurations that the scenes were made by; `Scene.edition` counts them from 0."""
        editions: list[dict[str, Any]] = self._files.json("dataset.json").get("editions") or [self.config]
        return editions

    @property
    def groups(self) -> dict[str, list[int]]:
        """Planned scenes by group; those of no group have an empty name."""
        groups: dict[str, list[int]] = {}
        for number in sorted(self._plan):
            groups.setdefault(self._kinds.get(number, (0, ""))[1], []).append(number)
        return groups

    @property
    def splits(self) -> dict[str, list[int]]:
        """Planned scenes by split."""
        splits: dict[str, list[int]] = {}
        for number, row in sorted(self._plan.items()):
            splits.setdefault(row["split"], []).append(number)
        return splits

    def plan(self, name: str) -> pa.Table:
        """A table of the plan, of all scenes: `scenes`, `agents`, `hazards`; `weather` where it has keyframes."""
        return older.plan_as_of_today(self._files.table(f"plan/{name}.parquet"))

    def scenes(
        self,
        split: str | None = None,
        stages: Sequence[str] = ("simulate-and-log",),
        *,
        group: str | None = None,
        edition: int | None = None,
    ) -> list[Scene]:
        """The scenes for which all these stages are finished, in order; of one split, group and edition, or of all."""
        if split is not None and split not in self.splits:
            raise StoreError(
                f"there is no split {split}: it has {', '.join(self.splits)}",
                do="choose one of these",
                file=self.location,
            )
        if group is not None and group not in self.groups:
            raise StoreError(
                f"there is no group {group}: it has {', '.join(name or 'no group' for name in self.groups)}",
                do="choose one of these",
                file=self.location,
            )
        numbers = []
        for number, row in sorted(self._plan.items()):
            its_edition, its_group = self._kinds.get(number, (0, ""))
            if split in (None, row["split"]) and group in (None, its_group) and edition in (None, its_edition):
                numbers.append(number)
        # Each asks for its manifests.
        scenes = self._place.each(self.scene, numbers)
        return [scene for scene in scenes if set(stages) <= scene.stages]

    def scene(self, number: int) -> Scene:
        """A scene by its number."""
        if number not in self._plan:
            raise StoreError(
                f"the plan has no such scene, it has {len(self._plan)}",
                do="choose one of Dataset.splits",
                scene=number,
                file=self.location,
            )
        if number not in self._scenes:
            self._scenes[number] = Scene(self, number)
        return self._scenes[number]

    def table(self, name: str, columns: Sequence[str] | None = None) -> pa.Table:
        """A table of all scenes that are made, one below the other (`tracks`, `boxes_valid`, `log/actors`, ...), with a first
        column `scene`: ids of objects are only unique within a scene. A stage that is not finished for a scene is an error."""
        if not (scenes := self.scenes()):
            raise StoreError("no scene is made", do=f"{self._files.go_on} makes what is missing", file=self.location)
        pieces = []
        for scene in scenes:
            piece = scene.table(name, columns)
            if "scene" not in piece.column_names:
                numbers = pa.array(np.full(piece.num_rows, scene.number, np.uint32))
                piece = piece.add_column(0, pa.field("scene", pa.uint32()), numbers)
            pieces.append(piece.replace_schema_metadata(None))
        return pa.concat_tables(pieces, promote_options="default")

    def to_pandas(self, name: str, columns: Sequence[str] | None = None) -> Any:
        """`table` as a data frame of pandas."""
        return self.table(name, columns).to_pandas()

    def to_polars(self, name: str, columns: Sequence[str] | None = None) -> Any:
        """`table` as a data frame of Polars."""
        return polars().from_arrow(self.table(name, columns))

    def summary(self) -> str:
        """A few lines on what is in it: scenes and minutes by split, maps, agents, sensors, boxes by class."""
        scenes = self.scenes()
        seconds = sum(scene.frames for scene in scenes) * _STEP_S
        lines = [
            f"{self.config.get('name', 'dataset')}: {len(scenes)} of {len(self._plan)} scenes made, {seconds:g} s at 20 Hz"
        ]
        made = {scene.number for scene in scenes}
        splits = [f"{split} {len(made & set(numbers))}" for split, numbers in self.splits.items()]
        lines.append(f"  splits: {', '.join(splits)}")
        lines.append(f"  maps: {', '.join(sorted({scene.map_name for scene in scenes})) or 'none'}")
        agents = [name for scene in scenes for name in scene.agents]
        rsus = sum(name.startswith("rsu") for name in agents)
        lines.append(f"  agents: {len(agents) - rsus} vehicles and {rsus} RSUs, scenes added up")
        names = sorted({name for scene in scenes for tables in scene._sensors.values() for name in tables})
        lines.append(f"  sensor tables: {', '.join(names) or 'none'}")
        tracks: Counter[str] = Counter()
        for scene in scenes:
            if "merge-tracks" in scene.stages:
                tracks.update(scene.table("tracks", ["class"])["class"].to_pylist())
        counts = [f"{count} {name}" for name, count in tracks.most_common()]
        lines.append(f"  tracks: {', '.join(counts) or 'none yet'}")
        return "\n".join(lines)

    def vector_map(self, name: str) -> pa.Table:
        """A map as lines, polygons and a lane graph in the world; docs/schema.md has its columns."""
        if name not in self._maps:
            self._maps[name] = self._files.table(f"maps/{name}.vector.parquet")
        return self._maps[name]


class Scene:
    """Some seconds in one place. Frame k is at k x 0.05 s."""

    def __init__(self, dataset: Dataset, number: int) -> None:
        row = dataset._plan[number]
        self.dataset, self.number = dataset, number
        self.split: str = row["split"]
        self.map_name: str = row["map"]
        self.frames: int = row["frames"]
        """How many frames it has."""
        self.edition, self.group = dataset._kinds.get(number, (0, ""))
        """Which of `Dataset.editions` it was made by, and its group there (empty: none)."""
        self._files = Files(dataset._place, number)

    def __repr__(self) -> str:
        return f"Scene({self.number}, split={self.split!r}, map={self.map_name!r}, frames={self.frames})"

    def __reduce__(self) -> tuple[Any, ...]:
        return (Dataset.scene, (self.dataset, self.number))

    def __len__(self) -> int:
        return self.frames

    def __iter__(self) -> Iterator[Frame]:
        return (self.frame(number) for number in range(self.frames))

    @overload
    def __getitem__(self, which: int) -> Frame: ...

    @overload
    def __getitem__(self, which: slice) -> list[Frame]: ...

    def __getitem__(self, which: int | slice) -> Frame | list[Frame]:
        """A frame (`scene[-1]` is the last one), or some: `scene[::10]` are those at 2 Hz."""
        if isinstance(which, slice):
            return [self.frame(number) for number in range(self.frames)[which]]
        if not -self.frames <= which < self.frames:
            raise IndexError(f"frame {which} of {self!r}")
        return self.frame(which % self.frames)

    @property
    def stages(self) -> set[str]:
        """The stages that are finished for it."""
        return self._files.stages

    @property
    def digests(self) -> dict[str, str]:
        """Of each finished stage: SHA-256 of what its manifest says of its files. Another one means other files."""
        return self._files.digests

    @functools.cached_property
    def info(self) -> dict[str, Any]:
        """Facts about it: `log/scene.json`."""
        info: dict[str, Any] = self._files.json(self.key("log/scene.json"))
        return info

    @functools.cached_property
    def agents(self) -> tuple[str, ...]:
        """Its agents: vehicles, then RSUs."""
        return tuple(self._poses)

    @property
    def label_every_n_frames(self) -> int:
        """Boxes, map records and tracks are at frames 0, n, 2 n, ..."""
        return int(self.info.get("label_every_n_frames", 1))

    def frame(self, number: int) -> Frame:
        """A frame by its number, from 0."""
        from convoy.frame import Frame

        if not 0 <= number < self.frames:
            raise self.fault(f"it has frames 0 to {self.frames - 1}", "choose one of these", frame=number)
        return Frame(self, number)

    def table(self, name: str, columns: Sequence[str] | None = None) -> pa.Table:
        """A whole table by its name in docs/schema.md: `tracks`, `boxes_valid`, `log/actors`, ... That of a store of format 1
        gets the columns of today."""
        key = self.key(f"{name}.parquet")
        there = self._files.parquet(key, lambda file: list(file.schema_arrow.names))
        if "scene" in there:
            return self._files.table(key, columns)
        read = None if columns is None else [older.source_of(column, there) for column in columns if column != "scene"]
        table = older.as_of_today(self._files.table(key, read), self.number)
        return table if columns is None else table.select(columns)

    def tracks(self) -> pa.Table:
        """One row per object that was in some agent's list."""
        return self.table("tracks")

    def vector_map(self) -> pa.Table:
        """Its map: `Dataset.vector_map`."""
        return self.dataset.vector_map(self.map_name)

    def key(self, name: str) -> str:
        """Where a file of the scene is in the store."""
        return f"scenes/{self.number:04d}/{name}"

    def fault(self, what: str, do: str, **place: Any) -> StoreError:
        """A fault in this scene."""
        return StoreError(what, do=do, scene=self.number, **place)

    @functools.cached_property
    def _poses(self) -> dict[str, dict[str, Array]]:
        """Of each agent: id, world_from_agent, velocity and angular velocity by frame."""
        names = ["frame", "agent", "id", "xyz_m", "quaternion", "velocity_mps", "angular_velocity_radps"]
        columns = self._files.table(self.key("agents.parquet"), names).to_pydict()
        found: dict[str, dict[str, Array]] = {}
        for row in zip(*(columns[name] for name in names), strict=True):
            frame, agent, number, xyz, quaternion, velocity, turning = row
            of = found.setdefault(
                agent,
                {
                    "pose": np.full((self.frames, 4, 4), np.nan),
                    "velocity": np.full((self.frames, 3), np.nan),
                    "turning": np.full((self.frames, 3), np.nan),
                    "id": np.array(number),
                },
            )
            if frame < self.frames:
                of["pose"][frame] = pose(xyz, quaternion)
                of["velocity"][frame], of["turning"][frame] = velocity, turning
        return dict(sorted(found.items(), key=_vehicles_first))

    @functools.cached_property
    def _sensors(self) -> dict[str, tuple[str, ...]]:
        """Tables of each agent's sensors."""
        prefix = self.key("sensors/")
        found: dict[str, list[str]] = {agent: [] for agent in self.agents}
        for key in self._files.outputs:
            if key.startswith(prefix) and key.endswith(".parquet"):
                agent, name = key[len(prefix) : -len(".parquet")].split("/")
                found.setdefault(agent, []).append(name)
        return {agent: tuple(sorted(names)) for agent, names in found.items()}


def _vehicles_first(item: tuple[str, Any]) -> tuple[bool, str, int]:
    kind, _, number = item[0].rpartition("_")
    return (kind == "rsu", kind, int(number) if number.isdigit() else 0)
