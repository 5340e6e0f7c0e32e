"""Random cutters against random quadrics: the decision by curvature beside the brute-force clearance."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.catalogue import ball, barrel, bull, flat, tapered, tapered_ball
from gearsim.cutters.contact import contact_at
from gearsim.cutters.profile import Profile
from gearsim.gouging.clearance import least_clearance, quadric
from gearsim.gouging.compare import TIE, compare_contact
from gearsim.gouging.tensors import Tensor, principal_tensor

NEIGHBOURHOOD = 3e-4  # mm: smaller than the distance of a contact from its element's ends
BAND = 1e-4  # 1/mm: closer to equality, terms of third order and rounding may decide


class Agreement(NamedTuple):
    """``pairs`` compared, how many gouge, how many lie within the band; disagreements outside it and within it.

    ``widest`` [1/mm] is the largest |least| at which the two disagree, 0 where they never do.
    """

    pairs: int
    gouging: int
    near: int
    outside: int
    inside: int
    widest: float


def random_cutter(random: np.random.Generator) -> Profile:
    """A flat, ball, bull-nose, tapered, tapered ball or barrel cutter of 4 to 60 mm diameter."""
    radius, share = random.uniform(2.0, 30.0), random.uniform()
    kinds = (
        lambda: flat(2.0 * radius, 3.0 * radius),
        lambda: ball(2.0 * radius, 3.0 * radius),
        lambda: bull(2.0 * radius, (0.2 + 0.75 * share) * radius, 3.0 * radius),
        lambda: tapered(2.0 * radius, 0.02 + 0.3 * share, 3.0 * radius),
        lambda: tapered_ball(2.0 * radius, 0.02 + 0.3 * share, 3.0 * radius),
        lambda: barrel(2.0 * radius, (2.0 + 6.0 * share) * radius, 1.5 * radius, 3.0 * radius, 0.2 * radius),
    )
    return kinds[random.integers(len(kinds))]()


def random_contacts(cutter: Profile, count: int, random: np.random.Generator) -> tuple[NDArray, Tensor]:
    """Angles theta [rad], shape (count,), and tensors of parts that may gouge there; some are near equality."""
    theta = np.radians(random.uniform(0.1, 89.9, count))
    beside = [contact_at(cutter, theta + d) for d in (-1e-3, 1e-3)]
    joint = (beside[0].uphill != beside[1].uphill) | (beside[1].z >= cutter.height - 1e-9)
    theta = np.where(joint, 0.5 * theta, theta)  # off the joints of two elements, and off the top's edge
    theta[:2] = 0.0, 0.5 * np.pi
    theta = np.where(contact_at(cutter, theta).z >= cutter.height - 1e-9, 0.5 * theta, theta)
    contact = contact_at(cutter, theta)
    size = np.maximum(contact.around, 0.01 / cutter.max_radius)
    along = np.minimum(contact.weaker, 20.0 / cutter.max_radius)
    gap = np.sort(random.uniform(-1.5, 1.5, (2, count)) * size, axis=0)
    turned = principal_tensor(gap[1], gap[0], random.uniform(0.0, np.pi, count))
    part = Tensor(along * random.choice([0.0, 0.5, 1.0], count) - turned.a, -turned.b, contact.around - turned.c)
    near = random.uniform(size=count) < 0.2
    wanted = 10.0 ** random.uniform(-6.0, -2.0, count) * random.choice([-1.0, 1.0], count)
    shift = np.where(near, compare_contact(contact, part).least - wanted, 0.0)
    return theta, Tensor(part.a + shift, part.b, part.c + shift)


def agreement(count: int, seed: int = 0, per_cutter: int = 50) -> Agreement:
    """Compare ``count`` pairs: curvatures against points of the quadrics in a neighbourhood of 0.3 µm."""
    random = np.random.default_rng(seed)
    found = [_compared(random_cutter(random), per_cutter, random) for _ in range(count // per_cutter)]
    least, clearance = np.concatenate(found, axis=1)
    near, differs = np.abs(least) <= BAND, (least < -TIE) != (clearance < 0.0)
    widest = float(np.max(np.abs(least[differs]), initial=0.0))
    gouging, close, outside, inside = (int(np.sum(x)) for x in (least < -TIE, near, differs & ~near, differs & near))
    return Agreement(len(least), gouging, close, outside, inside, widest)


def _compared(cutter: Profile, count: int, random: np.random.Generator) -> NDArray:
    theta, part = random_contacts(cutter, count, random)
    tilt, bend = random.normal(size=(count, 1, 2)), random.normal(size=(count, 1))
    height = quadric(part[:, None], 0.5 * tilt / cutter.max_radius, 0.5 * bend / cutter.max_radius)
    least = compare_contact(contact_at(cutter, theta), part).least
    return np.stack([least, least_clearance(cutter, theta, height, NEIGHBOURHOOD)])
