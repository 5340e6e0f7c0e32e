"""The torture: the removal road holds, and the oracle finds what is wrong with false claims, by a road of its own."""

import ast
import json
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from gearsim.cli import main
from gearsim.cutters.catalogue import CUTTERS, ball, bull, face_mill_head, flat, t_slot
from gearsim.errors import InputError
from gearsim.geometry.rays import RayBundle
from gearsim.motion.segments import compile_motion, join
from gearsim.motion.sources import CLMotion
from gearsim.simulation.intervals import IntervalSet
from gearsim.simulation.removal import cut
from gearsim.verify.torture import exact, motions, rays, tools
from gearsim.verify.torture.campaign import Tried, case, try_cases
from gearsim.verify.torture.command import PAIRS, TOLERANCE, planned, torture
from gearsim.verify.torture.defects import END, LOST, SPANNED, _gap, defects
from gearsim.verify.torture.judge import CLEAR, HIT, UNDECIDED, Claim, judge
from gearsim.verify.torture.meridian import bodies

FOLDER = Path(__file__).parents[3] / "gearsim" / "verify" / "torture"
UP = [0.0, 0.0, 1.0]


def line(cutter, start, end, first=UP, last=UP):
    axes = np.array([first, last]) / np.linalg.norm([first, last], axis=1)[:, None]
    return compile_motion(CLMotion(np.array([start, end], dtype=float), axes), cutter.reach)


def along_y(x, z, n=1):
    origin = np.column_stack([np.atleast_1d(x), np.full(n, -30.0), np.full(n, z)])
    return RayBundle(origin, np.tile([0.0, 1.0, 0.0], (n, 1)), np.zeros(n), np.full(n, 60.0))


def claim(cutter, table, bundle, *intervals):
    lo, hi = (np.array([i[k] for i in intervals], dtype=float) for k in (0, 1))
    none = np.zeros(len(lo), dtype=int)
    return Claim(bundle, table, cutter, IntervalSet(np.array([0, len(lo)]), lo, hi, none, none))


def verdicts(cutter, table, bundle, *intervals):
    (found,) = judge([claim(cutter, table, bundle, *intervals)], TOLERANCE)
    return int(found.lost[0]), int(found.spanned[0])


def test_small_torture_finds_nothing_wrong():
    figures, _ = torture("small", 1)
    assert not figures.defects
    assert figures.undecided <= 5e-4 * figures.rays
    assert figures.pairs >= PAIRS["small"]
    assert figures.hits > 0.5 * figures.rays
    assert figures.flagged < 0.01 * figures.rays
    for prefix, kinds in (("tool", tools.KINDS), ("motion", motions.KINDS), ("ray", rays.KINDS)):
        assert {f"{prefix} {kind}" for kind in kinds} <= set(figures.by)


def test_heads_that_lost_slivers_lose_none():
    """A chord of a grazed head was lost, ends were off by 2e-7 mm, rays in a face that moves in its plane flagged."""
    seeds = [(0, 18, 15), (0, 25, 3), (0, 25, 39), (0, 30, 33), (0, 45, 33)]
    for tried in try_cases([planned(seed, "medium") for seed in seeds], TOLERANCE):
        assert tried.case.cutter.is_ring
        assert tried.trusted.all()
        assert not defects(tried, TOLERANCE)


def test_every_cutter_of_the_catalogue_is_tried_in_every_size():
    assert set(CUTTERS) <= {*tools.KINDS, *tools.ALIKE}
    assert set(tools.ALIKE.values()) <= set(tools.KINDS)
    rng = np.random.default_rng(3)
    for kind in tools.KINDS:
        for size in (1e-3, 1.0, 1e3):
            for round_numbers in (False, True):
                assert 0.0 < tools.draw(kind, rng, size, round_numbers).max_radius < 12.0 * size


def test_a_case_is_the_same_for_the_same_seed():
    a, b = planned((5, 2, 7), "small"), planned((5, 2, 7), "small")
    assert np.array_equal(a.rays.origin, b.rays.origin)
    assert np.array_equal(a.table.tip, b.table.tip)
    assert not np.array_equal(a.rays.origin, planned((5, 2, 24), "small").rays.origin)


