import numpy as np
import pytest
import zarr

from gearsim.studies.map_files import ArrayKind

KIND = ArrayKind("a", (70, 4, 6), (32, 4, 6), ("job", "row", "column"))


@pytest.mark.parametrize("kind", [KIND, ArrayKind("b", (70, 5), (32, 5), ("job", "row"), "|u1", 3)])
def test_zarr_reads_chunks_as_they_were(tmp_path, kind):
    values = np.arange(np.prod(kind.shape)).reshape(kind.shape).astype(kind.dtype)
    files = {kind.place(k): kind.chunk_file(values[32 * k : 32 * (k + 1)]) for k in range(3)} | kind.files()
    for name, data in files.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_bytes(data)
    np.testing.assert_array_equal(zarr.open_array(tmp_path / kind.name, mode="r")[...], values)
    assert list(kind.files(values)) == sorted(files)


def test_a_chunk_of_fill_values_alone_has_no_file_and_reads_as_such(tmp_path):
    assert KIND.chunk_file(np.full((5, 4, 6), np.nan)) is None
    assert list(KIND.files(np.full(KIND.shape, np.nan))) == ["a/zarr.json"]
    (tmp_path / "a").mkdir()
    (tmp_path / KIND.described).write_bytes(KIND.files()[KIND.described])
    assert np.isnan(zarr.open_array(tmp_path / "a", mode="r")[...]).all()
    zeros = ArrayKind("c", (4,), (4,), ("job",), "<f8", 0.0)
    assert zeros.chunk_file(np.array([-0.0, 0.0])) is None
