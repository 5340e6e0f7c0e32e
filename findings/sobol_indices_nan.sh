#!/bin/sh
# SALib 1.6: one failed run in hundreds, and no parameter matters: analyze.sobol returns indices of exactly 0.
#
# With one NaN among the outputs every first-order and total index is 0, with intervals 0 wide; nothing is raised, nothing
# is warned of. The same design without the NaN gives 0.2, 0.8 and 0. The quotient by a variance that is NaN is replaced
# by 0 as if the output were constant. analyze.fast makes NaN of one index and gives the others as if all runs were
# whole; analyze.rbd_fast makes NaN of all.
#
# Expected: NaN, or an error (docs: nothing is said of NaN; SciPy's sobol_indices, which does the same, says that values
# must be finite and does not check it). Exits 0 while this is so.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install -q SALib==1.6.0 scipy==1.17.1 numpy==2.4.6 >/dev/null 2>&1 ||
    { echo "the packages cannot be fetched"; exit 2; }
venv/bin/python - <<'END'
import sys
import warnings
from importlib.metadata import version

import numpy as np
from SALib.analyze import rbd_fast, sobol
from SALib.sample import latin
from SALib.sample import sobol as design

print("SALib", version("SALib"))
problem = {"num_vars": 3, "names": ["a", "b", "c"], "bounds": [[0.0, 1.0]] * 3}


def output(inputs, failed):
    """a + 2 b of each run, shape (runs,); NaN of run 7 if it failed."""
    out = inputs @ np.array([1.0, 2.0, 0.0])
    if failed:
        out[7] = np.nan
    return out


def indices(failed):
    """First-order and total indices, and the intervals of the first, of three parameters."""
    runs = design.sample(problem, 256, calc_second_order=False, seed=1)
    found = sobol.analyze(problem, output(runs, failed), calc_second_order=False, seed=1)
    return [np.asarray(found[name]) for name in ("S1", "ST", "S1_conf")]


with warnings.catch_warnings(record=True) as warned:
    warnings.simplefilter("always")
    whole, one_failed = indices(failed=False), indices(failed=True)
print(f"all runs: {np.round(whole[0], 3)}; one of {256 * 5} failed: expected nan, seen {one_failed[0]}")
print(f"total {one_failed[1]}, intervals {one_failed[2]}; warnings: {len(warned)}")
runs = latin.sample(problem, 600, seed=1)
other = np.array(rbd_fast.analyze(problem, runs, output(runs, failed=True), seed=1)["S1"])
print(f"rbd_fast, one failed: {other}")
as_before = (
    np.allclose(whole[0], [0.2, 0.8, 0.0], atol=0.02)
    and all(np.all(a == 0.0) for a in one_failed)
    and not warned
    and bool(np.all(np.isnan(other)))
)
print("as before" if as_before else "CHANGED")
sys.exit(not as_before)
END
