#!/bin/sh
# SALib 1.6 (analyze.rbd_fast) and OpenTURNS 1.27 (RankSobolSensitivityAlgorithm): Sobol indices of given data are 0.8
# and more for parameters without any effect, where a parameter's values repeat and the rows stand in a design's order.
#
# Both sort the runs by each parameter and compare neighbours; equal values stay as the rows stood. In a design of few
# levels the other parameters then go on smoothly and look like the effect of this one. SALib's own two-level design
# (sample.ff, 60 parameters, 128 runs): y = x0 gives 0.95 for x0 and 0.83 for each of the 59 others. By ranks, 12 levels
# of 3 parameters: y = a gives 1.00, 0.96, 0.96; y = a + b + c gives 0.83 three times. The same rows shuffled give about
# what is right. No warning.
#
# Expected: the same indices in whatever order the runs are handed over (docs of rbd_fast: compatible with all samplers;
# of the ranks: an i.i.d. sample of independent parameters, nothing of ties or order). Exits 0 while this is so.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install -q openturns==1.27.post1 SALib==1.6.0 numpy==2.4.6 scipy==1.17.1 >/dev/null 2>&1 ||
    { echo "the packages cannot be fetched"; exit 2; }
venv/bin/python - <<'END'
import sys
from importlib.metadata import version

import numpy as np
import openturns as ot
from SALib.analyze import rbd_fast
from SALib.sample import ff

print("openturns", ot.__version__, "SALib", version("SALib"))
problem = {"num_vars": 60, "names": [f"x{i}" for i in range(60)], "bounds": [[0.0, 1.0]] * 60}
changed = False


def by_ranks(x, y):
    return np.array(ot.RankSobolSensitivityAlgorithm(ot.Sample(x), ot.Sample(y[:, None])).getFirstOrderIndices())


def by_rbd_fast(x, y):
    return np.array(rbd_fast.analyze(problem, x, y, seed=1)["S1"])


def look(title, method, x, y, true, before, within):
    """Indices of the first three parameters, of the rows in order and shuffled."""
    global changed
    order = np.random.default_rng(1).permutation(len(x))
    seen, shuffled = method(x, y)[:3], method(x[order], y[order])[:3]
    print(f"{title}: expected {np.round(true, 2)}; seen {np.round(seen, 2)}, rows shuffled {np.round(shuffled, 2)}")
    if not (np.allclose(seen, before, atol=0.03) and np.allclose(shuffled, true, atol=within)):
        print(f"  CHANGED: it was {before}")
        changed = True


two_levels = ff.sample(problem, seed=1)
axis = np.linspace(0.0, 1.0, 12)
grid = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), -1).reshape(-1, 3)
look("rbd_fast, y = x0", by_rbd_fast, two_levels, two_levels[:, 0], [1.0, 0.0, 0.0], [0.95, 0.83, 0.83], 0.3)
look("ranks, y = a", by_ranks, grid, grid[:, 0], [1.0, 0.0, 0.0], [1.0, 0.96, 0.96], 0.15)
look("ranks, y = a + b + c", by_ranks, grid, grid.sum(1), [1 / 3] * 3, [0.83] * 3, 0.15)
sys.exit(changed)
END
