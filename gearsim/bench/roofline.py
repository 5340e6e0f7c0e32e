"""Where the removal kernels stand under the device's ceilings: operations and bytes of a ray-segment pair.

Operations are counted by hand in the kernels' source: +, -, *, / and a square root count one each; comparisons,
min, max, abs and signs none; a dot product of space 5, a length 6. What is left out makes the counts low, never
high: the turning away of candidates that do not become pairs, alone or in groups, the other end of the chords a pair
begins with, Newton's steps into an arc, hits hidden between misses, and the upkeep of the interval lists.

| part | source | operations |
| --- | --- | --- |
| pose | kernels/pose.py: 5 Horner steps of tip, axis and both rates, 24 each | 120 |
| tool ray | kernels/tool_ray.py ``tool_ray`` | 53 |
| line slab | kernels/cull.py: planes 6, inflation 2; kernels/tool_ray.py ``line_interval`` 17 | 25 |
| arc slab | kernels/cull.py: planes 6, inflation 2; kernels/tool_ray.py ``ball_interval`` 12 | 20 |
| contact | kernels/contact.py: point 14, parameter 1, face normal 5, rates 35 | 55 |
| search | kernels/search.py: bounds of a step, and a third each of the ways to the next guess | 40 |
| ring | kernels/ring.py: pose 120, point 30, rates 59 | 209 |
| ring line, arc | kernels/ring.py ``section_distance`` | 4, 13 |
"""

from __future__ import annotations

from typing import Any

from gearsim.bench.ceiling import ceiling
from gearsim.bench.workloads import Case
from gearsim.cutters.checks import CORNER, joints, turn
from gearsim.cutters.profile import Profile

OPERATIONS = {
    "pose": 120, "tool ray": 53, "line slab": 25, "arc slab": 20, "contact": 55, "search": 40,
    "ring": 209, "ring line": 4, "ring arc": 13,
}  # fmt: skip
ROW_BYTES = 2 * 6 * 24 + 3 * 8
SLAB_BYTES = 5 * 8 + 4
RAY_BYTES = 2 * 24 + 2 * 8 + 3 * 4
COLUMNS = ("poses/pair", "flop/pair", "bytes/pair", "of flops", "of copy")


def cull_operations(cutter: Profile) -> float:
    """Operations that let one pair pass, mean over the cutter's parts times their number."""
    if cutter.is_ring:
        return OPERATIONS["tool ray"] + OPERATIONS["line slab"]
    return OPERATIONS["tool ray"] * len(cutter.parts) + _slabs(cutter)


def evaluation_operations(cutter: Profile) -> float:
    """Operations of one evaluation of a pair: a chord's end at a pose and the search's step; a ring's distance."""
    op = OPERATIONS
    if cutter.is_ring:
        pairs = list(joints(cutter.elements, ring=True))
        lines = sum(not e.is_arc for e, _ in pairs)
        arcs = len(pairs) - lines + sum(turn(e, after) > CORNER for e, after in pairs)
        return op["ring"] + lines * op["ring line"] + arcs * op["ring arc"]
    slabs = _slabs(cutter) / len(cutter.parts)
    return op["pose"] + op["tool ray"] + slabs + op["contact"] + op["search"]


def _slabs(cutter: Profile) -> float:
    rising = [e for part in cutter.parts for e in part.elements if not e.is_flat]
    return float(sum(OPERATIONS["arc slab" if e.is_arc else "line slab"] for e in rising))


def roofline(device: str, case: Case, row: dict[str, Any], poses: int) -> dict[str, Any]:
    """The roofline columns of a timed row, from the ``poses`` that the whole cut evaluated.

    Every pose is an evaluation of a pair, and every pair was let pass once. Bytes are what the kernel loads,
    cached or not: a row of the table and the slabs with every pose, the ray, and two ends a pair. On several
    threads the ceilings are as many times those of one.
    """
    pairs = max(row["pairs"], 1)
    flop = pairs * cull_operations(case.cutter) + poses * evaluation_operations(case.cutter)
    slabs = sum(not e.is_flat for part in case.cutter.parts for e in part.elements)
    loaded = poses * (ROW_BYTES + slabs * SLAB_BYTES) + row["rays"] * RAY_BYTES + pairs * 24
    top = ceiling(device)
    return {
        "poses/pair": poses / pairs,
        "flop/pair": flop / pairs,
        "bytes/pair": loaded / pairs,
        "Gflop/s": 1e-9 * flop / row["seconds"],
        "of flops": flop / row["seconds"] / (top.flops * row["threads"]),
        "of copy": loaded / row["seconds"] / (top.bytes * row["threads"]),
    }
