"""Files of every kind that once went wrong, walked by a table; copies lie under tests/data/gouge."""

from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

from gearsim.cli import main
from gearsim.errors import InputError
from gearsim.gouging.asked import read_faces
from gearsim.gouging.check import check_faces
from gearsim.gouging.standard_mills import metric_mills
from gearsim.scene.catalogue import read_cutter
from tests.gouging.cad_parts import in_process

DATA = Path(__file__).parent.parent / "data" / "gouge"
FREE, GOUGES, UNCHECKED = "pass", "fail", "unchecked"
TAPERED = ("tapered", "tip_diameter_mm=4", "taper_deg=10", "height_mm=10")
CASES = [
    ("facing_down.json", ("ball", "diameter_mm=12"), UNCHECKED),
    ("vgroove.json", ("ball", "diameter_mm=60"), GOUGES),
    ("vgroove.json", ("ball", "diameter_mm=0.02"), GOUGES),
    ("vgroove.json", ("flat", "diameter_mm=6"), GOUGES),
    ("narrow_fillet.json", ("ball", "diameter_mm=12"), GOUGES),
    ("narrow_fillet.json", ("ball", "diameter_mm=2"), FREE),
    ("narrow_fillet.json", ("ball", "diameter_mm=2.00001"), GOUGES),
    ("wall88.json", TAPERED, UNCHECKED),
    ("wall88.json", ("tapered", "tip_diameter_mm=4", "taper_deg=2", "height_mm=10"), FREE),
    ("wall_a.igs", ("ball", "diameter_mm=40"), FREE),
    ("wall_blank.igs", ("ball", "diameter_mm=12"), FREE),
    ("bom.step", ("ball", "diameter_mm=20"), FREE),
    ("bom.step", ("ball", "diameter_mm=20.00001"), GOUGES),
    ("torus.step", ("ball", "diameter_mm=16"), FREE),
    ("torus.step", ("ball", "diameter_mm=16.00001"), GOUGES),
    ("trim_flat.step", ("ball", "diameter_mm=12"), FREE),
    ("trim_flat.step", ("ball", "diameter_mm=60"), FREE),
]


def judged(name, cutter, **options):
    return check_faces(read_faces(str(DATA / name)), read_cutter(list(cutter)), metric_mills(), grid=48, **options)


@pytest.mark.parametrize(("name", "cutter", "verdict"), CASES, ids=lambda x: x if isinstance(x, str) else x[-1])
def test_every_file_gives_what_is_right(name, cutter, verdict, monkeypatch):
    if not name.endswith(".json"):
        in_process(monkeypatch)
    check = judged(name, cutter)
    assert check.verdict == verdict, check.status
    assert check.exit_code == {FREE: 0, GOUGES: 1, UNCHECKED: 3}[verdict]


def test_every_file_is_in_the_table():
    elsewhere = {"scale_half.igs"}
    assert {f.name for f in DATA.iterdir()} == {name for name, *_ in CASES} | elsewhere


def test_a_drawing_scale_is_refused():
    with pytest.raises(InputError, match=r"scale_half.igs, global field 13: the model space scale is 0.5; expected 1"):
        read_faces(str(DATA / "scale_half.igs"))


def test_a_margin_leaves_out_borders_and_no_crease_between_them():
    """The groove's crease lies in the middle; with a margin it was not looked at, and a ball was let in."""
    assert judged("vgroove.json", ("ball", "diameter_mm=8"), margin=0.02).verdict == GOUGES


LOCAL = "local gouging alone: whether the tool hits the part beside its contact was not asked"


@pytest.mark.parametrize(
    ("name", "cutter", "options", "told"),
    [
        ("narrow_fillet.json", ("ball", "diameter_mm=2"), {}, ["it gouges at no place looked at", "places tie"]),
        ("narrow_fillet.json", ("ball", "diameter_mm=12"), {}, ["it gouges at ", " points of ", "it is worst at ("]),
        ("vgroove.json", ("ball", "diameter_mm=8"), {"margin": 0.02},
         ["places on borders and where faces meet", "2 % of every face was left out at its borders"]),
        ("facing_down.json", ("ball", "diameter_mm=12"), {}, ["the tool reaches no point: nothing was judged"]),
        ("wall88.json", TAPERED, {}, ["the tool reaches no point"]),
    ],
)  # fmt: skip
def test_the_headline_names_what_is_wrong_and_what_was_not_looked_at(name, cutter, options, told):
    check = judged(name, cutter, **options)
    assert all(words in check.headline for words in told), check.headline
    assert check.headline.endswith(LOCAL)
    assert ("gouges at no place" in check.headline) == (check.verdict == FREE)


