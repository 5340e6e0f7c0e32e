"""3MF packages (core specification 1.3): a closed surface in mm, with a material for each thing that made its faces.

The model is a text in a zip of three parts, written piece by piece. lib3mf, the reference library, would be one more
native dependency, and holds the whole model first; the tests read with it what is written here.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from xml.sax.saxutils import quoteattr
from zipfile import ZIP_DEFLATED, ZipFile

import numpy as np
from numpy.typing import NDArray

from gearsim.geometry.triangles import TriangleMesh

_CHUNK = 1 << 16
_COLOURS = ("B0B0B0", "4477AA", "EE6677", "228833", "CCBB44", "66CCEE", "AA3377", "EE7733", "009988", "994455")
_XML = '<?xml version="1.0" encoding="UTF-8"?>\n'
_PACKAGE = "http://schemas.openxmlformats.org/package/2006"
_MICROSOFT = "http://schemas.microsoft.com/3dmanufacturing"
_TYPES = (
    f'{_XML}<Types xmlns="{_PACKAGE}/content-types">'
    '<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
    '<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>'
)
_START = (
    f'{_XML}<Relationships xmlns="{_PACKAGE}/relationships">'
    f'<Relationship Target="/3D/3dmodel.model" Id="model" Type="{_MICROSOFT}/2013/01/3dmodel"/></Relationships>'
)


def write_3mf(mesh: TriangleMesh, material: NDArray[np.integer], names: Sequence[str], file: Path) -> None:
    """Write a surface with 12 digits a coordinate; ``material``, of each triangle, is its place in ``names``."""
    with ZipFile(file, "w", ZIP_DEFLATED, compresslevel=1) as package:
        package.writestr("[Content_Types].xml", _TYPES)
        package.writestr("_rels/.rels", _START)
        with package.open("3D/3dmodel.model", "w", force_zip64=True) as model:
            for text in _model(mesh, material, names):
                model.write(text.encode())


def _model(mesh: TriangleMesh, material: NDArray[np.integer], names: Sequence[str]) -> Iterator[str]:
    yield f'{_XML}<model unit="millimeter" xml:lang="en-US" xmlns="{_MICROSOFT}/core/2015/02">\n<resources>\n'
    yield '<basematerials id="1">\n'
    for i, name in enumerate(names):
        plain = "".join(letter if letter.isprintable() else " " for letter in name)
        yield f'<base name={quoteattr(plain)} displaycolor="#{_COLOURS[i % len(_COLOURS)]}FF"/>\n'
    yield '</basematerials>\n<object id="2" type="model" pid="1" pindex="0">\n<mesh>\n<vertices>\n'
    yield from _lines('<vertex x="%.12g" y="%.12g" z="%.12g"/>\n', mesh.points)
    yield "</vertices>\n<triangles>\n"
    faces = np.column_stack([mesh.triangles, material])
    yield from _lines('<triangle v1="%d" v2="%d" v3="%d" pid="1" p1="%d"/>\n', faces)
    yield '</triangles>\n</mesh>\n</object>\n</resources>\n<build>\n<item objectid="2"/>\n</build>\n</model>\n'


def _lines(line: str, rows: NDArray) -> Iterator[str]:
    for begin in range(0, len(rows), _CHUNK):
        part = rows[begin : begin + _CHUNK]
        yield line * len(part) % tuple(part.ravel().tolist())
