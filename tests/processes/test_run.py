"""Planning, running and estimating any job: counts told beforehand, questions joined, what is refused."""

from dataclasses import replace

import numpy as np
import pytest

from gearsim.cli import main
from gearsim.errors import InputError
from gearsim.geometry.rigid import Rigid
from gearsim.motion.sources import MovedMotion
from gearsim.processes.run import estimate, plan, run, study
from gearsim.scene import load_scene

FLANK = (
    "metrology.rows=3", "metrology.columns=9", "metrology.convergence=[9]", "simulation.dexel_pitch_mm=1.0",
    "toolpath.points=17",
)  # fmt: skip
GENERATED = ("metrology.rows=2", "metrology.columns=3", "metrology.convergence=[]", "simulation.dexel_pitch_mm=2.5")
GEAR = (
    "metrology.spaces=1", "metrology.points=9", "metrology.rows=3", "metrology.columns=3",
    "metrology.section_pitch_mm=2", "simulation.dexel_pitch_mm=1.0", "toolpath.finishing.axial_step_mm=5",
    "budget.decimals=[3]", "budget.involute_steps_mm=[]", "budget.axial_steps_mm=[]",
)  # fmt: skip
SURFACE = ("metrology.rows=9", "metrology.columns=5", "toolpath.stepover_mm=16", "toolpath.points=9")
SCENES = {
    "spiral-bevel-flank": FLANK, "spiral-bevel-formate": GENERATED, "apt-envelope": GENERATED,
    "hypoid-pinion-phoenix": GENERATED, "spur-external": GEAR, "gouge-horizontal-cylinder": SURFACE, "gouge-cases": (),
}  # fmt: skip


@pytest.mark.parametrize("name", SCENES)
def test_a_dry_run_counts_the_very_rays_and_segments_that_the_run_begins_with(name):
    scene, folder = load_scene(name, SCENES[name])
    told, counts = estimate(scene, folder), run(scene, folder=folder).counts
    assert told["rays"] == counts["rays"] - counts["following_rays"]
    assert told["segments"] == counts["segments"]
    assert (told["rays"] > 0) == (name != "gouge-cases")


def test_overrides_beside_a_scene_are_refused_not_dropped():
    scene, folder = load_scene("gouge-cases")
    with pytest.raises(InputError, match=r"overrides \(metrology\.rows=3\) change a scene that is named or a file"):
        run(scene, folder=folder, overrides=("metrology.rows=3",))


@pytest.mark.parametrize("more", [("--dry-run",), ()])
def test_a_device_that_is_not_there_is_refused_by_a_dry_run_too(more, tmp_path, capsys):
    assert main(["run", "gouge-cases", "--device", "cuda:99", "--out", str(tmp_path / "o"), *more]) == 2
    assert "no device 'cuda:99'; this machine has cpu" in capsys.readouterr().err


def test_a_study_tells_every_change_beside_the_job_itself():
    """A pass moved 5 um off along the flank's normal leaves 5 um; the other flank's variants stay as they are."""
    job = plan(*load_scene("spiral-bevel-flank", FLANK))
    own = job.variant("own pass", "convex")
    normal = job.inspections[0].grid(job).normal.reshape(-1, 3).mean(axis=0)
    shift = Rigid(np.eye(3), 5e-3 * normal / np.linalg.norm(normal))
    operation = own.operations[0]
    moved = replace(operation, sources=tuple(MovedMotion(s, shift) for s in operation.sources),
                    table=operation.table.moved(shift))  # fmt: skip
    table = study(job, {"5 um off": {"own pass": replace(own, operations=(moved,))}})
    dense = {
        (r["change"], r["surface"]): r for r in table if (r["variant"], r["inspection"]) == ("own pass", "dense grid")
    }
    at, other = ({change: dense[change, side] for change in ("", "5 um off")} for side in ("convex", "concave"))
    assert other[""]["deviation_um.mean"] == other["5 um off"]["deviation_um.mean"]
    rise = at["5 um off"]["deviation_um.mean"] - at[""]["deviation_um.mean"]
    assert rise == pytest.approx(5.0, abs=0.5)
    assert at["5 um off"]["envelope_gap_um.max"] < 1e-3
    with pytest.raises(InputError, match="no variant 'y'; there are program, theory"):
        study(job, {"x": {"y": own}})
