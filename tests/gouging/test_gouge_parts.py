"""Ten CAD parts of several faces, made with Open CASCADE, judged whole: the tool that just fits is known by hand."""

import numpy as np
import pytest

from gearsim.gouging.asked import read_faces
from gearsim.gouging.check import check_faces
from gearsim.gouging.standard_mills import metric_mills
from gearsim.scene.catalogue import read_cutter
from tests.gouging import cad_parts as cad

MORE = 1e-4


def pocket(floor, corner):
    """A pocket 40 x 30 x 12 mm in a block, its vertical edges rounded, then its floor's (0: sharp)."""
    part = cad.cut(cad.block(80, 70, 20), cad.block(40, 30, 12, (20, 20, 8)))
    if corner:
        inner = (20.0, 60.0)
        part = cad.filleted(part, corner, lambda a, b: a[0] in inner and a[:2] == b[:2] and a[2] != b[2])
    if floor:
        part = cad.filleted(part, floor, lambda a, b: abs(a[2] - 8) < 1e-6 and abs(b[2] - 8) < 1e-6)
    return part


def step_part(radius):
    """An L of two blocks, its inner edge rounded: floor, fillet and wall joined by tangents."""
    part = cad.fused(cad.block(60, 40, 10), cad.block(20, 40, 20, (0, 0, 10)))
    return cad.filleted(
        part, radius, lambda a, b: abs(a[0] - 20) + abs(b[0] - 20) + abs(a[2] - 10) + abs(b[2] - 10) < 1e-6
    )


def bored(other):
    return cad.cut(cad.block(60, 50, 20), other)


def ball(radius):
    return "ball", f"diameter_mm={2.0 * radius!r}", "height_mm=90"


def bull(radius, corner):
    return "bull", f"diameter_mm={2.0 * radius!r}", f"corner_radius_mm={corner!r}", "height_mm=90"


def flat(radius):
    return "flat", f"diameter_mm={2.0 * radius!r}", "height_mm=90"


SLANT = float(5.0 * np.sqrt(1.25))  # a cone of half angle arctan(1/2) curves most where its radius is 5: cos/5
PARTS = {
    "bowl": (".step", lambda: bored(cad.sphere(10, (30, 25, 20))), [(ball(10.0), ball(10.0 + MORE))]),
    "pocket": (".step", lambda: pocket(2.0, 4.0),
               [(ball(2.0), ball(2.0 + MORE)), (bull(4.0, 2.0), bull(4.0 + MORE, 2.0)),
                (bull(3.0, 2.0), bull(3.0, 2.1))]),
    "sharp pocket": (".igs", lambda: pocket(0.0, 0.0), [(None, ball(0.1)), (None, flat(0.1))]),
    "blind hole": (".step", lambda: bored(cad.cylinder(6, 30, (30, 25, 8))),
                   [(flat(6.0), flat(6.0 + MORE)), (None, ball(1.0))]),
    "rounded block": (".igs", lambda: cad.filleted(cad.block(40, 30, 20), 3.0, lambda a, b: a[2] == b[2] == 20.0),
                      [(ball(40.0), None), (flat(40.0), None)]),
    "ring": (".step", lambda: cad.torus(12, 4), [(ball(8.0), ball(8.0 + MORE))]),
    "conical hole": (".step", lambda: bored(cad.cone(5, 15, 20, (30, 25, 0))), [(ball(SLANT), ball(SLANT + MORE))]),
    "trough": (".igs", lambda: bored(cad.cylinder(5, 80, (-5, 25, 20), (1, 0, 0))), [(ball(5.0), ball(5.0 + MORE))]),
    "step": (".igs", lambda: step_part(3.0),
             [(ball(3.0), ball(3.0 + MORE)), (bull(20.0, 3.0), bull(20.0, 3.0 + MORE))]),
    "ring groove": (".step", lambda: cad.cut(cad.cylinder(25, 20, (0, 0, -20)), cad.torus(15, 3)),
                    [(ball(3.0), ball(3.0 + MORE))]),
    "plate with a hole": (".igs", lambda: bored(cad.cylinder(4, 30, (30, 25, -5))),
                          [(flat(4.0), flat(4.0 + MORE)), (ball(4.0), ball(4.0 + MORE))]),
    "corner to corner": (".step", lambda: cad.fused(cad.block(10, 10, 5), cad.block(10, 10, 5, (10, 10, 0))),
                         [(None, ball(1.0))]),
}  # fmt: skip


def verdict(asked, cutter):
    return check_faces(asked, read_cutter(list(cutter)), metric_mills()[-3:], grid=24)


@pytest.mark.parametrize("name", PARTS)
def test_what_just_fits_is_free_and_what_is_larger_gouges(name, tmp_path, monkeypatch):
    cad.in_process(monkeypatch)
    suffix, make, pairs = PARTS[name]
    file = tmp_path / f"part{suffix}"
    (cad.write_step if suffix == ".step" else cad.write_iges)(make(), file)
    asked = read_faces(str(file))
    assert asked.skipped == ()
    assert {f.side for f in asked.faces} == {"solid"}
    for fits, gouges in pairs:
        for cutter, wanted in ((fits, "pass"), (gouges, "fail")):
            if cutter is not None:
                found = verdict(asked, cutter)
                assert found.verdict == wanted, (cutter, found.status, found.worst)


def test_an_open_shell_of_revolution_with_a_pole(tmp_path, monkeypatch):
    """A dish z = r²/16: curvature 1/8 at its pole, and less everywhere else."""
    cad.in_process(monkeypatch)
    cad.write_step(cad.revolved_parabola(8.0, 12.0), tmp_path / "dish.step")
    asked = read_faces(str(tmp_path / "dish.step"))
    assert [f.side for f in asked.faces] == ["assumed"]
    looked = [read_faces(str(tmp_path / "dish.step"), flip=flip) for flip in (None, [])]
    inside = max(looked, key=lambda a: a.faces[0].surface.jet([0.3], [0.9]).normal[0, 2])
    assert verdict(inside, ball(8.0)).verdict == "pass"
    assert verdict(inside, ball(8.0 + MORE)).verdict == "fail"


def test_one_face_of_several_is_not_the_part(tmp_path, monkeypatch):
    cad.in_process(monkeypatch)
    cad.write_step(step_part(3.0), tmp_path / "step.step")
    top = [
        k
        for k, f in enumerate(read_faces(str(tmp_path / "step.step")).faces, 1)
        if f.surface.points[..., 2].min() > 29.0
    ]
    one = read_faces(str(tmp_path / "step.step"), number=top[0])
    found = verdict(one, ball(3.0))
    assert found.verdict == "unchecked"
    assert "not looked at" in found.status
