"""EXR files: a preview in colours that any viewer shows, then one part a surface with float32 channels on its grid."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import gearsim
from gearsim.output.columns import Column, about, unit_of
from gearsim.output.preview import preview, tops
from gearsim.result import Result

UNITS = "mm; channels named .um in micrometres"
SIGN = "deviation along the outward surface normal; positive = material left, negative = overcut"
GRID = "row 0 (the picture's top) is the root or lowest end, the last row the tip; column 0 is the toe or first end"
PREVIEW = "preview"
_PREVIEWED = ("deviation.um", "least_difference.per_mm", "shank.mm")  # the first of them that a file has
_PARAMETERS = ("share.", "parameter.")


def header(name: str, frame: str, **more: str) -> dict[str, str]:
    """What every part says of itself: the scene, units, sign, the frame of its points, how it lies."""
    return {
        "scene": name, "units": UNITS, "sign": SIGN, "frame": frame, "grid": GRID, "missing": "nan where there is none",
        **more, "version": gearsim.__version__,
    }  # fmt: skip


def stated(result: Result) -> dict[str, str]:
    """What every file of a run says of itself: the header, which motion its plain names are under, what rows are."""
    main = result.job.main
    own = f"deviation.um, deviation_um and segment.id are under {main}; NAME.deviation.um and NAME_um under NAME"
    rows = {"rows_and_columns": result.job.conventions["grids"]} if "grids" in result.job.conventions else {}
    return header(result.name, result.frame, motion=own, program=main, **rows)


def write_exr(
    parts: Mapping[str, Mapping[str, Column]], header: Mapping[str, str], file: Path, limit_um: float = np.inf
) -> None:
    """Write maps, values of shape (rows, columns), as a multi-part OpenEXR file: a preview, then one part a surface.

    The preview shows one channel of every part, one below the other, and the data windows of the parts lie where it
    shows them. Its colours end at ``limit_um``, where that channel is in um, else at its greatest absolute value.
    Raises OSError where the file cannot be written.
    """
    import OpenEXR

    shown = _previewed(next(iter(parts.values())))
    maps = [_singles(channels[shown]) for channels in parts.values()]
    limit = limit_um if unit_of(shown) == "um" and np.isfinite(limit_um) else _largest(maps)
    picture = preview(maps, limit).astype(np.float16)
    shared = {
        "displayWindow": ((0, 0), (picture.shape[1] - 1, len(picture) - 1)),  # all parts of a file share it
        "compression": OpenEXR.ZIP_COMPRESSION,
        "type": OpenEXR.scanlineimage,
        **{f"gearsim.{key}": text for key, text in header.items()},
    }
    colours = {colour: np.ascontiguousarray(picture[..., k]) for k, colour in enumerate("RGB")}
    legend = {f"gearsim.{PREVIEW}": _legend(shown, limit)}
    first = PREVIEW + "_" * (PREVIEW in parts)
    written = [OpenEXR.Part({**shared, **legend}, {k: OpenEXR.Channel(v) for k, v in colours.items()}, first)]
    for (name, channels), top in zip(parts.items(), tops(maps), strict=True):
        pixels = {k: OpenEXR.Channel(_singles(column)) for k, column in channels.items()}
        rows, columns = np.shape(channels[shown].values)
        window = {"dataWindow": ((0, top), (columns - 1, top + rows - 1))}
        written.append(OpenEXR.Part({**shared, **window, **_notes(channels)}, pixels, name))
    with OpenEXR.File(written) as out:
        try:
            out.write(str(file))
        except RuntimeError as error:  # what it makes of a full disk
            raise OSError(str(error)) from error


def _previewed(channels: Mapping[str, Column]) -> str:
    return next((name for name in _PREVIEWED if name in channels), next(iter(channels)))


def _singles(column: Column) -> NDArray[np.float32]:
    """A column's values as single floats, nan where there is none."""
    return np.ascontiguousarray(np.ma.filled(np.ma.asarray(column.values).astype(np.float32), np.nan))


def _largest(maps: list[NDArray[np.float32]]) -> float:
    known = np.concatenate([m[np.isfinite(m)] for m in maps])
    return max(float(np.abs(known).max(initial=0.0)), 1e-9)


def _legend(channel: str, limit: float) -> str:
    unit = unit_of(channel)
    return (
        f"{channel} of every part, one below the other: blue -{limit:.3g} {unit}, white 0, red +{limit:.3g} {unit}, "
        "the ends' colours beyond; grey: no value"
    )


def _notes(channels: Mapping[str, Column]) -> dict[str, Any]:
    """What a part says of its grid and its channels."""
    rows, columns = np.shape(next(iter(channels.values())).values)
    ranges = {k: _singles(c) for k, c in channels.items() if k.startswith(_PARAMETERS)}
    spans = [f"{k} {np.nanmin(v):.6g} to {np.nanmax(v):.6g}" for k, v in ranges.items() if np.isfinite(v).any()]
    notes = {"rows": str(rows), "columns": str(columns), "parameters": "; ".join(spans)}
    notes["channels"] = json.dumps({k: about(k, c) for k, c in channels.items()}, ensure_ascii=False)
    return {f"gearsim.{k}": text for k, text in notes.items()}
