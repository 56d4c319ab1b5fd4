"""Tables of format 1 with the columns that tables have had since."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

_WORD, _FLAG, _WHOLE, _REAL = pa.string(), pa.bool_(), pa.int32(), pa.float64()
_TYPES = {
    "base_type": _WORD,
    "special_type": _WORD,
    "number_of_wheels": _WHOLE,
    "has_lights": _FLAG,
    "has_dynamic_doors": _FLAG,
    "generation": _WHOLE,
    "gender": _WORD,
    "age": _WORD,
    "reckless": _FLAG,
    "distracted": _FLAG,
    "crosses_anywhere": _FLAG,
    "use_wheelchair": _FLAG,
    "can_use_wheelchair": _FLAG,
    "sits_on_bench": _FLAG,
    "is_invincible": _FLAG,
    "speed": _REAL,
    "green_time": _REAL,
    "yellow_time": _REAL,
    "red_time": _REAL,
    "pole_index": _WHOLE,
    "sign_type": _WORD,
    "value": _REAL,
    "ground_z_m": _REAL,
    "hazard": _WHOLE,
}
FACTS = pa.struct([*_TYPES.items(), ("other", _WORD)])
"""The type of `attributes`."""
WEATHER = (
    "cloudiness precipitation precipitation_deposits wind_intensity sun_azimuth_deg sun_altitude_deg wetness fog_density "
    "fog_distance_m fog_falloff scattering_intensity mie_scattering_scale rayleigh_scattering_scale dust_storm"
).split()
"""In the order of the lists of format 1."""
_READ: dict[Any, Any] = {
    _WORD: str,
    _FLAG: {"true": True, "false": False}.__getitem__,
    _WHOLE: int,
    _REAL: float,
}


def source_of(name: str, there: Sequence[str]) -> str:
    """The column of a table of format 1 that another one is made of; any other column is itself."""
    return "angle_rad" if name == "is_ego" and name not in there and "angle_rad" in there else name


def as_of_today(table: pa.Table, scene: int) -> pa.Table:
    """A table of a scene. One of format 1 gets `scene`, `is_ego` after the id, and a struct of facts."""
    names = table.column_names
    if "scene" in names:
        return table
    if "angle_rad" in names and "is_ego" not in names:
        own = pa.field("is_ego", pa.bool_(), nullable=False)
        table = table.add_column(names.index("id") + 1 if "id" in names else 0, own, pc.is_null(table["angle_rad"]))
    if "attributes" in names:
        facts = pa.array([_facts(json.loads(text)) for text in table["attributes"].to_pylist()], FACTS)
        at = table.column_names.index("attributes")
        table = table.set_column(at, pa.field("attributes", FACTS, nullable=False), facts)
    numbers = pa.array(np.full(table.num_rows, scene, np.uint32))
    return table.add_column(0, pa.field("scene", pa.uint32(), nullable=False), numbers)


def plan_as_of_today(table: pa.Table) -> pa.Table:
    """A table of the plan: weather as a struct."""
    for at, field in enumerate(table.schema):
        if pa.types.is_fixed_size_list(field.type) and field.type.list_size == len(WEATHER):
            flat = table[field.name].combine_chunks().flatten().to_numpy().reshape(-1, len(WEATHER))
            fields = [pa.field(name, pa.float64(), nullable=False) for name in WEATHER]
            weather = pa.StructArray.from_arrays([pa.array(column) for column in flat.T.copy()], fields=fields)
            table = table.set_column(at, pa.field(field.name, weather.type, nullable=False), weather)
    return table


def _facts(said: dict[str, str]) -> dict[str, Any]:
    facts, other = {}, {}
    for key, value in said.items():
        try:
            facts[key] = _READ[_TYPES[key]](value)
        except (KeyError, ValueError):
            other[key] = value
    return {**facts, "other": json.dumps(other, separators=(",", ":"), ensure_ascii=False)} if other else facts
