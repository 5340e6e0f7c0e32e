import numpy as np

from gearsim.simulation.intervals import IntervalSet, from_lists, stretches, subtract, unite


def as_set(per_ray, made=None):
    first = np.cumsum([0] + [len(r) for r in per_ray])
    lo, hi = (np.array([i[k] for r in per_ray for i in r], dtype=float) for k in (0, 1))
    by = np.arange(len(lo)) if made is None else np.full(len(lo), made)
    return IntervalSet(first, lo, hi, by, by)


def test_lists_become_compact_rows():
    lo = np.array([[1.0, 5.0, 9.0], [0.0, 0.0, 0.0], [2.0, 0.0, 0.0]])
    s = from_lists(np.array([2, 0, 1]), lo, lo + 1, np.arange(9).reshape(3, 3), np.arange(9).reshape(3, 3))
    assert s.first.tolist() == [0, 2, 2, 3]
    assert s.lo.tolist() == [1.0, 5.0, 2.0]
    assert s.lo_segment.tolist() == [0, 1, 6]
    assert s.ray.tolist() == [0, 0, 2]


def test_subtraction_leaves_what_pointwise_membership_says(rng):
    rays = 60
    stock = [sorted(rng.uniform(0, 10, 2 * rng.integers(1, 3)).round(3)) for _ in range(rays)]
    cuts = [
        [(a, a + w) for a, w in zip(np.sort(rng.uniform(0, 10, 3)), rng.exponential(0.7, 3), strict=True)]
        for _ in range(rays)
    ]
    disjoint = []
    for r in cuts:
        out = []
        for a, b in r:
            if out and a <= out[-1][1]:
                out[-1] = (out[-1][0], max(out[-1][1], b))
            else:
                out.append((a, b))
        disjoint.append(out)
    ray = np.concatenate([[i] * (len(s) // 2) for i, s in enumerate(stock)])
    start, end = (np.concatenate([s[k::2] for s in stock]) for k in (0, 1))
    left = subtract(stretches(rays, ray, start, end), as_set(disjoint))
    for i in range(rays):
        tau = rng.uniform(-1, 11, 300)
        in_stock = np.any([(tau > a) & (tau < b) for a, b in zip(stock[i][::2], stock[i][1::2], strict=True)], axis=0)
        in_cut = np.any([(tau > a) & (tau < b) for a, b in disjoint[i]], axis=0)
        own = slice(left.first[i], left.first[i + 1])
        kept = np.zeros(300, dtype=bool)
        for a, b in zip(left.lo[own], left.hi[own], strict=True):
            kept |= (tau > a) & (tau < b)
        assert np.array_equal(kept, in_stock & ~in_cut)


def test_ends_remember_who_made_them():
    left = subtract(as_set([[(0.0, 10.0)]], made=-1), as_set([[(2.0, 3.0), (9.0, 12.0)]]))
    assert left.lo.tolist() == [0.0, 3.0]
    assert left.hi.tolist() == [2.0, 9.0]
    assert left.lo_segment.tolist() == [-1, 0]
    assert left.hi_segment.tolist() == [0, 1]


def test_a_union_holds_what_either_holds(rng):
    rays, parts = 40, []
    for _ in range(2):
        ends = [np.sort(rng.uniform(0, 10, 2 * rng.integers(0, 4)).round(1)) for _ in range(rays)]
        parts.append([[(a, b) for a, b in zip(e[::2], e[1::2], strict=True) if b > a] for e in ends])
    both = unite([as_set(p) for p in parts])
    for i in range(rays):
        own = slice(both.first[i], both.first[i + 1])
        assert np.all(both.lo[own][1:] > both.hi[own][:-1])
        tau = rng.uniform(-1, 11, 300)
        held = np.any([(tau > a) & (tau < b) for a, b in parts[0][i] + parts[1][i]] or [np.zeros(300, bool)], axis=0)
        found = np.zeros(300, dtype=bool)
        for a, b in zip(both.lo[own], both.hi[own], strict=True):
            found |= (tau > a) & (tau < b)
        assert np.array_equal(found, held)


def test_a_union_of_one_set_is_that_set():
    one = as_set([[(1.0, 2.0)], []])
    assert unite([one]) is one
