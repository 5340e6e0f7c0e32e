"""Solids of NURBS faces: a block against the block, the shipped ones against their makers, what is no solid."""

from dataclasses import replace

import numpy as np
import pytest

from gearsim.errors import InputError
from gearsim.geometry.solid import Block
from gearsim.surfaces.faced_solid import FacedSolid
from gearsim.surfaces.nurbs_file import load_surfaces, load_untrimmed
from tests.gouging.cad_parts import in_process
from tests.surfaces.faced_parts import (
    LOWER,
    UPPER,
    blade_tip,
    block_faces,
    impeller_channel,
    named_as_read,
    write_solid,
)  # fmt: skip


@pytest.fixture(scope="module")
def block():
    return FacedSolid(block_faces())


@pytest.fixture(scope="module", params=["blade-tip", "impeller-channel"])
def shipped(request):
    return FacedSolid(tuple(load_surfaces(request.param)))


def test_a_block_of_faces_is_the_block(block, rng):
    exact = Block(LOWER, UPPER)
    round_ones = np.stack(np.meshgrid([-2, -1, 1, 3, 4], [-1, 0, 1, 2, 3], [1, 2, 3, 5, 6], indexing="ij"), axis=-1)
    points = np.concatenate([rng.uniform(LOWER - 2.0, UPPER + 2.0, (500, 3)), round_ones.reshape(-1, 3)])
    assert np.allclose(block.signed_distance(points), exact.signed_distance(points), atol=1e-9)
    assert block.volume == pytest.approx(exact.volume)
    assert np.allclose(block.box, exact.box)
    inside = points[exact.signed_distance(points) < -0.01]
    assert np.allclose(np.abs(block.normals(inside)).sum(axis=1), 1.0)


def test_rays_in_faces_edges_and_corners_of_a_block_see_what_a_block_shows(block):
    exact = Block(LOWER, UPPER)
    places = np.stack(np.meshgrid([-2, -1, 0, 3, 4], [-1, 0, 1, 2], [1, 2, 5, 6], indexing="ij"), axis=-1)
    for axis in range(3):
        origins = places.reshape(-1, 3).astype(float)
        origins[:, axis] = -9.0
        ways = np.tile(np.eye(3)[axis], (len(origins), 1))
        for found, expected in zip(block.chords(origins, ways), exact.chords(origins, ways), strict=True):
            assert len(found) > 0
            assert np.allclose(found, expected, rtol=0.0, atol=1e-12)


def test_chords_and_distances_agree_on_what_is_inside(shipped, rng):
    lower, upper = shipped.box
    points = rng.uniform(lower - 0.5, upper + 0.5, (2000, 3))
    way = np.array([0.36, 0.48, 0.8])
    ray, start, end = shipped.chords(points - 100.0 * way, np.tile(way, (len(points), 1)))
    inside = np.zeros(len(points), dtype=bool)
    inside[ray[(start < 100.0) & (end > 100.0)]] = True
    distance = shipped.signed_distance(points)
    clear = np.abs(distance) > 0.01
    assert np.array_equal(inside[clear], distance[clear] < 0.0)
    assert shipped.mesh.euler == 2


def test_distances_along_normals_are_those_ways(shipped, rng):
    for number, face in enumerate(shipped.faces):
        u, v = face.locate(*rng.uniform(0.1, 0.9, (2, 5)))
        jet = face.jet(u, v)
        for way in (0.01, -0.01):
            distance, owner, _, _ = shipped.nearest(jet.r + way * jet.normal)
            assert np.allclose(distance, way, atol=1e-9)
            assert (owner == number).all()


def test_what_encloses_nothing_is_refused():
    faces = block_faces()
    with pytest.raises(InputError, match="enclose no solid: no other side lies along a side of"):
        FacedSolid(faces[1:])
    with pytest.raises(InputError, match="enclose no solid"):
        FacedSolid((replace(faces[0], flip=not faces[0].flip), *faces[1:]))
    with pytest.raises(InputError, match="point into the solid"):
        FacedSolid(tuple(replace(face, flip=not face.flip) for face in faces))


@pytest.mark.parametrize(("name", "make"), [("blade-tip", blade_tip), ("impeller-channel", impeller_channel)])
def test_the_shipped_nets_are_those_that_are_made(name, make):
    made = {face.name: face for face in make()}
    for face in load_surfaces(name):
        assert np.allclose(face.points, made[face.name].points, atol=2e-9)
        assert face.flip == made[face.name].flip


def test_the_shipped_step_file_has_the_faces_of_the_nets_number_by_number(monkeypatch):
    in_process(monkeypatch)
    nets, read = load_surfaces("impeller-channel"), load_untrimmed("impeller-channel.step")
    assert len(read) == len(nets) == 22
    for net, face in zip(nets, read, strict=True):
        assert np.allclose(face.points, net.points, rtol=0.0, atol=1e-12)
        assert np.array_equal(face.knots_u, net.knots_u)
        assert np.array_equal(face.knots_v, net.knots_v)
        assert face.flip == net.flip


def test_a_solid_that_is_sewn_and_read_back_is_the_same(monkeypatch, tmp_path):
    in_process(monkeypatch)
    faces = block_faces()
    write_solid(faces, tmp_path / "block.step")
    read = named_as_read(faces, load_untrimmed(tmp_path / "block.step"))
    assert FacedSolid(tuple(read)).volume == pytest.approx(24.0)


def test_a_trimmed_face_is_refused(monkeypatch, tmp_path):
    in_process(monkeypatch)
    from tests.gouging.cad_parts import cylinder, write_step

    write_step(cylinder(3.0, 5.0, (0.0, 0.0, 0.0)), tmp_path / "bar.step")
    with pytest.raises(InputError, match="its boundary leaves a part of its surface out"):
        load_untrimmed(tmp_path / "bar.step")
