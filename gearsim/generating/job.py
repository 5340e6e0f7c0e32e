"""A generating job: surfaces in closed form and the motions they are measured under, nothing cut yet."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from gearsim.cutters.profile import Profile
from gearsim.metrology.bevel import FlankMotion
from gearsim.metrology.samples import SampleGrid, sample_grid
from gearsim.motion.segments import compile_motion
from gearsim.motion.sources import MotionSource
from gearsim.scene.generated import GeneratedScene
from gearsim.surfaces.patch import Patch


@dataclass(frozen=True)
class GeneratingJob:
    """A scene made ready to run.

    ``sources`` and ``texts`` go by the motions' names, the generating one first; ``sampled`` gives a motion
    made of N points, for those that converge to the generating one; ``programs`` are texts to be written, by
    file name; ``frame`` is the frame of all coordinates in words.
    """

    scene: GeneratedScene
    cutter: Profile
    patches: tuple[Patch, ...]
    sources: dict[str, MotionSource]
    texts: dict[str, str]
    frame: str
    sampled: dict[str, Callable[[int], MotionSource]] = field(default_factory=dict)
    programs: dict[str, str] = field(default_factory=dict)

    @property
    def generating(self) -> str:
        """Name of the motion whose envelope the surfaces are."""
        return next(iter(self.sources))

    def compiled(self, source: MotionSource) -> FlankMotion:
        """A motion of this job's cutter with its table, to the scene's tolerance."""
        tolerance = self.scene.simulation.compile_tolerance_mm
        return FlankMotion([source], compile_motion(source, self.cutter.reach, tolerance))

    def grid(self, patch: Patch) -> SampleGrid:
        """The dense grid of one surface."""
        m = self.scene.metrology
        return sample_grid(patch, m.rows, m.columns, m.margin, m.window)

    def samples(self) -> int:
        """Samples of all surfaces under all motions."""
        m = self.scene.metrology
        return len(self.patches) * len(self.sources) * m.rows * m.columns

    def ray_count(self) -> int:
        """Rays the run will cut."""
        m = self.scene.metrology
        converging = len(self.sampled) * (len(m.convergence) + 1) if m.convergence else 0
        return self.samples() + len(self.patches) * converging * m.rows * m.columns
