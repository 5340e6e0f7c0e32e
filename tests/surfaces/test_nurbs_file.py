"""Control nets as JSON, IGES and STEP: what goes in comes out, and rubbish gives a message."""

import json
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from gearsim.errors import InputError
from gearsim.surfaces import cad_file
from gearsim.surfaces.nurbs_file import format_surfaces, load_surfaces, parse_surfaces, surface_names, write_surfaces
from tests.surfaces.cad_files import entity_128, iges, step
from tests.surfaces.nurbs_shapes import sphere, torus, wavy

FIELDS = ("degree_u", "degree_v", "knots_u", "knots_v", "points", "weights", "flip")
WAVY = wavy(np.random.default_rng(7))
GOOD = json.loads(format_surfaces([WAVY]))


def assert_same(a, b, tolerance=0.0, skip=()):
    for name in FIELDS:
        if name not in skip:
            np.testing.assert_allclose(getattr(a, name), getattr(b, name), rtol=tolerance, atol=tolerance, err_msg=name)


def test_json_keeps_every_digit(tmp_path):
    file = tmp_path / "two.json"
    surfaces = [sphere(1.0 / 3.0, flip=True), WAVY]
    write_surfaces(surfaces, file, note="a ball and a wave")
    found = load_surfaces(file)
    for a, b in zip(found, surfaces, strict=True):
        assert_same(a, b)
    assert json.loads(file.read_text())["note"] == "a ball and a wave"
    with pytest.raises(InputError, match="cannot write"):
        write_surfaces(surfaces, tmp_path / "nowhere" / "a.json")


def test_weights_flip_and_name_may_be_left_out():
    entry = {key: GOOD["surfaces"][0][key] for key in ("degree", "knots", "points")}
    (surface,) = parse_surfaces(json.dumps({"units": "mm", "surfaces": [entry]}), "text")
    assert (surface.weights == 1.0).all()
    assert not surface.flip


def test_the_net_that_the_documents_show_is_the_trough_it_says():
    shown = (Path(__file__).parents[2] / "docs" / "data.md").read_text("utf-8").split("```json\n")[1].split("```")[0]
    (trough,) = parse_surfaces(shown, "data.md")
    u, v = np.random.default_rng(0).uniform(0.0, 1.0, (2, 50))
    axis = np.array([20.0, 0.0, 20.0])
    jet, inward = trough.jet(u, v), (axis - trough.at(u, v)) * [1.0, 0.0, 1.0]
    assert np.allclose(np.linalg.norm(inward, axis=1), 20.0)
    assert np.allclose(jet.normal, inward / 20.0)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda d: d.update(units="inch"), "units must be 'mm', got 'inch'"),
        (lambda d: d.pop("units"), "missing 'units'"),
        (lambda d: d.update(surfaces=[]), "at least one surface"),
        (lambda d: d["surfaces"].append(5), "net.json, surface 2: expected an object with the keys"),
        (lambda d: d["surfaces"][0].update(weigths=1), "unknown key 'weigths'; the nearest known is 'weights'"),
        (lambda d: d["surfaces"][0].pop("points"), "net.json, surface 1: missing 'points'"),
        (lambda d: d["surfaces"][0].update(degree=3), "'degree' must be a list of two"),
        (lambda d: d["surfaces"][0].update(degree=[3, 2.5]), "two whole numbers"),
        (lambda d: d["surfaces"][0].update(degree=[3, 3]), "net.json, surface 1: 8 knots in v and degree 3"),
        (lambda d: d["surfaces"][0].update(flip="no"), "'flip' must be true or false"),
        (lambda d: d["surfaces"][0].update(name=3), "'name' must be text"),
        (lambda d: d["surfaces"][0]["points"][2][1].__setitem__(0, "1"), "'points' must be numbers in lists; got .1"),
        (lambda d: d["surfaces"][0]["knots"][1].__setitem__(0, False), "'knots' must be numbers in lists; got false"),
        (lambda d: d["surfaces"][0]["weights"][2].__setitem__(1, None), "'weights' must be numbers in lists; got null"),
        (lambda d: d["surfaces"][0]["points"][2].pop(), "rows of equal length"),
        (lambda d: d["surfaces"][0]["weights"][2].__setitem__(1, 0), "positive, got 0 in row 3, column 2"),
    ],
)  # fmt: skip
def test_mistakes_are_named(change, said):
    document = json.loads(json.dumps(GOOD))
    change(document)
    with pytest.raises(InputError, match=said):
        parse_surfaces(json.dumps(document), "net.json")


