#!/bin/sh
# py_gearworks 0.0.24: the CAD model of a helical gear leaves the involute helicoid by 77 um, ten times the tolerance
# of a good gear, and that of a slightly wider gear by 3 um.
#
# build_part puts 3 sections across the face, 4 from a twist of 30 degrees on: z 20, m 4, 30 degrees is 12 um off at a
# width of 20 mm, 77 um at 40 mm, where it twists by 28.6 degrees, and 3 um at 45 mm. With n_vert=4 the 40 mm are 2.4 um
# off. Spur flanks are 2.9 um off, by the four control points of their profile.
#
# Expected: flanks true to far below what a gear is inspected to, and not better for being wider (docs, GearBuilder: 4
# slices by default; the error is not spoken of). Exits 0 while this is so. Installs about 2 GB.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install -q py-gearworks==0.0.24 build123d==0.12.0 numpy==2.4.6 >/dev/null 2>&1 ||
    { echo "the packages cannot be fetched"; exit 2; }
venv/bin/python - <<'END' 2>/dev/null
import sys
from importlib.metadata import version
from math import atan, cos, radians, tan

import numpy as np
import py_gearworks

TEETH, MODULE = 20, 4.0


def deviation(helix, width, **fit):
    """The spread of the normal deviation over the first involute flank in um, 2 % left out at each edge."""
    kind = {"helix_angle": helix} if helix else {}
    maker = py_gearworks.HelicalGear if helix else py_gearworks.SpurGear
    part = maker(number_of_teeth=TEETH, module=MODULE, height=width, **kind).build_part(**fit)
    pitch = TEETH * MODULE / cos(helix) / 2
    base = pitch * cos(atan(tan(radians(20)) / cos(helix)))
    to_normal = 1e3 * base * cos(atan(tan(helix) * base / pitch))
    steps = [float(s) for s in np.linspace(0.02, 0.98, 25)]
    for face in part.faces():
        points = np.array([tuple(face.position_at(u, v)) for u in steps for v in steps])
        radius = np.hypot(points[:, 0], points[:, 1])
        if radius.min() <= base or np.ptp(radius) < MODULE / 2:
            continue  # a root, a tip or an end face
        pressure = np.arccos(base / radius)
        angle = np.arctan2(points[:, 1], points[:, 0]) - points[:, 2] * tan(helix) / pitch
        for side in (1, -1):  # on the right side the angle at the base circle is the same for all points
            at_base = angle + side * (np.tan(pressure) - pressure)
            spread = np.ptp(np.angle(np.exp(1j * (at_base - at_base[0])))) * to_normal
            if spread < 200:
                return spread
    raise SystemExit("no flank was found")


print("py_gearworks", version("py-gearworks"))
as_before = True
for helix, width, before, fit in (
    (0.0, 20.0, 2.86, {}),
    (radians(30), 20.0, 11.7, {}),
    (radians(30), 40.0, 76.6, {}),
    (radians(30), 45.0, 2.65, {}),
    (radians(30), 40.0, 2.42, {"n_vert": 4}),
):
    seen = deviation(helix, width, **fit)
    case = f"z 20, m 4, helix {np.degrees(helix):.0f} deg, width {width:.0f} {fit or ''}"
    print(f"{case}: expected below 1 um, seen {seen:.2f}")
    as_before &= abs(seen - before) < 0.1 * before
print("as before" if as_before else "CHANGED")
sys.exit(not as_before)
END
