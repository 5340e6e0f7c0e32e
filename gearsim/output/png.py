"""PNG files of opaque pictures.

Rows are packed as they are: to try all of PNG's filters on every row, as libraries do, takes three times as long and
makes pictures of lines and texts no smaller.
"""

from __future__ import annotations

import struct
import zlib
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

_LEVEL = 3  # of zlib's 9: half the time of its usual 6, files a tenth larger


def write_png(pixels: NDArray[np.uint8], file: Path) -> None:
    """Write red, green and blue, shape (height, width, 3), the top row first. Raises OSError where nothing is written.

    After PNG, third edition, sections 5 and 11: the signature, then chunks IHDR, IDAT, IEND.
    """
    height, width, channels = pixels.shape
    rows = np.zeros((height, 1 + channels * width), dtype=np.uint8)  # each begins with its filter: none
    rows[:, 1:] = pixels.reshape(height, channels * width)
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    chunks = ((b"IHDR", header), (b"IDAT", zlib.compress(rows.tobytes(), _LEVEL)), (b"IEND", b""))
    file.write_bytes(b"\x89PNG\r\n\x1a\n" + b"".join(_chunk(kind, data) for kind, data in chunks))


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
