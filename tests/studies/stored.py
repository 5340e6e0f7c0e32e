"""A small study whose outcomes are written down by hand: 20 jobs, 3 of which fail, two surfaces of 4 x 6 samples."""

from dataclasses import replace

import numpy as np

from gearsim.studies.records import Asked, Outcome, Parameter, Study, SurfaceMap

BAD = {3: "toolpath.points: too few", 11: "the tool does not reach the root", 17: "NOT_CONVERGED: loosen"}
SHAPE = (4, 6)


def study(folder, jobs=20, chunk=6, **changes):
    points = tuple(9 + 4 * (k % 3) for k in range(jobs))
    taper = tuple(14.9 + 0.01 * k for k in range(jobs))
    parameters = (
        Parameter("cutter.taper_deg", taper, 14.9, 15.1),
        Parameter("toolpath.points", points),
        Parameter("toolpath.mode", tuple("free-form" if k % 2 else "ruled" for k in range(jobs))),
    )
    made = Study(
        "wear", "wear of the cutter", {"scene": {"name": "wear"}, "metrology": {"rows": 4, "columns": 6}}, folder,
        parameters, "list", 1, Asked(("maps",), 0.1), chunk, {"study": {"name": "wear"}},
    )  # fmt: skip
    return replace(made, **changes)


def surface_map(job, surface="convex", moved=0.0):
    rows, columns = SHAPE
    u, v = np.linspace(0.0, 1.0, rows), np.linspace(0.0, 1.0, columns)
    offset = 100.0 if surface == "concave" else 0.0
    deviation = job + 0.1 * u[:, None] - 0.3 * v[None, :] + offset
    crossing = np.zeros(SHAPE, dtype=np.uint8)
    deviation[0, 0], crossing[0, 0] = np.nan, 1
    point = np.stack([*np.meshgrid(u + moved, v, indexing="ij"), np.full(SHAPE, offset)], axis=-1)
    normal = np.broadcast_to(np.array([0.0, 0.0, 1.0]), (*SHAPE, 3))
    return SurfaceMap(deviation, crossing, u, v, point, normal)


def outcome(job, moved=False):
    if job in BAD:
        return Outcome(job, "error", error=BAD[job])
    maps = {s: surface_map(job, s, job if moved else 0.0) for s in ("convex", "concave")}
    figures = {
        "convex.min_um": float(np.nanmin(maps["convex"].deviation_um)), "convex.samples": 24,
        "iso.F_alpha.right_um": None if job < 8 else 1.5 * job, "iso.class": "A5" if job == 19 else None,
    }  # fmt: skip
    return Outcome(job, "fail" if job > 9 else "unchecked", figures=figures, maps=maps)


def fill(store, chunks=None, moved=False):
    for chunk in range(store.study.chunks) if chunks is None else chunks:
        outcomes = [outcome(job, moved) for job in store.study.jobs_of(chunk)]
        store.put(chunk, outcomes[::-1], {"planning": 0.5, "kernel": 1.0})
    return store