def test_faces_not_looked_at_are_named_beside_a_gouge_too():
    asked = read_faces(str(DATA / "vgroove.json"))
    short = replace(asked, left_out=374, skipped=("face 7: cannot be read",), notes=("a side is assumed",))
    ridge = replace(asked.faces[0], surface=replace(asked.faces[0].surface, flip=not asked.faces[0].surface.flip))
    for faces, verdict in ((asked.faces, GOUGES), ((ridge,), UNCHECKED)):
        check = check_faces(
            replace(short, faces=faces), read_cutter(["ball", "diameter_mm=8"]), metric_mills(), grid=16
        )
        assert check.verdict == verdict
        for told in ("374 faces of the file were not looked at", "1 faces could not be read: face 7", "assumed"):
            assert told in check.headline


@pytest.mark.parametrize("grid", [2, 3, 7, 64])
def test_a_narrow_fillet_is_found_on_every_grid(grid):
    found = check_faces(read_faces(str(DATA / "narrow_fillet.json")), read_cutter(["ball", "diameter_mm=12"]),
                        metric_mills(), grid=grid)  # fmt: skip
    assert found.verdict == GOUGES
    assert found.worst.least == pytest.approx(1.0 / 6.0 - 1.0, abs=1e-9)


def test_no_mill_enters_a_groove_but_the_vertical_wall_and_floor_take_a_sharp_one():
    groove = judged("vgroove.json", ("ball", "diameter_mm=60"))
    assert groove.whole.best.row == -1
    assert abs(groove.place[0]) < 1e-9
    assert "concave corner" in groove.worst.meets
    asked = read_faces(str(DATA / "vgroove.json"))
    face = asked.faces[0]
    points = np.array([[[0, 0, 20], [0, 40, 20]], [[0, 0, 0], [0, 40, 0]], [[20, 0, 0], [20, 40, 0]]], dtype=float)
    step = replace(asked, faces=(replace(face, surface=replace(face.surface, points=points)),))
    for cutter, verdict in ((["flat", "diameter_mm=8"], FREE), (["ball", "diameter_mm=1"], GOUGES),
                            (["bull", "diameter_mm=8", "corner_radius_mm=0.1"], GOUGES)):  # fmt: skip
        found = check_faces(step, read_cutter(cutter), metric_mills(), grid=16)
        assert found.verdict == verdict
        assert found.whole.best.corner == 0.0
    ridge = replace(
        asked, faces=(replace(face, surface=replace(face.surface, points=points * (1, 1, -1), flip=False)),)
    )
    assert check_faces(ridge, read_cutter(["ball", "diameter_mm=50"]), metric_mills(), grid=16).verdict == FREE


def test_the_command_says_spacing_side_and_why_it_did_not_judge(capsys, monkeypatch):
    assert main(["gouge", str(DATA / "facing_down.json"), "--cutter", "ball", "diameter_mm=12"]) == 3
    shown = capsys.readouterr().out
    assert "unchecked" in shown
    assert "verdict: unchecked: the tool reaches no point: nothing was judged; " in shown
    if find_spec("OCP") is None:
        return
    in_process(monkeypatch)
    command = ["gouge", str(DATA / "wall_a.igs"), "--cutter", "ball", "diameter_mm=20"]
    assert main(command) == 0
    shown = " ".join(capsys.readouterr().out.split())
    assert "gouges nowhere" in shown
    assert "the material side of face 1 is assumed" in shown
    assert "mm apart" in shown
    assert main([*command, "--flip"]) == 1  # seen from inside the half-cylinder of radius 8
    assert "as --flip turns it" in capsys.readouterr().out
    assert main([*command, "--flip", "face 1"]) == 1
    assert main([*command, "--flip", "fase 1"]) == 2
    assert "the nearest is 'face 1'" in capsys.readouterr().err
