"""The house rules that a machine can check."""

import ast
import re
import subprocess
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).parent.parent

# From the ground up: a room may import rooms before it, never behind it.
ORDER = [
    "scratch", "errors", "geometry", "cutters", "machines", "surfaces", "programs", "motion", "toolpaths", "kernels",
    "envelope", "simulation", "metrology", "gouging", "result", "output", "scene", "processes", "studies", "verify",
    "bench", "arguments", "cli",
]  # fmt: skip
LAUNCHERS = {"kernels", "envelope", "simulation", "gouging", "verify", "bench"}
HEAVY = {"warp", "vtkmodules", "OpenEXR", "pyarrow", "matplotlib", "plotly", "PIL"}


def modules():
    for folder, package in ((ROOT / "gearsim", "gearsim"), (ROOT / "kernels", "gearsim.kernels")):
        for file in sorted(folder.rglob("*.py")):
            parts = file.relative_to(folder).with_suffix("").parts
            yield ".".join([package, *(p for p in parts if p != "__init__")]), file


def imports(file):
    for node in ast.walk(ast.parse(file.read_text())):
        if isinstance(node, ast.ImportFrom) and node.module:
            yield from [f"{node.module}.{a.name}" for a in node.names]
        elif isinstance(node, ast.Import):
            yield from [a.name for a in node.names]


def room(name):
    parts = name.split(".")
    return parts[1] if len(parts) > 1 and parts[0] == "gearsim" else None


def test_imports_point_up_the_list():
    for name, file in modules():
        here = room(name)
        if here is None:  # gearsim itself, which loads its rooms on demand
            continue
        for target in imports(file):
            there = room(target)
            if there in ORDER and there != here:
                assert ORDER.index(there) < ORDER.index(here), f"{name} imports {target}"


def test_every_room_is_in_the_list():
    assert {room(name) for name, _ in modules()} - {None} == set(ORDER)


def test_only_the_launchers_know_warp_and_only_the_scene_pydantic():
    for name, file in modules():
        packages = {target.split(".")[0] for target in imports(file)}
        assert "warp" not in packages or room(name) in LAUNCHERS, name
        assert "pydantic" not in packages or room(name) == "scene", name


def test_every_package_folder_is_listed_for_installation():
    listed = set(tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]["packages"])
    folders = {
        "gearsim" + "".join(f".{p}" for p in f.parent.relative_to(ROOT / "gearsim").parts)
        for f in (ROOT / "gearsim").rglob("*.py")
    }
    assert listed == folders | {"gearsim.kernels", "gearsim.scenes"}


def test_no_process_is_named_outside_processes_and_scene():
    """Neither a planner's module, nor its kind of scene, nor the kinds of surfaces that scenes go by."""
    from gearsim.processes.run import _PLANNERS
    from gearsim.scene.loading import SCENES

    shared = {"envelope", "nurbs"}  # a road and a kernel as well
    names = {*_PLANNERS, *(f"processes.{planner}" for planner in _PLANNERS.values())}
    quoted = {f'"{kind}"' for kind in SCENES if kind not in shared}
    found = [
        f"{name}: {word}" for name, file in modules() if room(name) not in ("processes", "scene")
        for word in names | quoted if re.search(rf"(?<!\w){re.escape(word)}(?!\w)", file.read_text())
    ]  # fmt: skip
    assert found == []


def loaded_after(code):
    script = f"{code}\nimport sys\nprint(*sys.modules)"
    return set(
        subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout.split()
    )


def test_importing_gearsim_loads_nothing_heavy():
    assert not loaded_after("import gearsim") & (HEAVY | {"pydantic", "scipy"})
    assert not loaded_after("import gearsim.cli; gearsim.cli.parser(gearsim.cli._RUNS)") & HEAVY


def test_a_job_loads_what_it_uses():
    """One that cuts nothing: neither Warp, nor what few jobs need, nor the other kinds of scenes."""
    loaded = loaded_after("import gearsim; gearsim.run('gouge-flat-end-mill')")
    kinds = {"any_program", "cylindrical", "faced_part", "flank_milling", "generated", "sculptured", "solid_part"}
    assert not loaded & (HEAVY | {"scipy"})
    assert loaded & {f"gearsim.scene.{kind}" for kind in kinds} == {"gearsim.scene.sculptured"}


def test_kernels_carry_no_backward_pass_and_name_their_outputs():
    assert '"enable_backward": False' in (ROOT / "kernels/options.py").read_text()
    for name, file in modules():
        if room(name) != "kernels":
            continue
        text, tree = file.read_text(), ast.parse(file.read_text())
        kernels = [
            n for n in ast.walk(tree)
            if isinstance(n, ast.FunctionDef) and any("kernel" in ast.unparse(d) for d in n.decorator_list)
        ]  # fmt: skip
        if kernels:
            assert "wp.set_module_options(OPTIONS)" in text, name
        for kernel in kernels:
            lines = ast.get_source_segment(text, kernel)
            after = [a.arg for a in kernel.args.args][lines.split("# out")[0].count(": ") :]
            assert after, f"{name}.{kernel.name} has no outputs"
            assert all(a.endswith("_out") for a in after), f"{name}.{kernel.name}: {after}"


def test_no_file_outgrows_one_idea():
    long = {name: n for name, f in modules() if (n := len(f.read_text().splitlines())) > 330}
    assert not long
