"""A study's data set read back: a map drawn, and maps foretold from parameters by ridge regression on their modes."""

from pathlib import Path
from tempfile import TemporaryDirectory

import matplotlib.pyplot as plt
import numpy as np
import pyarrow.parquet as pq
import zarr

import gearsim

STUDY = {
    "study": {
        "name": "ridge", "summary": "cutter and path of a spiral bevel gear", "scene": "spiral-bevel-flank",
        "method": "sobol", "samples": 32, "seed": 1, "cross_checked": 0.0,
        "set": {"metrology.rows": 5, "metrology.columns": 17},
    },
    "vary": [
        {"key": "cutter.taper_deg", "low": 14.5, "high": 15.5},
        {"key": "cutter.bottom_radius_mm", "low": 0.9, "high": 1.0},
        {"key": "toolpath.points", "values": [17, 25, 33]},
    ],
}  # fmt: skip

with TemporaryDirectory() as folder:
    out = Path(folder)
    gearsim.study(STUDY, out)
    jobs = pq.read_table(out / "jobs.parquet").to_pydict()
    maps = zarr.open_group(out / "maps.zarr", mode="r")["convex_deviation_um"][:]  # (jobs, rows, columns)

    plt.switch_backend("Agg")
    limit = np.nanmax(np.abs(maps[0]))
    plt.imshow(maps[0], origin="lower", cmap="RdBu_r", vmin=-limit, vmax=limit, aspect="auto")
    plt.colorbar(label="deviation [µm], + material left")
    plt.savefig(out / "map.png")
    print(
        f"job 0 drawn: {maps[0].shape[0]} x {maps[0].shape[1]} samples, {maps[0].min():.3f} to {maps[0].max():.3f} um"
    )

# Parameters as numbers about 0, their squares and products; the steps of a path count by the square of their length.
taper, radius, points = (np.array(jobs[vary["key"]], dtype=float) for vary in STUDY["vary"])
x = np.column_stack([taper, radius, 1.0 / (points - 1.0) ** 2])
x = (x - x.mean(axis=0)) / x.std(axis=0)
x = np.column_stack([x, *(x[:, i] * x[:, j] for i in range(3) for j in range(i + 1))])

good = np.array(jobs["verdict"]) != "error"
x, y = x[good], maps[good].reshape(good.sum(), -1)
seen, unseen = np.arange(len(y)) < 24, np.arange(len(y)) >= 24

mean = y[seen].mean(axis=0)
_, _, modes = np.linalg.svd(y[seen] - mean, full_matrices=False)
modes = modes[:3]
design = np.column_stack([np.ones(len(x)), x])
weights = np.linalg.solve(
    design[seen].T @ design[seen] + 1e-3 * np.eye(design.shape[1]), design[seen].T @ (y[seen] - mean) @ modes.T
)
predicted = mean + design @ weights @ modes


def rms(um):
    return float(np.sqrt(np.mean(um**2)))


error, spread = rms((predicted - y)[unseen]), rms((y - mean)[unseen])
print(f"{unseen.sum()} unseen jobs: maps predicted to {error:.4f} um RMS; they differ from the mean by {spread:.4f} um")
