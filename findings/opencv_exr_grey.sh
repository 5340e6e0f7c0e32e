#!/bin/sh
# OpenCV 4.14: the grey value of an EXR file is 9 % too large: a map of 1.0 in all three colours is read as 1.09.
#
# Colours are weighed by the x of their chromaticities, 0.64 + 0.30 + 0.15 = 1.09, which are places in a diagram of
# colours, not shares of light. IMREAD_ANYDEPTH, the flag for maps of floats, alone means grey, so a deviation map that was
# saved in three equal channels, by imwrite too, comes back with the wrong height and no word. cvtColor weighs the
# same pixels by 0.299, 0.587 and 0.114; a PNG file read as grey keeps its value; so does an EXR file of one channel.
#
# Expected: grey stays grey (docs, imread: converted to the single channel grayscale image; cvtColor: the weights).
# Exits 0 while this is so.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install -q opencv-python-headless==4.14.0.94 numpy==2.4.6 >/dev/null 2>&1 ||
    { echo "the packages cannot be fetched"; exit 2; }
OPENCV_IO_ENABLE_OPENEXR=1 venv/bin/python - <<'END'
import sys

import cv2
import numpy as np

print("OpenCV", cv2.__version__)
as_before = True


def look(title, pixels, expected, before):
    """What a map that was written by OpenCV itself is read as, in grey floats."""
    global as_before
    cv2.imwrite("map.exr", pixels)
    seen = float(cv2.imread("map.exr", cv2.IMREAD_ANYDEPTH)[0, 0])
    print(f"{title}: expected {expected:.4f}, seen {seen:.4f}")
    as_before &= abs(seen - before) < 1e-6


for title, colour, before in (("grey 1.0", (1, 1, 1), 1.09), ("grey -0.5", (-0.5, -0.5, -0.5), -0.545),
                              ("red 1.0", (0, 0, 1), 0.64), ("green 1.0", (0, 1, 0), 0.30), ("blue 1.0", (1, 0, 0), 0.15)):
    pixels = np.full((4, 4, 3), colour, dtype=np.float32)
    look(title, pixels, float(cv2.cvtColor(pixels, cv2.COLOR_BGR2GRAY)[0, 0]), before)
look("one channel 1.0", np.ones((4, 4), dtype=np.float32), 1.0, 1.0)
cv2.imwrite("map.png", np.full((4, 4, 3), 200, dtype=np.uint8))
png = int(cv2.imread("map.png", cv2.IMREAD_GRAYSCALE)[0, 0])
print(f"grey 200 as PNG: expected 200, seen {png}")
as_before &= png == 200
print("as before" if as_before else "CHANGED")
sys.exit(not as_before)
END