@pytest.mark.parametrize("cutter", [flat(4.0, 20.0), ball(4.0, 20.0), bull(4.0, 1.0, 20.0)])
@pytest.mark.parametrize("x", [-17.0, -17.0 + 1e-9, -17.0 - 1e-9, -18.0])
def test_a_ray_that_touches_the_end_pose_loses_the_whole_diameter(cutter, x):
    table, bundle = line(cutter, [-20, 0, 0], [-15, 0, 0]), along_y(x, 10.0)
    assert verdicts(cutter, table, bundle, (28.0, 32.0)) == (CLEAR, CLEAR)
    assert verdicts(cutter, table, bundle) == (HIT, CLEAR)
    assert verdicts(cutter, table, bundle, (28.0, 31.99)) == (HIT, CLEAR)
    assert verdicts(cutter, table, bundle, (28.0 - 3e-9, 32.0)) == (CLEAR, HIT)
    assert verdicts(cutter, table, bundle, (28.0 + 3e-9, 32.0)) == (HIT, CLEAR)


@pytest.mark.parametrize("x", [-13.0, -22.0])
def test_a_ray_that_touches_the_swept_body_in_a_point_may_be_either(x):
    cutter = flat(4.0, 20.0)
    table, bundle = line(cutter, [-20, 0, 0], [-15, 0, 0]), along_y(x, 10.0)
    assert verdicts(cutter, table, bundle) == (CLEAR, CLEAR)
    assert verdicts(cutter, table, bundle, (30.0, 30.0)) == (CLEAR, CLEAR)
    assert verdicts(cutter, table, bundle, (29.99, 30.01)) == (CLEAR, HIT)


@pytest.mark.parametrize(("z", "spread"), [(0.0, 0.0), (-1e-9, None), (20.0, 0.0), (1e-9, 2.0)])
def test_a_ray_in_a_face_may_be_either_beside_it_it_may_not(z, spread):
    cutter = flat(4.0, 20.0)
    table, bundle = line(cutter, [-20, 0, 0], [-15, 0, 0]), along_y(-18.0, z)
    empty, full = verdicts(cutter, table, bundle), verdicts(cutter, table, bundle, (28.0, 32.0))
    assert empty == ((HIT, CLEAR) if spread else (CLEAR, CLEAR))
    assert full == ((CLEAR, HIT) if spread is None else (CLEAR, CLEAR))


def test_a_gap_between_neck_and_disc_is_no_cut():
    """From inside the neck of a T-slot cutter a steep ray leaves by its side and enters the disc farther down."""
    cutter = t_slot(6.0, 1.0, 2.0, 10.0)
    table = line(cutter, [0, 0, 0], [0, 0, 0])
    ray = RayBundle(np.array([[0.0, 0.0, 5.0]]), np.array([[0.28, 0.0, -0.96]]), np.zeros(1), np.full(1, 30.0))
    neck, disc = (0.0, 1.0 / 0.28), (4.0 / 0.96, 5.0 / 0.96)
    assert verdicts(cutter, table, ray, neck, disc) == (CLEAR, CLEAR)
    assert verdicts(cutter, table, ray, (0.0, disc[1])) == (CLEAR, HIT)
    assert verdicts(cutter, table, ray, neck) == (HIT, CLEAR)
    assert verdicts(cutter, table, ray, disc) == (HIT, CLEAR)
    assert verdicts(cutter, table, ray, (0.0, 2.0), (2.0 + 4e-9, neck[1]), disc) == (HIT, CLEAR)


@pytest.mark.parametrize(("gap", "verdict"), [(0.9e-9, CLEAR), (1.2e-9, HIT), (2.5e-9, HIT)])
def test_a_gap_may_be_closed_if_it_is_no_wider_than_the_tolerance(gap, verdict):
    cutter, y = flat(4.0, 20.0), 4.0 + gap
    table = join([line(cutter, at, at) for at in ([0, 0, 0], [0, y, 0])])
    assert verdicts(cutter, table, along_y(0.0, 10.0), (28.0, 32.0 + y)) == (CLEAR, verdict)
    assert verdicts(cutter, table, along_y(0.0, 10.0), (28.0, 32.0), (28.0 + y, 32.0 + y)) == (CLEAR, CLEAR)


