#!/bin/sh
# OpenEXR 3.5's Python module: header numbers lose bits without a word, and a transposed map is scrambled.
#
# 1. A float of the header becomes a 32-bit float, numpy.float64 too: a pitch of 0.1 comes back as 0.10000000149 and
#    1e-50 as 0. An integer beyond 32 bits wraps: a time stamp of 3000000000 is -1294967296. Two float64 numbers in a
#    numpy array keep every bit, the same two in a tuple do not.
# 2. Pixels are taken from memory row by row, whatever the strides of the array: map.T has the right shape and the
#    numbers of map in the wrong places. A copy (numpy.ascontiguousarray) is right.
#
# Expected: the numbers that were handed over, or an error, as for pixels of float64. (The second is known, issue 1929
# of its repository.) Exits 0 while this is so.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install -q OpenEXR==3.5.3 numpy==2.4.6 >/dev/null 2>&1 ||
    { echo "the packages cannot be fetched"; exit 2; }
venv/bin/python - <<'END'
import sys

import numpy as np
import OpenEXR

print("OpenEXR", OpenEXR.__version__)
deviation = np.arange(6, dtype=np.float32).reshape(2, 3)


def back(header, pixels):
    OpenEXR.File(header, {"deviation": pixels}).write("map.exr")
    with OpenEXR.File("map.exr") as file:
        return file.header().get("number"), file.channels()["deviation"].pixels.astype(int).tolist()


as_before = True
single = float(np.float32(0.1))
for name, value, before in (
    ("0.1", 0.1, single),
    ("numpy.float64(0.1)", np.float64(0.1), single),
    ("1e-50", 1e-50, 0.0),
    ("3000000000", 3000000000, -1294967296),
    ("(0.1, 0.2)", (0.1, 0.2), [single, float(np.float32(0.2))]),
    ("numpy.array([0.1, 0.2])", np.array([0.1, 0.2]), [0.1, 0.2]),
):
    seen = back({"number": value}, deviation)[0]
    seen = [float(number) for number in seen] if isinstance(seen, np.ndarray) else seen
    print(f"1. {name}: expected as it is, seen {seen!r}")
    as_before &= seen == before
for name, pixels, before in (("map.T", deviation.T, [[0, 1], [2, 3], [4, 5]]),
                             ("its copy", np.ascontiguousarray(deviation.T), deviation.T.tolist())):
    seen = back({}, pixels)[1]
    print(f"2. {name}: expected {pixels.astype(int).tolist()}, seen {seen}")
    as_before &= seen == before
print("as before" if as_before else "CHANGED")
sys.exit(not as_before)
END
