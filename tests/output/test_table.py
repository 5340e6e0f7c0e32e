import subprocess
import sys

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from gearsim.output.columns import Column
from gearsim.output.table import write_table

F = np.array([1.0, np.nan, -2.5, np.inf])
HIDDEN = np.array([True, False, False, True])
KINDS = {
    "number": F, "short": F.astype(np.float32), "count": np.arange(4), "small": np.arange(4, dtype=np.int8),
    "yes": F > 0.0, "word": np.array(["über", "", "b", "ccc"]), "step": np.arange(8)[::2], "none": np.full(4, np.nan),
    "masked": np.ma.array(np.arange(4), mask=HIDDEN), "object": np.array(["a", "bb", "", "d"], dtype=object),
    "masked word": np.ma.array(["a", "b", "", "d"], mask=HIDDEN),
}  # fmt: skip


@pytest.mark.parametrize("name", KINDS)
def test_columns_are_those_that_arrow_makes_of_arrays(name, tmp_path):
    values = KINDS[name]
    write_table([{name: Column(values, "what it is", {})}], {}, tmp_path / "t.parquet")
    none = np.ma.getmaskarray(values)
    if values.dtype.kind == "f":
        none = none | ~np.isfinite(values)
    (found,) = pq.read_table(tmp_path / "t.parquet").columns
    assert found.combine_chunks().equals(pa.array(np.ma.getdata(values), mask=none))


def test_writing_a_table_loads_no_pandas(tmp_path):
    code = f"""
import sys
import numpy as np
from gearsim.output.columns import Column
from gearsim.output.table import write_table
write_table([{{"a": Column(np.array(["x"]), "what it is", {{}})}}], {{}}, {str(tmp_path / "t.parquet")!r})
sys.exit("pandas" in sys.modules)"""
    assert subprocess.run([sys.executable, "-c", code]).returncode == 0
