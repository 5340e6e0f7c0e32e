from dataclasses import replace

import numpy as np
import pytest

from gearsim.cutters.catalogue import apt
from gearsim.cutters.end_mills import ball
from gearsim.errors import InputError
from gearsim.geometry.rigid import Rigid
from gearsim.geometry.solid import Block
from gearsim.geometry.turned import Turned
from gearsim.geometry.wedge import Wedge
from gearsim.motion.sources import CLMotion
from gearsim.simulation.dexels import DexelBox
from gearsim.simulation.operation import operation, turned_copies
from gearsim.simulation.stock import AXES, blank_stock, cut_stock, turn_stock
from gearsim.simulation.stock_file import load_stock, save_stock
from gearsim.simulation.workshop import Workshop

BLOCK = Block(np.zeros(3), np.array([30.0, 20.0, 10.0]))
UP = np.array([0.0, 0.0, 1.0])


def line(name, cutter, *tips, axis=UP):
    return operation(name, cutter, [CLMotion(np.array(tips, dtype=float), np.tile(axis, (len(tips), 1)))], 1e-9)


GROOVE = line("groove", ball(6.0, 30.0), (-5.0, 10.0, 6.0), (35.0, 10.0, 6.0))
SLOT = line("slot", apt(4.0, 0.0, 0.0, 0.0, 0.0, 0.0, 30.0), (15.0, -5.0, 5.0), (15.0, 25.0, 5.0))


def box_around(solid, pitch, shift=0.0):
    lower, upper = solid.box
    return DexelBox(Rigid(np.eye(3), np.zeros(3)), lower - pitch + shift, upper + pitch + shift, pitch)


def same(a, b):
    names = ("first", "lo", "hi", "lo_segment", "hi_segment")
    return all(np.array_equal(getattr(p, n), getattr(q, n)) for p, q in zip(a.left, b.left, strict=True) for n in names)


@pytest.fixture(scope="module")
def shop():
    return Workshop("cpu")


@pytest.fixture(scope="module")
def cut(shop):
    return cut_stock(blank_stock(box_around(BLOCK, 0.5, 0.1), BLOCK), [GROOVE, SLOT], shop)


def test_a_ray_of_one_interval_takes_32_bytes():
    stock = blank_stock(box_around(BLOCK, 0.25), BLOCK)
    rays = sum(len(k.first) - 1 for k in stock.left)
    intervals = sum(len(k.lo) for k in stock.left)
    assert stock.nbytes == 8 * (rays + 3) + 24 * intervals
    assert intervals <= rays


@pytest.mark.parametrize("axis", AXES)
def test_the_volume_of_a_groove_converges(axis, shop):
    """A ball of 3 mm along a line 1 mm under its middle: a rounded channel, in closed form."""
    exact = 30.0 * (0.5 * np.pi * 9.0 + 6.0 * 1.0)
    errors = []
    for pitch in (1.0, 0.25):
        blank = blank_stock(box_around(BLOCK, pitch, 0.013), BLOCK)
        left = cut_stock(blank, [GROOVE], shop)
        errors.append(abs(blank.volumes[axis] - left.volumes[axis] - exact) / exact)
    assert errors[1] < 0.02
    assert errors[1] < 0.6 * errors[0] + 1e-9


def test_the_order_of_cuts_leaves_the_same_material(cut, shop):
    other = cut_stock(blank_stock(cut.box, BLOCK), [SLOT, GROOVE], shop)
    for a, b in zip(cut.left, other.left, strict=True):
        assert np.array_equal(a.first, b.first)
        assert np.allclose(a.lo, b.lo, atol=3e-9)
        assert np.allclose(a.hi, b.hi, atol=3e-9)


def test_tags_name_the_operation_that_made_an_end(cut):
    z = cut.left[2]
    points = cut.box.rays(2).origin[z.ray]
    made = cut.operation_of(z.hi_segment)
    top = points[:, 2] + z.hi
    assert [d.name for d in cut.done] == ["groove", "slot"]
    assert np.all(np.abs(top[made == -1] - 10.0) < 1e-12)
    assert np.all(np.abs(top[made == 1] - 5.0) < 1e-8)
    assert np.any(made == 1)
    off = np.abs(points[:, 1] - 10.0)
    round_floor = (made == 0) & (off < 3.0)
    assert np.allclose(top[round_floor], 9.0 - np.sqrt(9.0 - off[round_floor] ** 2), atol=1e-8)
    assert np.all(off[made == 0] < 3.0)


