"""Plans the same graphs with Lichtenberg and with scipy, checks that the costs are equal, and prints the ratio.

    pip install -r benches/requirements.txt
    python benches/compare_scipy.py [--small PROGRAM]

The graphs are those that the library exports (examples/graph.rs); weights are integers, so that costs must be equal
to the last bit. --small is what the tests run, with the example that they have built.
"""
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import dijkstra

LARGE = [(4, 2048, 3, 1), (8, 2048, 3, 1), (6, 80, 3, 1), (18, 80, 3, 1), (26, 80, 3, 1), (6, 256, 3, 1), (6, 256, 3, 2)]
SMALL = [(4, 200, 3, 1), (8, 200, 1, 1), (6, 40, 3, 1), (18, 30, 2, 1), (26, 30, 3, 1), (6, 101, 3, 2)]


def compare(neighbours, side, alpha, threads, command):
    with tempfile.TemporaryDirectory() as folder:
        call = [str(a) for a in (neighbours, side, alpha, folder, threads)]
        said = subprocess.run(command + call, check=True, capture_output=True, text=True, cwd=Path(__file__).parent.parent)
        ours = json.loads(said.stdout)
        u, v, w = (np.fromfile(f"{folder}/{name}.u32", dtype="<u4") for name in ("from", "to", "weight"))
        costs = np.fromfile(f"{folder}/cost.u64", dtype="<u8")
    n = ours["nodes"]
    u, v, w = u.astype(np.int32), v.astype(np.int32), w.astype(np.float64)
    graph = csr_matrix((np.r_[w, w], (np.r_[u, v], np.r_[v, u])), shape=(n, n))
    del u, v, w
    best = float("inf")
    for _ in range(1 if n > 1_000_000 else 3):
        clock = time.perf_counter()
        theirs = dijkstra(graph, indices=ours["root"])
        best = min(best, time.perf_counter() - clock)
    # Integers below 2^53: equal or wrong.
    assert np.array_equal(theirs, costs.astype(np.float64)), f"costs differ: {neighbours} neighbours, side {side}"
    per_node = 1e9 / n
    print(
        f"{neighbours:2} neighbours, side {side}, alpha {alpha}, {threads} thread(s): costs equal; "
        f"{ours['seconds'] * per_node:.1f} ns/node, scipy {best * per_node:.0f}, ratio {best / ours['seconds']:.1f}",
        flush=True,
    )


if "--small" in sys.argv:
    for case in SMALL:
        compare(*case, [sys.argv[2]])
else:
    for case in LARGE:
        compare(*case, ["cargo", "run", "--release", "--quiet", "--example", "graph", "--"])
