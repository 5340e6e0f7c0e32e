"""A saved stock as a solid, as far as its rays show it: its ends lie on it, between them it is joined."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import InputError
from gearsim.geometry.faceted import Faceted
from gearsim.simulation.contour.surface import contour
from gearsim.simulation.ends import Normals, material_ends
from gearsim.simulation.stock import Stock

_NEIGHBOURS = 8
_REACH = 2.5  # pitches


def saved_solid(stock: Stock, name: str) -> Faceted:
    """The closed surface of a stock whose operations are not there to be asked, so that normals are fitted to ends.

    It is off the true one by less than a cell, and may cross itself between rays: nobody could mend that. Raises
    InputError where nothing is left.
    """
    mesh = contour(stock, FittedNormals(stock)).mesh
    if not len(mesh.triangles):
        raise InputError(f"{name}: nothing of its material is left")
    return Faceted(mesh, name, slack=np.inf)


def with_earlier(saved: Stock, later: Normals) -> Normals:
    """Normals at ends of a stock that went on from a saved one: ``later`` knows the rows done since, from tag 0 on."""
    earlier = FittedNormals(saved)

    def outward(points: NDArray, tags: NDArray) -> NDArray:
        out, old = np.empty(points.shape), tags < saved.next_tag
        out[old] = earlier(points[old], tags[old])
        out[~old] = later(points[~old], tags[~old] - saved.next_tag)
        return out

    return outward


class FittedNormals:
    """Outward normals of planes through the nearest ends that the same operation made; out is away from the middle of
    the rays' material."""

    def __init__(self, stock: Stock):
        self._stock = stock
        ends = material_ends(stock, lambda points, tags: np.zeros(points.shape))
        inward = [np.repeat([1.0, -1.0], len(k.lo)) for k in stock.left]
        axes = stock.box.frame.rotation.T[ends.bundle]
        self._point, self._inward = ends.point, np.concatenate(inward)[:, None] * axes
        self._of = stock.operation_of(ends.tag)

    def __call__(self, points: NDArray, tags: NDArray) -> NDArray:
        out, of = np.empty(points.shape), self._stock.operation_of(tags)
        for operation in np.unique(of):
            own, mine = self._of == operation, of == operation
            out[mine] = self._fitted(points[mine], self._point[own], self._inward[own])
        return out

    def _fitted(self, points: NDArray, ends: NDArray, inward: NDArray) -> NDArray:
        count = min(_NEIGHBOURS, len(ends))
        reach = _REACH * self._stock.box.pitch
        from scipy.spatial import cKDTree  # slow to load, and few blanks are another run's stock

        away, near = cKDTree(ends).query(points, k=count, distance_upper_bound=reach)
        away, near = away.reshape(-1, count), near.reshape(-1, count)
        real = np.isfinite(away)
        near = np.where(real, near, near[:, :1])  # the point itself is an end
        off = (ends[near] - points[:, None]) * real[..., None]
        normal = np.linalg.eigh(np.einsum("nki,nkj->nij", off, off))[1][..., 0]
        within = inward[near[:, 0]]
        few = real.sum(axis=1) < 3
        normal = np.where(few[:, None], -within, normal)
        return normal * np.where(np.einsum("ij,ij->i", normal, within) > 0.0, -1.0, 1.0)[:, None]
