#!/bin/sh
# contourpy 1.3.3 (numpy 2.3.5): points of a contour line are not exactly on the grid lines that they cross.
#
# A contour of values on a grid crosses grid lines, so of every point one index is meant to be whole; a reader that
# puts segments of neighbouring cells together, or looks up the cell of a point, may rely on it. Guessed: whole, as bits.
# Seen: on a plain ramp some points lie rounding beside the line, so that floor() puts them into the wrong cell.
#
# Exits 0 while this is so.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install -q contourpy==1.3.3 numpy==2.3.5 >/dev/null 2>&1 || { echo "the packages cannot be fetched"; exit 2; }
venv/bin/python - <<'END'
import sys

import contourpy
import numpy as np

z = np.add.outer(np.arange(21.0), 0.37 * np.arange(257.0))
points = np.concatenate(contourpy.contour_generator(z=z).lines(15.1))
off = np.abs(points - np.round(points)).min(axis=1)
beside, largest = int((off > 0.0).sum()), float(off.max())
print(f"contourpy {contourpy.__version__}: {beside} of {len(points)} points beside both grid lines, at most {largest:.1e} cells")
as_before = beside > 0 and largest < 1e-12
print("as before" if as_before else "CHANGED")
sys.exit(not as_before)
END
