"""Exact quadrics as rational quadratics, and changes of a net that leave its surface alone."""

import numpy as np

from gearsim.geometry.nurbs import clamped_knots
from gearsim.surfaces.nurbs import NurbsSurface

HALF = np.sqrt(0.5)
CIRCLE = np.array([[1, 0], [1, 1], [0, 1], [-1, 1], [-1, 0], [-1, -1], [0, -1], [1, -1], [1, 0]], dtype=float)
CIRCLE_WEIGHTS = np.array([1, HALF] * 4 + [1])
CIRCLE_KNOTS = np.array([0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4], dtype=float)


def revolved(meridian, weights, knots, flip=False):
    """A full turn about z of a quadratic meridian of (radius, height) points; r_u x r_v is outward for rising ones."""
    points = [[[r * x, r * y, z] for r, z in meridian] for x, y in CIRCLE]
    return NurbsSurface(2, 2, CIRCLE_KNOTS, knots, points, np.outer(CIRCLE_WEIGHTS, weights), flip)


def cylinder(radius, height, flip=False):
    points = [[[radius * x, radius * y, z] for z in (0.0, height)] for x, y in CIRCLE]
    return NurbsSurface(2, 1, CIRCLE_KNOTS, clamped_knots(2, 1), points, np.outer(CIRCLE_WEIGHTS, [1, 1]), flip)


def sphere(radius, flip=False):
    meridian = radius * np.array([[0, -1], [1, -1], [1, 0], [1, 1], [0, 1]])
    return revolved(meridian, [1, HALF, 1, HALF, 1], [0, 0, 0, 1, 1, 2, 2, 2], flip)


def torus(major, minor, flip=False):
    meridian = [(major + minor * x, minor * y) for x, y in CIRCLE]
    return revolved(meridian, CIRCLE_WEIGHTS, CIRCLE_KNOTS, flip)


def wavy(rng, degree_u=3, degree_v=2, shape=(6, 5)):
    """A random rational net over a rectangle, regular everywhere."""
    x, y = np.meshgrid(np.linspace(0, 10, shape[0]), np.linspace(0, 8, shape[1]), indexing="ij")
    points = np.stack([x, y, rng.uniform(-1, 1, shape)], axis=-1) + rng.uniform(-0.2, 0.2, (*shape, 3))
    knots = [clamped_knots(n, p) for n, p in zip(shape, (degree_u, degree_v), strict=True)]
    return NurbsSurface(degree_u, degree_v, *knots, points, rng.uniform(0.5, 2.0, shape))


def rebuilt(surface, points=None, **changes):
    given = {
        name: getattr(surface, name)
        for name in ("degree_u", "degree_v", "knots_u", "knots_v", "points", "weights", "flip")
    }
    return NurbsSurface(**{**given, **({} if points is None else {"points": points}), **changes})


def with_knot(surface, t):
    """The same surface with one more knot in u (Boehm)."""
    p, knots, net = surface.degree_u, surface.knots_u, surface.net
    k = int(np.searchsorted(knots, t, side="right")) - 1
    rows = []
    for i in range(len(net) + 1):
        a = 1.0 if i <= k - p else 0.0 if i > k else (t - knots[i]) / (knots[i + p] - knots[i])
        rows.append(a * net[min(i, len(net) - 1)] + (1.0 - a) * net[max(i - 1, 0)])
    net = np.array(rows)
    return rebuilt(
        surface, net[..., :3] / net[..., 3:], weights=net[..., 3], knots_u=np.insert(knots, k + 1, t)
    )  # fmt: skip


def raised(surface):
    """The same surface, one Bézier piece in u, one degree higher in u."""
    p, net = surface.degree_u, surface.net
    a = (np.arange(p + 2) / (p + 1))[:, None, None]
    net = a * net[[0, *range(p + 1)]] + (1.0 - a) * net[[*range(p + 1), p]]
    low, high = surface.domain[0]
    knots = np.repeat([low, high], p + 2)
    return rebuilt(surface, net[..., :3] / net[..., 3:], weights=net[..., 3], knots_u=knots, degree_u=p + 1)
