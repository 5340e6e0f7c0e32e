"""Rays that are hard on a search: that touch, graze, lie in faces, pass through edges, tips and axes, or just pass."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.profile import Profile
from gearsim.geometry.rays import RayBundle
from gearsim.motion.segments import SegmentTable

Lines = tuple[NDArray, NDArray]


@dataclass(frozen=True)
class Scene:
    """A tool on some rows; ``size`` [mm] is the unit of its round numbers."""

    rng: np.random.Generator
    cutter: Profile
    table: SegmentTable
    size: float

    def pose(self, n: int, at_ends: bool) -> tuple[NDArray, NDArray, NDArray, NDArray]:
        """Tips, axes and their rates at n poses: the ends of rows, or any."""
        row = self.rng.integers(len(self.table), size=n)
        x = self.rng.choice([-1.0, 1.0], size=n) if at_ends else self.rng.uniform(-1.0, 1.0, n)
        return self.pose_at(row, x)

    def pose_at(self, row: NDArray, x: NDArray) -> tuple[NDArray, NDArray, NDArray, NDArray]:
        """Tips, axes and their rates at poses of rows, both shape (n,)."""
        powers = np.vander(x, 6, increasing=True)
        rates = np.arange(6) * np.hstack([np.zeros((len(x), 1)), powers[:, :-1]])
        tip, axis = self.table.tip[row], self.table.axis[row]
        return tuple(np.einsum("nk,nkc->nc", p, c) for p in (powers, rates) for c in (tip, axis))  # type: ignore

    def around(self, axis: NDArray) -> NDArray:
        """Unit vectors across axes: those of the frame where it stands on them, else turned anyhow."""
        n = len(axis)
        e = np.eye(3)[np.argmin(np.abs(axis), axis=1)] * self.rng.choice([-1.0, 1.0], size=n)[:, None]
        u = e - (e * axis).sum(1, keepdims=True) * axis
        u /= np.linalg.norm(u, axis=1, keepdims=True)
        v = np.cross(axis, u)
        angle = self.rng.choice([0.0, 1.0], size=n) * self.rng.uniform(0.0, 2.0 * np.pi, n)
        quarter = self.rng.random(n) < 0.3
        cos, sin = np.where(quarter, 0.0, np.cos(angle)), np.where(quarter, 1.0, np.sin(angle))
        return cos[:, None] * u + sin[:, None] * v

    def meridian(self, n: int, corners: bool) -> NDArray:
        """Points (r, z) and normals (nr, nz) of the profile, shape (n, 4): its corners, or any."""
        element = self.rng.integers(len(self.cutter.elements), size=n)
        share = self.rng.choice([0.0, 1.0], size=n) if corners else self.rng.choice([0.5, 1.0], n) * self.rng.random(n)
        length = np.array([e.length for e in self.cutter.elements])[element]
        p = self.cutter.at(element, share * length)
        return np.stack([p.r, p.z, p.nr, p.nz], axis=1)


def _unit(v: NDArray) -> NDArray:
    size = np.linalg.norm(v, axis=1, keepdims=True)
    return np.where(size > 0.0, v / np.where(size > 0.0, size, 1.0), [0.0, 0.0, 1.0])


def _surface(scene: Scene, n: int, at_ends: bool, corners: bool) -> tuple[NDArray, ...]:
    """Points of the tool's surface at poses, their normals, directions along the meridian and around the axis."""
    tip, axis, _, _ = scene.pose(n, at_ends)
    u, m = scene.around(axis), scene.meridian(n, corners)
    point = tip + m[:, :1] * u + m[:, 1:2] * axis
    return point, m[:, 2:3] * u + m[:, 3:] * axis, m[:, 2:3] * axis - m[:, 3:] * u, np.cross(axis, u)


def through(scene: Scene, n: int) -> Lines:
    """Random rays through the tool."""
    tip, axis, _, _ = scene.pose(n, False)
    _, radius, bottom, top = scene.cutter.box
    at = tip + scene.rng.uniform(bottom, top, (n, 1)) * axis
    return at + radius * scene.rng.uniform(-1.0, 1.0, (n, 3)), _unit(scene.rng.normal(size=(n, 3)))


def tangent(scene: Scene, n: int) -> Lines:
    """Tangent to a face at an end pose: along it, around it, or slanted."""
    point, _, along, around = _surface(scene, n, True, False)
    turn = scene.rng.choice([0.0, 0.5, 1.0, 0.25], n) * np.pi * scene.rng.choice([1.0, scene.rng.random()], n)
    return point, _unit(np.cos(turn)[:, None] * along + np.sin(turn)[:, None] * around)