def test_json_errors_name_their_line():
    with pytest.raises(InputError, match=r"net.json, line 2, column 1: no JSON"):
        parse_surfaces("[\nx]", "net.json")
    for text in ("[" * 100000, "9" * 5000, '{"units": "mm", "surfaces": [NaN]}'):
        with pytest.raises(InputError):
            parse_surfaces(text, "net.json")


@given(
    st.recursive(
        st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
        lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.sampled_from(["degree", "x"]), inner),
        max_leaves=12,
    ),
    st.sampled_from(["degree", "knots", "points", "weights", "flip", "name"]),
)
@settings(max_examples=200, deadline=None)
def test_no_value_of_a_field_breaks_the_reader(value, key):
    document = json.loads(json.dumps(GOOD))
    document["surfaces"][0][key] = value
    with suppress(InputError):
        parse_surfaces(json.dumps(document), "net.json")


@given(st.binary(max_size=300), st.sampled_from([".json", *cad_file.CAD_SUFFIXES]))
@settings(max_examples=100, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_random_bytes_are_refused(tmp_path, data, suffix):
    file = tmp_path / f"rubbish{suffix}"
    file.write_bytes(data)
    with pytest.raises(InputError, match="rubbish"):
        load_surfaces(file)


def test_unknown_names_and_files_are_refused(tmp_path):
    with pytest.raises(InputError, match="did you mean 'khan-9-1-cylinder'"):
        load_surfaces("khan-9-1-cylindre")
    for name in ("a.json", "a.igs", "a.step"):
        with pytest.raises(InputError, match="cannot read"):
            load_surfaces(tmp_path / name)


def test_the_nets_of_chapter_9():
    """S(3, 0.5) as printed in 9.1 and 9.3, and curvatures in closed form: bowls as seen from the tool."""
    printed = [name for name in surface_names() if name.startswith("khan")]
    assert printed == [f"khan-9-{n}-{kind}" for n in (1, 2) for kind in ("cylinder", "free-form")]
    apart = 20.0 - np.sqrt(200.0)
    wanted = {
        "khan-9-1-cylinder": ((apart, 60.0, apart), 1 / 20), "khan-9-1-free-form": ((5, 60, 5), np.sqrt(0.005)),
        "khan-9-2-cylinder": ((apart, apart, 12.5), 1 / 20), "khan-9-2-free-form": ((5, 5, 12.5), np.sqrt(0.005)),
    }  # fmt: skip
    for name, (point, k1) in wanted.items():
        (surface,) = load_surfaces(name)
        assert surface.domain == ((0.0, 4.0), (0.0, 1.0))
        assert (surface.degree_u, surface.degree_v) == (1, 2)
        jet = surface.jet([3.0], [0.5])
        np.testing.assert_allclose(jet.r[0], point, atol=1e-13)
        np.testing.assert_allclose([jet.curvature().k1[0], jet.curvature().k2[0]], [k1, 0.0], atol=1e-15)
        inside = np.array([1.0, 0.0, 1.0]) if "9-1" in name else np.array([1.0, 1.0, 0.0])
        np.testing.assert_allclose(jet.normal[0], inside / np.sqrt(2.0), atol=1e-15)
        u, v = (g.ravel() for g in np.meshgrid(np.linspace(0, 4, 9), np.linspace(0, 1, 9)))
        curvature = surface.jet(u, v).curvature()
        if "cylinder" in name:  # with sqrt(1/2) the ties are exact; the printed 0.707 gives 0.04999 to 0.05002
            np.testing.assert_allclose(curvature.k1, 0.05, rtol=1e-14)
        np.testing.assert_allclose(surface.jet([0.0], [1.0]).rv[0], [0, 0, 40 * surface.weights[0, 1]]
                                   if "9-1" in name else [0, 40 * surface.weights[0, 1], 0], atol=1e-13)  # fmt: skip


class TestCad:
    """Open CASCADE's reading; each file costs a process."""

    @pytest.fixture(autouse=True)
    def _library(self):
        pytest.importorskip("OCP")

    def test_iges_128(self, tmp_path):
        file = tmp_path / "wave.igs"
        file.write_text(iges([entity_128(WAVY), entity_128(torus(9.0, 2.0))]))
        wave, ring = load_surfaces(file)
        assert_same(wave, WAVY, 1e-13)
        u, v = ring.locate(*np.random.default_rng(0).uniform(size=(2, 50)))
        r = ring.jet(u, v).r
        np.testing.assert_allclose(np.hypot(np.hypot(r[:, 0], r[:, 1]) - 9.0, r[:, 2]), 2.0, rtol=1e-12)

    def test_inches_and_metres_become_millimetres(self, tmp_path):
        (tmp_path / "inch.iges").write_text(iges([entity_128(WAVY)], (1, "IN")))
        (tmp_path / "metre.stp").write_text(step(WAVY, "$"))
        np.testing.assert_allclose(load_surfaces(tmp_path / "inch.iges")[0].points, 25.4 * WAVY.points, rtol=1e-12)
        np.testing.assert_allclose(load_surfaces(tmp_path / "metre.stp")[0].points, 1000.0 * WAVY.points, rtol=1e-12)

    def test_step(self, tmp_path):
        file = tmp_path / "wave.step"
        file.write_text(step(WAVY))
        assert_same(load_surfaces(file)[0], WAVY, 1e-13)

    def test_normals_leave_a_solid(self, tmp_path):
        """Planes, cylinders and spheres become NURBS, with the faces' orientation and place."""
        from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut
        from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakeSphere
        from OCP.gp import gp_Pnt
        from OCP.STEPControl import STEPControl_StepModelType, STEPControl_Writer

        block = BRepPrimAPI_MakeBox(gp_Pnt(0, 0, -20), gp_Pnt(50, 50, 0)).Shape()
        bowl = BRepAlgoAPI_Cut(block, BRepPrimAPI_MakeSphere(gp_Pnt(25, 25, 0), 10.0).Shape()).Shape()
        writer = STEPControl_Writer()
        writer.Transfer(bowl, STEPControl_StepModelType.STEPControl_AsIs)
        writer.Write(str(tmp_path / "bowl.stp"))
        faces = load_surfaces(tmp_path / "bowl.stp")
        assert len(faces) == 7
        centre, bowls = np.array([25.0, 25.0, 0.0]), 0
        for face in faces:
            jet = face.jet(*face.locate(*np.random.default_rng(1).uniform(0.05, 0.95, size=(2, 40))))
            k1 = jet.curvature().k1
            if k1.max() > 0.01:
                bowls += 1
                np.testing.assert_allclose(jet.normal, (centre - jet.r) / 10.0, atol=1e-9)
                np.testing.assert_allclose(k1, 0.1, rtol=1e-9)
            else:
                np.testing.assert_allclose(k1, 0.0, atol=1e-9)
                assert np.all(np.einsum("ni,ni->n", jet.normal, jet.r - [25.0, 25.0, -10.0]) > 0.0)
        assert bowls == 1

    @pytest.mark.parametrize(
        ("text", "suffix", "said"),
        [
            (iges([[116, 1.0, 2.0, 3.0, 0]]), ".igs", "surface"),
            (step(WAVY).replace("#21=", "#22="), ".stp", "Unresolved Reference"),
            (iges([entity_128(WAVY)])[:-82], ".igs", "without its T section"),
            (iges([entity_128(WAVY)] * 2)[::-1].replace("4,5,821", "9,5,821", 1)[::-1], ".igs", "entity 128, D line 3"),
            (iges([entity_128(WAVY)]).replace(",1.0,1.0,", ",1.x,1.0,"), ".igs", "line 7: entity 128 wants .* '1.x'"),
            (step(WAVY).replace("E+00,", "E+00,!", 1), ".stp", "Line 23: Incorrect syntax"),
            (step(WAVY).replace("(3,2,", "(3,#2,"), ".stp", "v_degree"),
            (step(WAVY)[:-20], ".stp", "without END-ISO"),
            (iges([entity_128(WAVY)]).replace(" " * 30, ""), ".igs", "line 1: no IGES"),
        ],
    )  # fmt: skip
    def test_damaged_files_are_refused(self, text, suffix, said, tmp_path):
        file = tmp_path / f"damaged{suffix}"
        file.write_text(text)
        with pytest.raises(InputError, match=f"damaged{suffix}.*{said}"):
            load_surfaces(file)


def test_without_the_library_the_remedy_is_named(tmp_path, monkeypatch):
    monkeypatch.setattr(cad_file, "find_spec", lambda name: None)
    file = tmp_path / "wave.igs"
    file.write_text(iges([entity_128(WAVY)]))
    with pytest.raises(InputError, match=r"install gearsim\[cad\].*or give the control net as JSON"):
        load_surfaces(file)
