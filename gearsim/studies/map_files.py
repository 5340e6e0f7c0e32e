"""Files of a Zarr v3 group as bytes: chunks of its arrays, one a chunk of the study, and what describes them."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

_LEVEL = 1  # of zstd: deviations become no smaller beyond it, and places that jobs share are found by it


@dataclass(frozen=True)
class ArrayKind:
    """One array of the group: its ``name``, ``shape`` and that of its ``chunks``, names of its dimensions, attributes.

    ``dtype`` is NumPy's, or ``str``; ``fill`` is what a chunk holds that was not written.
    """

    name: str
    shape: tuple[int, ...]
    chunks: tuple[int, ...]
    dims: tuple[str, ...]
    dtype: Any = "<f8"
    fill: Any = np.nan
    attributes: Mapping[str, Any] = field(default_factory=dict)

    def made(self, store: dict[str, Any]) -> Any:
        """The array, made in a store in memory."""
        import zarr
        from zarr.codecs import ZstdCodec

        return zarr.create_array(
            store, name=self.name, shape=self.shape, chunks=self.chunks, dtype=self.dtype, fill_value=self.fill,
            dimension_names=self.dims, attributes=dict(self.attributes), zarr_format=3,
            compressors=ZstdCodec(level=_LEVEL),
        )  # fmt: skip

    def files(self, values: NDArray[Any] | None = None) -> dict[str, bytes]:
        """The array's files by their paths in the group: ``NAME/zarr.json``, and all chunks where values are given.

        A chunk of fill values alone has no file. The same values give the same bytes.
        """
        store: dict[str, Any] = {}
        array = self.made(store)
        if values is not None:
            array[...] = values
        return {k: v.to_bytes() for k, v in sorted(store.items()) if k.startswith(f"{self.name}/")}

    def chunk_file(self, values: NDArray[Any]) -> bytes | None:
        """The bytes of one chunk along the first axis, which holds all of the others; None: fill values alone.

        ``values``, shape (at most so many as a chunk, ...): the rest is filled. It is zarr's bytes and zstd codecs
        without its event loop, which takes longer than they do.
        """
        import pyarrow as pa

        if (np.isnan(values) if np.isnan(self.fill) else values == self.fill).all():
            return None
        whole = np.ascontiguousarray(values, dtype=self.dtype)
        if len(values) < self.chunks[0]:
            whole = np.full(self.chunks, self.fill, dtype=self.dtype)
            whole[: len(values)] = values
        return bytes(pa.Codec("zstd", compression_level=_LEVEL).compress(whole, asbytes=True))

    def place(self, chunk: int) -> str:
        """The file of a chunk along the first axis, within the group."""
        return "/".join([self.name, "c", str(chunk), *("0" for _ in self.shape[1:])])

    @property
    def described(self) -> str:
        """The file of its metadata, within the group."""
        return f"{self.name}/zarr.json"


def group_file(kinds: Sequence[ArrayKind], attributes: Mapping[str, Any]) -> bytes:
    """The group's own zarr.json, with all arrays' metadata consolidated in it."""
    import zarr

    store: dict[str, Any] = {}
    zarr.create_group(store, zarr_format=3, attributes=dict(attributes))
    for kind in sorted(kinds, key=lambda k: k.name):
        kind.made(store)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # that Zarr v3 does not speak of consolidated metadata, though xarray reads it
        zarr.consolidate_metadata(store, zarr_format=3)
    return bytes(store["zarr.json"].to_bytes())
