"""A cylindrical gear cut from CL data: with its tip under control, a spur gear's program says the same."""

import numpy as np

from gearsim.metrology.grid import DENSE
from gearsim.processes.gear_budget import first_space
from gearsim.processes.run import plan, run, study
from gearsim.programs.cldata import RAPID, CLPath, CLProgram, format_cl
from gearsim.scene import check_scene, load_scene, scene_table
from gearsim.simulation.operation import Variant
from gearsim.simulation.program import program_operations
from gearsim.toolpaths.cylindrical.posting import planned

FEW = ("toolpath.finishing.axial_step_mm=5", "toolpath.finishing.involute_step_mm=1")


def as_cl(blocks):
    """Blocks under tip control as CL data: each run of feeds or rapids a path."""
    tips, axes = blocks.machine.forward(np.concatenate([blocks.start[None], blocks.values]))
    ends = np.flatnonzero(np.diff(blocks.rapid)) + 1
    runs = [run for run in np.split(np.arange(len(blocks)), ends) if len(run)]
    at = [np.append(run[0], run + 1) for run in runs]
    names = [RAPID if blocks.rapid[run[0]] else "finish" for run in runs]
    return CLProgram(tuple(CLPath(n, tips[i], axes[i]) for n, i in zip(names, at, strict=True)))


def test_cl_data_of_one_space_cut_what_its_blocks_cut(tmp_path):
    scene, _ = load_scene("spur-external", FEW)
    gear, tables = scene.gear(), scene_table(scene)
    blocks = first_space(planned(gear, scene.controller(), (scene.finishing(),), True)[0], gear.count).blocks
    (tmp_path / "space.cl").write_text(format_cl(as_cl(blocks), "space", 600.0, 12))
    own = {"scene": {"name": "own"}, "surface": tables["surface"], "tools": tables["tools"][-1:]}
    own |= {"metrology": {"tolerance_um": 1e4, "rows": 5, "columns": 5, "margin": 0.2}}
    own |= {"toolpath": {"file": "space.cl"}, "simulation": {"dexel_pitch_mm": 2.0}}
    job = plan(check_scene(own, "own"), tmp_path)
    cutters = {blocks.tool[0]: job.variant("program").cutter}
    as_blocks = Variant("program", "", program_operations(blocks, cutters, 1e-9))
    table = study(job, {"blocks": {"program": as_blocks}})
    found = {
        (r["change"], r["surface"]): r["deviation_um.rms"] for r in table
        if (r["variant"], r["inspection"]) == ("program", DENSE)
    }  # fmt: skip
    assert set(found) == {(change, side) for change in ("", "blocks") for side in ("left", "right")}
    for side in ("left", "right"):
        assert 0.0 < found["", side] < 30.0  # um: chords of 1 mm along the involute
        assert abs(found["", side] - found["blocks", side]) < 1e-3
    assert run(check_scene(own, "own"), folder=tmp_path).measurements["left", "last operation", DENSE].gap.max_um < 1e-3