def test_what_is_saved_is_read_and_continued_bit_by_bit(cut, shop, tmp_path):
    half = cut_stock(blank_stock(cut.box, BLOCK), [GROOVE], shop)
    save_stock(half, tmp_path / "half.parquet", "a job")
    again, job = load_stock(tmp_path / "half.parquet")
    assert job == "a job"
    assert again.done == half.done
    assert same(again, half)
    assert again.box.pitch == half.box.pitch
    assert np.array_equal(again.box.lower, half.box.lower)
    assert same(cut_stock(again, [SLOT], shop), cut)
    assert [f.name for f in tmp_path.iterdir()] == ["half.parquet"]


def test_files_that_are_no_stock_are_told(cut, tmp_path):
    import pyarrow as pa
    import pyarrow.parquet as pq

    file = tmp_path / "stock.parquet"
    file.write_bytes(b"PAR1")
    with pytest.raises(InputError, match="cannot be read"):
        load_stock(file)
    with pytest.raises(InputError, match="cannot be read"):
        load_stock(tmp_path / "missing.parquet")
    pq.write_table(pa.table({"a": [1]}), file)
    with pytest.raises(InputError, match="no stock of gearsim"):
        load_stock(file)
    save_stock(cut, file)
    table = pq.read_table(file)
    meta = table.schema.metadata[b"gearsim.stock"]
    for old, new, told in (
        (b'"version": 1', b'"version": 7', "version 7; this gearsim reads version 1"),
        (b'"rows": 1', b'"rows": 0', "of no operation"),
        (b'"pitch"', b'"step"', "'pitch' is missing"),
        (b'"pitch": 0.5', b'"pitch": -2', "its box .* has another form"),
        (b'"unit": "mm"', b'"unit": "inch"', "unit inch; expected mm"),
        (b'"rotation": [[1.0', b'"rotation": [[2.0', "rotation = .* has another form"),
        (b'"translation": [0.0, ', b'"translation": [', "translation = .* has another form"),
        (b'"translation": [0.0', b'"translation": [NaN', "translation = .* has another form"),
        (meta, b"{", "no JSON"),
        (meta, b"[1]", "version None"),
    ):
        assert old in meta
        pq.write_table(table.replace_schema_metadata({b"gearsim.stock": meta.replace(old, new)}), file)
        with pytest.raises(InputError, match=told):
            load_stock(file)
    pq.write_table(table.take(list(range(len(table)))[::-1]), file)
    with pytest.raises(InputError, match="must rise along rays"):
        load_stock(file)


@pytest.mark.parametrize(
    ("name", "values", "told"),
    [
        ("bundle", lambda x: np.where(x == 1, 9, x).astype(np.int8), "bundles are 0, 2, 9"),
        ("ray", lambda x: x + 0.5, "column ray of double"),
        ("lo_mm", lambda x: x.astype(str), "column lo_mm of"),
        ("lo_mm", lambda x: np.where(np.arange(len(x)) == 0, -1.0, x), "from 0 to"),
        ("lo_tag", lambda x: np.minimum(x - 5, 0).astype(np.int32), "tag -6 is of no operation"),
    ],
)
def test_columns_of_another_form_are_told(name, values, told, cut, tmp_path):
    import pyarrow.parquet as pq

    file = tmp_path / "stock.parquet"
    save_stock(cut, file)
    table = pq.read_table(file)
    pq.write_table(
        table.set_column(table.column_names.index(name), name, [values(table.column(name).to_numpy())]), file
    )
    with pytest.raises(InputError, match=told):
        load_stock(file)


def test_a_folder_that_cannot_be_written_is_told(cut, tmp_path):
    with pytest.raises(InputError, match="cannot write stock"):
        save_stock(cut, tmp_path / "none" / "stock.parquet")


