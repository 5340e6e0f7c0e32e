"""The arrays of a measured surface over all jobs, and what a chunk's outcomes are in them."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import InputError
from gearsim.metrology.deviation import Crossing
from gearsim.output.columns import CROSSINGS, key_of_words
from gearsim.output.exr import SIGN
from gearsim.output.presenters import slug
from gearsim.studies.map_files import ArrayKind
from gearsim.studies.records import Outcome, Study
from gearsim.studies.writing import sha256

GRIDS = ("u", "v", "point", "normal")  # what a surface's samples are, apart from what was measured there
_SUFFIX = {"point": "point_mm"}


def array_name(surface: str, field: str) -> str:
    """The array of a surface's map that holds a field of SurfaceMap."""
    return "_".join((re.sub(r"[^\w.-]", "_", slug(surface)), _SUFFIX.get(field, field)))


def kinds(
    surface: str, shape: tuple[int, int], jobs: int, chunk: int, dims: tuple[str, str] = ("row", "column")
) -> dict[str, ArrayKind]:
    """The arrays of one surface by the fields of SurfaceMap, all along the jobs first, so many in a chunk."""
    row, column = dims
    of = f"of {surface}"
    places = " ".join(array_name(surface, k) for k in ("u", "v"))
    words = key_of_words(CROSSINGS)
    codes = {"flag_values": [int(c) for c in CROSSINGS], "flag_meanings": " ".join(words), "meanings": words}
    along, vectors = "from its first edge to its last", (row, column, "xyz")
    told: dict[str, tuple[tuple[str, ...], dict[str, Any]]] = {
        "deviation_um": ((row, column), {"units": "um", "long_name": f"deviation {of}", "convention": SIGN}),
        "crossing": ((row, column), {"long_name": f"what the ray along the normal {of} met", **codes}),
        "u": ((row,), {"units": "1", "long_name": f"place of the rows {of}, {along}"}),
        "v": ((column,), {"units": "1", "long_name": f"place of the columns {of}, {along}"}),
        "point": (vectors, {"units": "mm", "long_name": f"intended point {of}"}),
        "normal": (vectors, {"units": "1", "long_name": f"unit normal out of the material {of}"}),
    }
    for field in ("deviation_um", "crossing"):
        told[field][1].update(coordinates=places, surface=surface)
    size = {row: shape[0], column: shape[1], "xyz": 3}
    out = {}
    for field, (names, attributes) in told.items():
        own, name = tuple(size[d] for d in names), array_name(surface, field)
        out[field] = ArrayKind(name, (jobs, *own), (chunk, *own), ("job", *names), attributes=attributes)
    out["crossing"] = replace(out["crossing"], dtype="|u1", fill=int(Crossing.ABSENT))
    return out


def kinds_of(study: Study, surface: str, shape: tuple[int, int]) -> dict[str, ArrayKind]:
    """The arrays of a study's surface as its chunks are kept."""
    return kinds(surface, shape, len(study), min(study.chunk, len(study)))


def surfaces_of(outcomes: Sequence[Outcome]) -> dict[str, tuple[int, int]]:
    """The surfaces that were measured in any job, with the shape of their maps.

    Raises InputError where one has several shapes, ValueError where its fields do not go together.
    """
    found: dict[str, tuple[int, int]] = {}
    for outcome in outcomes:
        for surface, one in outcome.maps.items():
            rows, columns = shape = one.deviation_um.shape
            own = {"crossing": shape, "u": (rows,), "v": (columns,), "point": (*shape, 3), "normal": (*shape, 3)}
            for field, expected in own.items():
                if np.shape(getattr(one, field)) != expected:
                    got = np.shape(getattr(one, field))
                    raise ValueError(f"{surface}: expected {field} to have shape {expected}, got {got}")
            agree(found, surface, (rows, columns))
    return found


def agree(found: dict[str, tuple[int, int]], surface: str, shape: tuple[int, int]) -> None:
    """Note the shape of a surface's maps. Raises InputError where another one was found."""
    if found.setdefault(surface, shape) != shape:
        raise InputError(f"{surface} has maps of {found[surface]} and of {shape}; one array holds one shape")


def surfaces_in(group: Any) -> list[str]:
    """The surfaces that an opened maps.zarr has maps of."""
    return sorted({str(array.attrs["surface"]) for _, array in group.arrays() if "surface" in array.attrs})


def read_field(group: Any, surface: str, field: str, jobs: range) -> NDArray[Any]:
    """A field of a surface's maps in jobs that follow each other, shape (jobs, ...); what all share is repeated."""
    array = group[array_name(surface, field)]
    if array.metadata.dimension_names[0] == "job":
        return np.asarray(array[jobs.start : jobs.stop])
    return np.broadcast_to(array[...], (len(jobs), *array.shape))


def values_of(field: str, kind: ArrayKind, surface: str, outcomes: Sequence[Outcome]) -> NDArray[Any]:
    """A field of a surface in all outcomes, shape (outcomes, ...); filled where a job has no such map."""
    out = np.full((len(outcomes), *kind.shape[1:]), kind.fill, dtype=kind.dtype)
    for k, outcome in enumerate(outcomes):
        if surface in outcome.maps:
            out[k] = getattr(outcome.maps[surface], field)
    return out


def grid_digest(outcomes: Sequence[Outcome], surface: str) -> str:
    """The checksum of where a surface's samples lie; empty where jobs differ in it."""
    first, *others = (o.maps[surface] for o in outcomes if surface in o.maps)
    if not all(_same(getattr(first, k), getattr(other, k)) for other in others for k in GRIDS):
        return ""
    return sha256(b"".join(np.ascontiguousarray(getattr(first, k), dtype="<f8").tobytes() for k in GRIDS))


def _same(a: NDArray[np.floating], b: NDArray[np.floating]) -> bool:
    return a is b or np.array_equal(a, b, equal_nan=True)


def shared(kind: ArrayKind) -> ArrayKind:
    """The array without its jobs, for what is the same in all of them."""
    return replace(kind, shape=kind.shape[1:], chunks=kind.shape[1:], dims=kind.dims[1:])


def common_dims(shapes: Mapping[str, tuple[int, int]]) -> dict[str, tuple[str, str]]:
    """Names of rows and columns by surface: everybody's, or each its own where shapes differ."""
    if len(set(shapes.values())) <= 1:
        return dict.fromkeys(shapes, ("row", "column"))
    return {surface: (array_name(surface, "row"), array_name(surface, "column")) for surface in shapes}
