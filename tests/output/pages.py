"""Looks at pages with texts on them."""

from itertools import combinations


def overlaps(page):
    """Pairs of texts whose boxes share more than a pixel both ways."""
    for (a, p), (b, q) in combinations(page, 2):
        across = min(p.x1, q.x1) - max(p.x0, q.x0)
        if across > 1.0 and min(p.y1, q.y1) - max(p.y0, q.y0) > 1.5:
            yield a, b