def test_a_gear_is_cut_by_turned_copies_of_one_space(shop):
    """The copies in one operation are those one by one, the part indexed; steps and motions go on counting."""
    disc = Turned(np.array([[0.0, 0.0], [12.0, 0.0], [12.0, 4.0], [0.0, 4.0]]))
    once = line("space", ball(3.0, 30.0), (10.0, 0.0, -2.0), (10.0, 0.0, 7.0), axis=np.array([1.0, 0.0, 0.0]))
    all_five = turned_copies(once, 5)
    blank = blank_stock(box_around(disc, 0.5, 0.1), disc)
    left = cut_stock(blank, [all_five], shop)
    turns = [Rigid(np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]), np.zeros(3)) for c, s in
             ((np.cos(a), np.sin(a)) for a in 0.4 * np.pi * np.arange(5))]  # fmt: skip
    each = cut_stock(blank, [replace(once, table=once.table.moved(turn)) for turn in turns], shop)
    for a, b in zip(left.left, each.left, strict=True):
        assert np.array_equal(a.first, b.first)
        assert np.allclose(a.lo, b.lo, atol=3e-9)
        assert np.allclose(a.hi, b.hi, atol=3e-9)
    assert left.volumes[2] < 0.95 * blank.volumes[2]
    assert len(all_five.sources) == 5
    assert np.array_equal(np.unique(all_five.step), np.arange(5))
    piece, t = np.zeros(1, dtype=int), np.full(1, 0.5)
    for k, source in enumerate(all_five.sources):
        expected = turns[k].point(once.sources[0].pose(piece, t, 0).tip.value)
        assert np.allclose(source.pose(piece, t, 0).tip.value, expected)


def test_turning_leaves_what_lies_within_the_outline(shop):
    disc = Turned(np.array([[2.0, 0.0], [8.0, 0.0], [8.0, 6.0], [2.0, 6.0]]))
    bar = Block(np.array([-9.0, -9.0, -1.0]), np.array([9.0, 9.0, 7.0]))
    turned = turn_stock(blank_stock(box_around(bar, 0.5, 0.1), bar), disc, "turning")
    straight = blank_stock(turned.box, disc)
    for a, b in zip(turned.left, straight.left, strict=True):
        assert np.array_equal(a.first, b.first)
        assert np.array_equal(a.lo, b.lo)
        assert np.array_equal(a.hi, b.hi)
    assert turned.done[0].rows == 1
    assert all(np.all(k.lo_segment == 0) for k in turned.left)


@pytest.mark.parametrize("shift", [0.0, 0.25, 1e-7, -1e-7])
def test_faces_exactly_on_rays_leave_no_skin_and_no_gouge(shift, shop):
    """Tool walls and floor, and the block's faces, in planes of rays: what is left differs by rows of rays alone."""
    pitch = 0.5
    stock = cut_stock(blank_stock(box_around(BLOCK, pitch, 0.25 + shift), BLOCK), [SLOT], shop)
    z, rays = stock.left[2], stock.box.rays(2)
    x = rays.origin[:, 0]
    count = np.diff(z.first)
    assert np.all(count <= 1)
    deep = np.abs(x[z.ray] - 15.0) < 2.0 - 1e-6
    top = rays.origin[z.ray, 2] + z.hi
    clear = np.abs(np.abs(x[z.ray] - 15.0) - 2.0) > 1e-6
    assert np.allclose(top[deep & clear], 5.0, atol=1e-8)
    assert np.allclose(top[~deep & clear], 10.0, atol=1e-12)
    beside = np.isclose(np.abs(x[z.ray] - 15.0), 2.0, atol=1e-6)
    assert np.all(np.isclose(top[beside], 5.0, atol=1e-8) | np.isclose(top[beside], 10.0, atol=1e-12))


def test_every_sector_is_the_first_one_turned(shop):
    """Five alike spaces: a sector's rays, turned into another sector, find the same material."""
    ring = Turned(np.array([[4.0, 0.0], [12.0, 0.0], [12.0, 4.0], [4.0, 4.0]]))
    once = line("space", ball(3.0, 30.0), (10.0, 1.0, -2.0), (10.0, 1.0, 7.0), axis=np.array([1.0, 0.0, 0.0]))
    found = []
    for k in (0, 3):
        wedge = Wedge(ring, 0.3 + 0.4 * np.pi * k, 0.2 * np.pi)
        c, s = np.cos(wedge.middle), np.sin(wedge.middle)
        about = Rigid(np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]), np.zeros(3))
        lower, upper = wedge.box
        box = DexelBox(about, lower - 0.31, upper + 0.29, 0.3)
        found.append(cut_stock(blank_stock(box, wedge), [turned_copies(once, 5)], shop))
    for a, b in zip(found[0].left, found[1].left, strict=True):
        assert np.array_equal(a.first, b.first)
        assert np.allclose(a.lo, b.lo, atol=3e-9)
        assert np.allclose(a.hi, b.hi, atol=3e-9)
