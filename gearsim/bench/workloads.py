"""What the suites cut: rays, a motion and a tool, from the built-in scenes and from a block milled in five axes."""

from __future__ import annotations

from functools import cache
from math import radians
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.end_mills import ball
from gearsim.cutters.profile import Profile
from gearsim.geometry.rays import RayBundle, join_rays
from gearsim.geometry.rigid import Rigid
from gearsim.metrology.dexel_check import slot_box
from gearsim.metrology.samples import sample_grid
from gearsim.motion.segments import SegmentTable, compile_motion, join
from gearsim.motion.sources import CLMotion
from gearsim.processes.run import plan
from gearsim.scene import load_scene
from gearsim.simulation.dexels import DexelBox
from gearsim.simulation.operation import Operation
from gearsim.simulation.removal import Job
from gearsim.surfaces.patch import Tooth
from gearsim.surfaces.ruled_patch import ToothPatch

DEXEL_PITCH = 0.15
BLOCK = (100.0, 60.0, 20.0)
PITCH = 0.5
BLOCK_SEGMENTS = 500_000
BALL_MM, BALL_HEIGHT_MM = 6.0, 40.0
LEVELS = 10
STEPOVER = 1.0
TILT = radians(15.0)
COMPILED_AT_ONCE = 20_000


class Case(NamedTuple):
    """Rays to cut by a motion of a tool."""

    name: str
    rays: RayBundle
    table: SegmentTable
    cutter: Profile


class FlankWork(NamedTuple):
    """The README's job: its tooth and cutter, the convex flank's continuous pass and the whole program.

    The convex flank's own pass stands as two operations: continuous and by its CL data.
    """

    tooth: Tooth
    cutter: Profile
    theory: SegmentTable
    program: SegmentTable
    theory_pass: Operation
    cl_pass: Operation


@cache
def flank_job() -> FlankWork:
    """Scene spiral-bevel-flank, planned."""
    scene, folder = load_scene("spiral-bevel-flank")
    job = plan(scene, folder)
    flank = job.part.patch("convex")
    assert isinstance(flank, ToothPatch)
    theory, own, program = (job.variant(n, "convex").operations[0] for n in ("theory", "own pass", "program"))
    return FlankWork(flank.tooth, program.cutter, theory.table, program.table, theory, own)


def normals(rows: int, columns: int) -> RayBundle:
    """Rays along the normals of the README's convex flank."""
    return sample_grid(flank_job().tooth.flank("convex"), rows, columns).rays()


def slot_dexels(pitch: float = DEXEL_PITCH) -> RayBundle:
    """The bundle across the root of the README's slot; 42,840 rays at 0.15 mm."""
    job = flank_job()
    return slot_box(job.tooth.patches, job.tooth.blank, pitch).rays(2)


def about_dexels(count: int) -> RayBundle:
    """The same bundle at the pitch that makes about ``count`` rays of it."""
    return slot_dexels(DEXEL_PITCH * (42_840.0 / count) ** 0.5)


def flank_cases() -> list[Case]:
    """Normals of a flank through its continuous pass and the whole program; a tri-dexel's bundle through the latter."""
    job = flank_job()
    rays = normals(65, 513)
    return [
        Case("normals, continuous", rays, job.theory, job.cutter),
        Case("normals, CL data", rays, job.program, job.cutter),
        Case("tri-dexel, CL data", slot_dexels(), job.program, job.cutter),
    ]


def inspections(count: int) -> list[Job]:
    """So many small jobs: the README's flank on an inspector's 5 x 9 grid, the tool up to 10 um off."""
    job = flank_job()
    rays, table = normals(5, 9), job.theory
    errors = np.random.default_rng(1).uniform(-0.01, 0.01, (count, 3))
    return [Job(rays, table.moved(Rigid(np.eye(3), error)), job.cutter) for error in errors]


def head_case() -> Case:
    """Normals of the face-milled convex flank through the roll of its ring-shaped head."""
    scene, folder = load_scene("spiral-bevel-face-milled")
    job = plan(scene, folder)
    (roll,) = job.variant("roll", "convex").operations
    rays = sample_grid(job.part.patch("convex"), 33, 129, 0.01).rays()
    return Case("normals, head's roll", rays, roll.table, roll.cutter)


def pass_over_dexels() -> Case:
    """A tri-dexel's bundle through one pass without its run-in and run-out: about 9.6 candidates a ray."""
    job = flank_job()
    table = job.theory
    ends = round(0.19 * len(table))
    return Case("tri-dexel, one pass", slot_dexels(), table.part(slice(ends, len(table) - ends)), job.cutter)


def base_cases() -> list[Case]:
    """The removal suite's cases of fixed size: the README's flank and a ring-shaped head."""
    return [*flank_cases(), head_case()]


def block_path(share: float, over: float = 0.0) -> CLMotion:
    """Ramps in five axes over a share of the block, as many segments to its area as 500,000 to the whole.

    Ten levels, zigzag lines 1 mm apart, ``over`` [mm] beyond every side; from point to point the tip rises or
    sinks and the axis, within 15 degrees of the block's z, turns.
    """
    length, width, height = block_size(share)
    length, width = length + 2.0 * over, width + 2.0 * over
    lines = max(1, round(width / STEPOVER))
    points = max(2, 1 + round(length * width / (BLOCK[0] * BLOCK[1]) * BLOCK_SEGMENTS / (LEVELS * lines)))
    level, line, k = (a.ravel() for a in np.indices((LEVELS, lines, points)))
    along = k / (points - 1)
    along = np.where(line % 2 == 1, 1.0 - along, along)
    x, y = length * along - over, width * (line + 0.5) / lines - over
    ramp = 0.5 * np.sin(0.7 * x + 0.4 * y) + 0.05 * (k % 2)
    tips = np.stack([x, y, height * (1.0 - (level + 1.0) / LEVELS) + ramp], axis=1)
    return CLMotion(tips, _axes(TILT * np.sin(0.11 * x + level), 0.1 * x + 0.1 * y))


def _axes(tilt: NDArray, turn: NDArray) -> NDArray:
    return np.stack([np.sin(tilt) * np.cos(turn), np.sin(tilt) * np.sin(turn), np.cos(tilt)], axis=1)


def block_size(share: float) -> tuple[float, float, float]:
    """Length, width and height [mm] of a share of the block, full height."""
    return BLOCK[0] * share**0.5, BLOCK[1] * share**0.5, BLOCK[2]


def block_rays(share: float, pitch: float) -> RayBundle:
    """The tri-dexel of a share of the block, full height: its three bundles in one."""
    box = DexelBox(Rigid(np.eye(3), np.zeros(3)), np.zeros(3), np.array(block_size(share)), pitch)
    return join_rays([box.rays(axis) for axis in range(3)])


def block_case(share: float, pitch: float = PITCH, over: float = 0.0) -> Case:
    """A share of the block with its path, ``over`` [mm] beyond every side, and a 6 mm ball end mill."""
    cutter = ball(BALL_MM, BALL_HEIGHT_MM)
    return Case("block, tri-dexel", block_rays(share, pitch), compiled(block_path(share, over), cutter), cutter)


def compiled(path: CLMotion, cutter: Profile) -> SegmentTable:
    """A long path as a table, compiled in stretches to bound the memory."""
    tables = []
    for begin in range(0, path.pieces, COMPILED_AT_ONCE):
        part = slice(begin, min(begin + COMPILED_AT_ONCE, path.pieces) + 1)
        tables.append(compile_motion(CLMotion(path.tips[part], path.axes[part]), cutter.reach))
    return join(tables)
