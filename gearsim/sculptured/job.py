"""From a scene of local gouging to its job: surface, tools and their passes, nothing cut yet."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from gearsim.cutters.profile import Profile
from gearsim.metrology.samples import SampleGrid, sample_grid
from gearsim.motion.segments import SegmentTable, compile_motion, join
from gearsim.scene import GougeExampleScene, SculpturedScene
from gearsim.surfaces.nurbs import NurbsSurface
from gearsim.toolpaths.drop_cutter import drop_path
from gearsim.toolpaths.sculptured import SculpturedPath, contact_path


@dataclass(frozen=True)
class ToolPass:
    """One tool with its passes, exact and as a table."""

    cutter: Profile
    path: SculpturedPath
    table: SegmentTable


@dataclass(frozen=True)
class SculpturedJob:
    """A scene made ready to run; without a surface (None) only worked examples are compared and drawn."""

    scene: SculpturedScene | GougeExampleScene
    surface: NurbsSurface | None
    tools: dict[str, ToolPass]

    def grid(self) -> SampleGrid:
        """Where the surface is measured."""
        assert isinstance(self.scene, SculpturedScene)
        assert self.surface is not None
        m = self.scene.metrology
        return sample_grid(self.surface, m.rows, m.columns, m.margin)

    def segment_count(self) -> int:
        """Rows of all tables."""
        return sum(len(t.table) for t in self.tools.values())

    def envelope_samples(self) -> int:
        """None: straight moves of a convex tool are checked by a search of their own."""
        return 0

    def ray_count(self) -> int:
        """Rays of the samples; those that probe beside gouging contacts are known only in the run."""
        if not isinstance(self.scene, SculpturedScene):
            return 0
        return len(self.tools) * self.scene.metrology.rows * self.scene.metrology.columns

    def ring_pairs(self) -> int:
        return 0


def plan(scene: SculpturedScene | GougeExampleScene, folder: Path) -> SculpturedJob:
    """Load the surface, a file of ``folder`` or a shipped one, and lay the passes of every tool."""
    if isinstance(scene, GougeExampleScene):
        return SculpturedJob(scene, None, {})
    surface = scene.surface.build(folder, scene.metrology.window_mm)
    tools = {}
    for name, cutter in scene.tools().items():
        path = _path(scene, surface, cutter)
        tolerance = scene.simulation.compile_tolerance_mm
        table = join([compile_motion(m, cutter.reach, tolerance) for m in path.motions()])
        tools[name] = ToolPass(cutter, path, table)
    return SculpturedJob(scene, surface, tools)


def _path(scene: SculpturedScene, surface: NurbsSurface, cutter: Profile) -> SculpturedPath:
    t = scene.toolpath
    chord = 1e-3 * t.chord_um
    if t.along == "u" or t.along == "v":
        return contact_path(surface, cutter, t.stepover_mm, t.points, along=t.along, margin=t.margin, tolerance=chord)
    return drop_path(surface, cutter, t.stepover_mm, t.points, along=t.along, tolerance=chord)
