"""A generating job: surfaces in closed form and the motions they are measured under, nothing cut yet."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from gearsim.cutters.profile import Profile
from gearsim.metrology.bevel import FlankMotion
from gearsim.metrology.dexel_check import slot_box
from gearsim.metrology.samples import SampleGrid, sample_grid
from gearsim.motion.segments import compile_motion
from gearsim.motion.sources import MotionSource
from gearsim.scene.generated import GeneratedScene
from gearsim.surfaces.blank import BevelBlank
from gearsim.surfaces.patch import Patch


@dataclass(frozen=True)
class Cut:
    """One tool, the surfaces it generates, and the motions they are measured under, the generating one first.

    ``sampled`` gives a motion made of N points, for those that converge to the generating one.
    """

    cutter: Profile
    patches: tuple[Patch, ...]
    sources: dict[str, MotionSource]
    sampled: dict[str, Callable[[int], MotionSource]] = field(default_factory=dict)

    @property
    def generating(self) -> str:
        """Name of the motion whose envelope the surfaces are."""
        return next(iter(self.sources))


@dataclass(frozen=True)
class GeneratingJob:
    """A scene made ready to run.

    ``texts`` says what each motion is, by name; ``frame`` is the frame of all coordinates in words;
    ``programs`` are texts to be written, by file name; ``blank`` is what the surfaces are cut into (None: they
    stand alone); ``notes`` are the machines' remarks on their axes (near-singular steps, free axes).
    """

    scene: GeneratedScene
    cuts: tuple[Cut, ...]
    texts: dict[str, str]
    frame: str
    programs: dict[str, str] = field(default_factory=dict)
    blank: BevelBlank | None = None
    notes: tuple[str, ...] = ()

    def compiled(self, cut: Cut, source: MotionSource) -> FlankMotion:
        """A motion of a cut's tool with its table, to the scene's tolerance."""
        tolerance = self.scene.simulation.compile_tolerance_mm
        return FlankMotion([source], compile_motion(source, cut.cutter.reach, tolerance))

    def grid(self, patch: Patch) -> SampleGrid:
        """The dense grid of one surface."""
        m = self.scene.metrology
        return sample_grid(patch, m.rows, m.columns, m.margin, m.window)

    def segment_count(self) -> int:
        """Rows of all motions' tables."""
        return sum(len(self.compiled(cut, source).table) for cut in self.cuts for source in cut.sources.values())

    def envelope_samples(self) -> int:
        """Samples the envelope road will solve for: those of all surfaces under all motions."""
        m = self.scene.metrology
        return sum(len(cut.patches) * len(cut.sources) for cut in self.cuts) * m.rows * m.columns

    def ray_count(self) -> int:
        """Rays the run will cut, the tri-dexel's check (a few thousand) left out."""
        m = self.scene.metrology
        motions = len(m.convergence) + 1 if m.convergence else 0
        converging = sum(len(cut.patches) * len(cut.sampled) for cut in self.cuts) * motions * m.rows * m.columns
        return self.envelope_samples() + converging + self._dexel_rays()

    def ring_pairs(self) -> int:
        """Rays times segments for ring-shaped heads, of whose bodies every ray near is within all along."""
        m = self.scene.metrology
        pairs = 0
        for cut in self.cuts:
            if cut.cutter.is_ring:
                sampled = [make(n) for make in cut.sampled.values() for n in m.convergence]
                rows = [len(self.compiled(cut, source).table) for source in (*cut.sources.values(), *sampled)]
                pairs += len(cut.patches) * m.rows * m.columns * sum(rows) + self._dexel_rays() * rows[0]
        return pairs

    def _dexel_rays(self) -> int:
        if self.blank is None:
            return 0
        patches = [p for cut in self.cuts for p in cut.patches]
        counts = slot_box(patches, self.blank, self.scene.simulation.dexel_pitch_mm).counts
        return int(counts[0] * counts[1] + counts[1] * counts[2] + counts[0] * counts[2])
