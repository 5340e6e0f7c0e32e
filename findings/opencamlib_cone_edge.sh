#!/bin/sh
# opencamlib 2023.1.11: a ConeCutter dropped on a sloping edge cuts up to 0.5 mm into it; and drops end at height 0.
#
# 1. The tip is set on an edge as if the edge touched the cone elsewhere. The library's own answer for points of the
#    same edge is higher. Level edges, and edges steep enough to touch the rim, are right; so are ball and bull cutters.
# 2. A point begins at height 0 and is only raised: a surface at -5 is found "at 0", with no sign that nothing was met.
#
# Expected: the least height at which the cutter touches nothing (docs: drops the cutter along the z-axis until it
# makes contact). Exits 0 while this is so.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install -q opencamlib==2023.1.11 >/dev/null 2>&1 || { echo "the package cannot be fetched"; exit 2; }
venv/bin/python - <<'END'
import sys
from math import hypot, inf, pi

import opencamlib as ocl


def drop(cutter, corners, start=-100.0):
    """The height of the cutter's tip over (0, 0) on one triangle."""
    surface = ocl.STLSurf()
    surface.addTriangle(ocl.Triangle(*(ocl.Point(*map(float, corner)) for corner in corners)))
    dropper = ocl.BatchDropCutter()
    dropper.setSTL(surface)
    dropper.setCutter(cutter)
    dropper.appendPoint(ocl.CLPoint(0.0, 0.0, start))
    dropper.run()
    return dropper.getCLPoints()[0].z


print("opencamlib", ocl.version())
cone = ocl.ConeCutter(6, pi / 4, 20)  # diameter 6, half angle 45 degrees: the height of its flank is its radius
changed = False
for slope, offset, before in ((0.0, 1.0, 0), (0.25, 2.0, -48), (0.5, 1.0, -103), (0.9, 1.0, -465), (1.2, 1.0, 0)):
    # the upper edge of a wall along x, at y = offset, rising with the slope
    edge = drop(cone, ((-20, offset, -20 * slope), (20, offset, 20 * slope), (0, offset, -60)))
    at = [i / 1000 for i in range(-3000, 3001)]
    cone_rule = max(x * slope - hypot(x, offset) if hypot(x, offset) <= 3 else -inf for x in at)
    own = max(drop(cone, ((x, offset, x * slope), (x, offset, -60), (x + 1e-9, offset, -60))) for x in at[::10])
    error = 1e3 * (edge - cone_rule)
    print(f"1. slope {slope}, {offset} mm aside: expected {cone_rule:+.3f} (by the library's own points {own:+.3f}), "
          f"seen {edge:+.3f}: {error:+.0f} um")
    changed |= abs(error - before) > 1.0
flat = ((-50, -50, -5), (50, -50, -5), (0, 50, -5))
default, low = drop(ocl.BallCutter(6, 20), flat, ocl.CLPoint().z), drop(ocl.BallCutter(6, 20), flat)
print(f"2. plane at -5, point as made: expected -5, seen {default}; point set to -100: {low}")
changed |= (default, round(low, 9)) != (0.0, -5.0)
print("CHANGED" if changed else "as before")
sys.exit(changed)
END