def behind(scene: Scene, n: int) -> Lines:
    """Tangent to an end pose where the rest of the row has swept, or will sweep, all around the touch."""
    row = scene.rng.integers(len(scene.table), size=n)
    x = scene.rng.choice([-1.0, 1.0], size=n)
    tip, axis, rate, _ = scene.pose_at(row, x)
    across = rate - (rate * axis).sum(1, keepdims=True) * axis
    size = np.linalg.norm(across, axis=1, keepdims=True)
    still = size[:, 0] <= 1e-12 * scene.size
    u = np.where(still[:, None], scene.around(axis), -x[:, None] * across / np.where(size > 0.0, size, 1.0))
    m = scene.meridian(n, False)
    along, around = m[:, 2:3] * axis - m[:, 3:] * u, np.cross(axis, u)
    kind = scene.rng.integers(4, size=(n, 1))
    slanted = scene.rng.uniform(-1.0, 1.0, (n, 1)) * along + around
    direction = np.where(kind == 0, along, np.where(kind == 1, slanted, around))
    return tip + m[:, :1] * u + m[:, 1:2] * axis, _unit(direction)


def grazing(scene: Scene, n: int) -> Lines:
    """Tangent to a face at any pose, moved off by 1e-13 to 1e-2 of the size."""
    point, normal, along, around = _surface(scene, n, scene.rng.random() < 0.3, False)
    turn = scene.rng.uniform(0.0, 2.0 * np.pi, n)[:, None]
    off = scene.size * 10.0 ** scene.rng.uniform(-13.0, -2.0, (n, 1)) * scene.rng.choice([-1.0, 1.0], (n, 1))
    return point + off * normal, _unit(np.cos(turn) * along + np.sin(turn) * around)


def generatrix(scene: Scene, n: int) -> Lines:
    """Along the meridian of a face at an end pose: in the side of a cylinder or a cone, in the plane of a disc."""
    point, _, along, _ = _surface(scene, n, True, False)
    return point, _unit(along)


def edges(scene: Scene, n: int) -> Lines:
    """Through corners of the profile at end poses, around, upright or anyhow."""
    point, _, along, around = _surface(scene, n, True, True)
    kind = scene.rng.integers(3, size=(n, 1))
    anyhow = scene.rng.normal(size=(n, 3))
    return point, _unit(np.where(kind == 0, around, np.where(kind == 1, along, anyhow)))


def tips(scene: Scene, n: int) -> Lines:
    """Through the tip at end poses."""
    tip, axis, _, _ = scene.pose(n, True)
    kind = scene.rng.integers(2, size=(n, 1))
    return tip, _unit(np.where(kind == 0, scene.around(axis), scene.rng.normal(size=(n, 3))))


def axes(scene: Scene, n: int) -> Lines:
    """Along the tool's axis at end poses, or parallel to it at a corner's radius."""
    tip, axis, _, _ = scene.pose(n, True)
    out = scene.rng.choice([0.0, 1.0], (n, 1)) * scene.meridian(n, True)[:, :1]
    return tip + out * scene.around(axis), _unit(axis)


def velocities(scene: Scene, n: int) -> Lines:
    """Along the velocity of a point of the tool's surface."""
    tip, axis, tip_rate, axis_rate = scene.pose(n, True)
    u, m = scene.around(axis), scene.meridian(n, False)
    rate = tip_rate + m[:, 1:2] * axis_rate - m[:, :1] * (u * axis_rate).sum(1, keepdims=True) * axis
    return tip + m[:, :1] * u + m[:, 1:2] * axis, _unit(rate)


def on_grid(scene: Scene, n: int) -> Lines:
    """Along the frame's axes through the points of a grid of a quarter of the size, near the tool."""
    point, _ = through(scene, n)
    pitch = 0.25 * scene.size
    return pitch * np.round(point / pitch), np.eye(3)[scene.rng.integers(3, size=n)]


KINDS: dict[str, Callable[[Scene, int], Lines]] = {
    "through": through, "tangent": tangent, "behind": behind, "grazing": grazing, "generatrix": generatrix,
    "edges": edges, "tips": tips, "axes": axes, "velocities": velocities, "on_grid": on_grid,
}  # fmt: skip


def bundle(scene: Scene, kind: str, n: int) -> RayBundle:
    """n rays of a kind, whose windows hold all that the tool can reach of them."""
    point, direction = KINDS[kind](scene, n)
    reach = scene.cutter.reach + float(scene.table.speed.max())
    back = scene.size * 2.0 ** np.ceil(np.log2(2.5 * reach / scene.size))
    return RayBundle(point - back * direction, direction, np.zeros(n), np.full(n, 2.0 * back))