def test_a_ring_has_a_hole():
    cutter = face_mill_head(10.0, 4.0, 0.0, 0.0, 0.0, 3.0)
    table, bundle = line(cutter, [0, 0, 0], [0, 0, 1]), along_y(0.0, 1.0)
    assert verdicts(cutter, table, bundle, (18.0, 22.0), (38.0, 42.0)) == (CLEAR, CLEAR)
    assert verdicts(cutter, table, bundle, (18.0, 42.0)) == (CLEAR, HIT)
    assert verdicts(cutter, table, bundle, (18.0, 22.0)) == (HIT, CLEAR)
    assert verdicts(cutter, table, bundle, (18.0, 22.0), (38.0 + 1e-8, 42.0)) == (HIT, CLEAR)


def test_false_claims_are_found_and_named():
    """Random rays through the tool, cut a tenth of a micrometre short, or a nanometre and a half too long."""
    cases = [case((11, i), kind, "straight", ["through"], 8) for i, kind in enumerate(tools.KINDS)]
    for tried in try_cases(cases, TOLERANCE):
        removed = tried.removal.removed
        for change in (-1e-7, 2.5e-9):
            false = replace(removed, hi=removed.hi + change)
            (found,) = judge([Claim(tried.case.rays, tried.case.table, tried.case.cutter, false)], TOLERANCE)
            wrong = Tried(tried.case, replace(tried.removal, removed=false), found)
            named = {d.ray: d.kind for d in defects(wrong, TOLERANCE)}
            long = np.unique(removed.ray[removed.hi - removed.lo > 1e-6])
            sure = [int(ray) for ray in long if found.noise[ray] < 0.02 * abs(change)]
            assert [ray for ray in sure if named.get(ray) != END] == [], tried.case.tool


@pytest.mark.parametrize("kind", tools.KINDS)
def test_what_the_oracle_clears_stands_up_to_sampled_poses(kind):
    """At random poses no point beside the claim lies in the tool; points of the claim come near it at some pose."""
    rng = np.random.default_rng(2)
    (tried,) = try_cases([case((23, len(kind)), kind, "nc", ["through", "grazing"], 12)], TOLERANCE)
    c, found, removed = tried.case, tried.judgement, tried.removal.removed
    x = np.append(rng.uniform(-1.0, 1.0, 398), [-1.0, 1.0])
    powers = np.vander(x, 6, increasing=True)
    tips, axes = (np.einsum("xk,nkc->nxc", powers, k).reshape(-1, 3) for k in (c.table.tip, c.table.axis))
    clear = np.flatnonzero((found.lost == CLEAR) & (found.spanned == CLEAR) & tried.trusted)
    assert len(clear) > 12
    for ray in clear:
        own = removed.ray == ray
        lo, hi = removed.lo[own], removed.hi[own]
        middle = c.rays.end[ray] / 2.0
        tau = middle + c.cutter.reach * rng.uniform(-2.0, 2.0, 100)
        tau = np.concatenate([tau, lo - 2e-9, hi + 2e-9, 0.5 * (lo + hi)])
        q = c.rays.origin[ray] + tau[:, None, None] * c.rays.direction[ray] - tips
        z = (q * axes).sum(axis=2)
        least = c.cutter.signed_distance(np.linalg.norm(q - z[..., None] * axes, axis=2), z).min(axis=1)
        claimed = ((tau[:, None] > lo - TOLERANCE) & (tau[:, None] < hi + TOLERANCE)).any(axis=1)
        assert np.all(least[~claimed] > -found.noise[ray])
        assert np.all(least[claimed] < 0.05 * c.table.speed.max() + found.noise[ray])


