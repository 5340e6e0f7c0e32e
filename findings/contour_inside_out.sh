#!/bin/sh
# PyVista 0.49 on VTK 9.7, trimesh 5.2, manifold3d 3.5: the surface of a body contoured from its signed distance (minus
# inside) is inside out, PyVista's volume hides it, and the sign of every deviation measured against it turns.
#
# VTK's isosurface filters turn their triangles to the side of the small values, the inside of a distance field (tried:
# contour filter, marching cubes, flying edges, synchronized templates; vtkDiscreteMarchingCubes turns them outwards).
# PolyData.volume is positive all the same, while trimesh has minus that volume for the STL file, and manifold3d takes
# the body without a fault ("NoError") and loses volume where another body is added. compute_implicit_distance gives -6
# for a point 6 outside.
#
# Expected: triangles turned outwards, one volume in all three. Exits 0 while this is so.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install -q pyvista==0.49.1 vtk==9.7.2 trimesh==5.2.0 manifold3d==3.5.4 numpy==2.4.6 >/dev/null 2>&1 ||
    { echo "the packages cannot be fetched"; exit 2; }
venv/bin/python - <<'END'
import sys
from importlib.metadata import version

import numpy as np
import pyvista as pv
import trimesh
from manifold3d import Manifold, Mesh

print(", ".join(f"{name} {version(name)}" for name in ("pyvista", "vtk", "trimesh", "manifold3d")))
grid = pv.ImageData(dimensions=(33, 33, 33))
grid["distance"] = np.linalg.norm(grid.points - 16, axis=1) - 8.0  # a ball of radius 8 about (16, 16, 16)
ball = grid.contour([0.0], scalars="distance")
ball.save("ball.stl")
mesh = trimesh.load("ball.stl")
solid = Manifold(Mesh(np.array(mesh.vertices, np.float32), np.array(mesh.faces, np.uint32)))
apart = Manifold.cube((1, 1, 1)).translate((30, 30, 30))
outside = pv.PolyData(np.array([[30.0, 16.0, 16.0]])).compute_implicit_distance(ball)["implicit_distance"][0]
seen = {
    "PyVista's volume": (2124.7, ball.volume),
    "trimesh's volume of the STL file": (2124.7, mesh.volume),
    "manifold3d's volume": (2124.7, solid.volume()),
    "the same with a cube of 1 added that stands apart": (2125.7, (solid + apart).volume()),
    "distance of a point 6 outside": (6.0, outside),
}
for what, (expected, value) in seen.items():
    print(f"{what}: expected {expected:+.1f}, seen {value:+.1f}")
print("watertight:", mesh.is_watertight, " manifold3d:", solid.status())
before = (2124.7, -2124.7, -2124.7, -2123.7, -6.0)
as_before = np.allclose([value for _, value in seen.values()], before, atol=0.1) and mesh.is_watertight
print("as before" if as_before else "CHANGED")
sys.exit(not as_before)
END
