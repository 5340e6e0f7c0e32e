#!/bin/sh
# DuckDB 2.0: isnan() finds no NaN in a Parquet file that pyarrow or Polars wrote, and max() tells another maximum than
# of the same table in memory.
#
# A Parquet file keeps the least and the greatest number of each row group, NaN left out. To DuckDB NaN is greater than
# every number: in memory, and in a file of its own, max is nan, and d > 5 and isnan(d) find the row. In pyarrow's file
# the greatest number kept is 2: max is 2, and the row group is skipped for d > 5, not (d <= 5) and even for isnan(d). In
# Polars' file max is nan and the row is not found either. A count of points that were not measured is 0 of 1.
#
# Expected: a query means the same in memory and in a file (docs: NaN is treated as greater than all other values; the
# Parquet format: when looking for NaN values, min and max should be ignored). NaN written as null is found by is null.
# Exits 0 while this is so.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install -q duckdb==2.0.1 pyarrow==26.0.1 polars==2.1.0 >/dev/null 2>&1 ||
    { echo "the packages cannot be fetched"; exit 2; }
venv/bin/python - <<'END'
import sys

import duckdb
import polars
import pyarrow as pa
import pyarrow.parquet as pq

print("duckdb", duckdb.__version__, "pyarrow", pa.__version__, "polars", polars.__version__)
points = pa.table({"point": [0, 1, 2], "d": [1.0, float("nan"), 2.0]})
pq.write_table(points, "pyarrow.parquet")
polars.from_arrow(points).write_parquet("polars.parquet")
duckdb.sql("copy points to 'duckdb.parquet'")
WHERE = ("isnan(d)", "d > 5", "not (d <= 5)")
SEEN = {
    "points": ["nan", [1], [1], [1]],
    "'duckdb.parquet'": ["nan", [1], [1], [1]],
    "'pyarrow.parquet'": ["2.0", [], [], []],
    "'polars.parquet'": ["nan", [], [], []],
}
print(f"expected everywhere: max nan, point 1 by {', '.join(WHERE)}")
changed = False
for table, before in SEEN.items():
    found = [[row[0] for row in duckdb.sql(f"select point from {table} where {where}").fetchall()] for where in WHERE]
    seen = [str(duckdb.sql(f"select max(d) from {table}").fetchall()[0][0]), *found]
    print(f"{table}: seen {seen}", "" if seen == before else f"CHANGED: it was {before}")
    changed |= seen != before
sys.exit(changed)
END