@pytest.mark.parametrize("kind", tools.KINDS)
def test_the_supporting_planes_give_the_profile_back(kind):
    rng = np.random.default_rng(7)
    for round_numbers in (False, True):
        cutter = tools.draw(kind, rng, 1.0, round_numbers)
        r = rng.uniform(0.0, 1.4 * cutter.max_radius, 4000)
        z = rng.uniform(cutter.box[2] - 1.0, cutter.height + 1.0, 4000)
        parts = bodies(cutter)[:1] if cutter.is_ring else bodies(cutter)
        own = np.min([support_distance(b, r, z) for b in parts], axis=0)
        true = cutter.signed_distance(r, z)
        outside = true > 0.0
        assert np.array_equal(own > 1e-12, true > 1e-12)
        assert np.allclose(own[outside], true[outside], atol=1e-12)
        for k in rng.integers(4000, size=5):
            assert float(exact.section_distance(cutter, r[k], z[k])) == pytest.approx(true[k], abs=1e-12)


def support_distance(body, r, z):
    best = np.max([n * r + m * z - h for n, m, h in body.planes], axis=0)
    for cr, cz, radius, n0, m0, n1, m1 in body.wedges:
        dr, dz = r - cr, z - cz
        within = (n0 * dz - m0 * dr >= 0.0) & (m1 * dr - n1 * dz >= 0.0)
        best = np.where(within, np.maximum(best, np.hypot(dr, dz) - radius), best)
    return best


def test_forty_digits_decide_what_float64_cannot():
    cutter = flat(4.0, 20.0)
    table = line(cutter, [-20, 0, 0], [-15, 0, 0])
    ray = (-13.0, -30.0, 10.0), (0.0, 1.0, 0.0)
    tip = sum(map(Fraction, table.tip[0, :, 0]), Fraction(0))
    off = exact.distance(cutter, table, 0, *ray, 1.0, 30.0)
    assert float(off) == pytest.approx(float(-13 - tip - 2), abs=1e-25)
    assert float(exact.least_distance(cutter, table, (-12.0, -30.0, 10.0), (0.0, 1.0, 0.0), 30.0)) == pytest.approx(1.0)


def test_the_oracle_shares_no_code_with_the_kernels():
    for file in FOLDER.rglob("*.py"):
        for node in ast.walk(ast.parse(file.read_text())):
            names = [a.name for a in node.names] if isinstance(node, ast.Import) else []
            names += [node.module or ""] if isinstance(node, ast.ImportFrom) else []
            assert not any(n.startswith("gearsim.kernels") for n in names), file
            if file.parent.name == "oracle":
                assert not any(n.startswith("gearsim") and "torture.oracle" not in n for n in names), file


def test_the_command_reports_and_refuses(tmp_path, capsys, monkeypatch):
    monkeypatch.setitem(PAIRS, "small", 1)
    assert main(["verify", "--torture", "small", "--out", str(tmp_path / "t.json")]) in (0, 1)
    report = json.loads((tmp_path / "t.json").read_text())
    assert {LOST.replace(" ", "_"), SPANNED.replace(" ", "_"), "pairs", "undecided", "by", "worst"} <= set(report)
    assert "ray-row pairs" in capsys.readouterr().out
    assert main(["verify", "--torture", "huge"]) == 2
    assert "small, medium, large" in capsys.readouterr().err
    assert main(["verify", "spiral-bevel-flank", "--torture", "small"]) == 2
    with pytest.raises(InputError, match="no torture"):
        torture("huge", 1)
    assert UNDECIDED == 2


def test_a_gap_that_noise_makes_look_longer_than_the_tolerance_is_measured_in_40_digits():
    """A barrel on an arc, all but touching a ray that it leaves for 0.93 nm: closed, as gaps up to a nanometre are."""
    (tried,) = try_cases([planned((904, 11, 20), "large")], 1e-9)
    (ray,) = np.flatnonzero(tried.spanned)
    assert _gap(tried, ray, 1e-9) == pytest.approx(9.25e-10, abs=5e-12)
    assert defects(tried, 1e-9) == []
    finer = cut(tried.case.rays.part(np.array([ray])), tried.case.table, tried.case.cutter, tolerance=1e-12).removed
    assert finer.lo[1] - finer.hi[0] == pytest.approx(9.28e-10, abs=2e-12)
