#!/bin/sh
# numpy-stl 4.1: Mesh.rotate turns to the left where Mesh.transform turns to the right.
#
# rotate([0, 0, 1], radians(90)) takes (1, 0, 0) to (0, -1, 0): a left-handed turn about the axis. The right-handed
# matrix of 90 degrees, given to transform of the same mesh, takes it to (0, 1, 0). rotation_matrix returns that
# right-handed matrix, and rotate, which uses it, applies it to rows. A flank turned to be compared lands twice the
# angle away.
#
# Expected: one sense of turning, the right-handed one (docs, rotate: theta, the rotation angle in radians; the sense is
# not spoken of; issue 166 of its repository is closed). Exits 0 while this is so.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install -q numpy-stl==4.1.1 numpy==2.4.6 scipy==1.17.1 >/dev/null 2>&1 ||
    { echo "the packages cannot be fetched"; exit 2; }
venv/bin/python - <<'END'
import sys
from importlib.metadata import version

import numpy as np
from scipy.spatial.transform import Rotation
from stl.mesh import Mesh

print("numpy-stl", version("numpy-stl"))
right = Rotation.from_rotvec([0, 0, np.pi / 2]).as_matrix()  # takes x to y


def corner(turn):
    """Where the corner (1, 0, 0) of a mesh lies after a turn."""
    mesh = Mesh(np.zeros(1, dtype=Mesh.dtype))
    mesh.vectors[:] = [[[1, 0, 0], [2, 0, 0], [1, 0, 1]]]
    turn(mesh)
    return (mesh.vectors[0, 0].round(6) + 0).tolist()


whole = np.eye(4)
whole[:3, :3] = right
rotated = corner(lambda mesh: mesh.rotate([0, 0, 1], np.pi / 2))
transformed = corner(lambda mesh: mesh.transform(whole))
same = np.allclose(Mesh.rotation_matrix([0, 0, 1], np.pi / 2), right)
print(f"(1, 0, 0) turned by +90 degrees about z: expected [0, 1, 0]; rotate {rotated}, transform {transformed}")
print(f"rotation_matrix is SciPy's right-handed one: expected True, seen {same}")
as_before = rotated == [0, -1, 0] and transformed == [0, 1, 0] and same
print("as before" if as_before else "CHANGED")
sys.exit(not as_before)
END
