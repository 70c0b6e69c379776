"""Section 3.2: the paper's start, Crust over white noise, against the start by construction."""

import json

from harness import Figure

# Closed models; of the thin ones, sheets lie closer than samples.
SMOOTH = {"paper/eight_7402.off": "eight", "paper/kitten_9756.off": "kitten",
          "paper/bunny_6289.off": "bunny", "stress/torus_R1_r0.35.off": "torus"}
THIN = {"thin/helix.off": "helix", "stress/thin_plate_1e-3.off": "plate, 1e-3 thick"}
FIGURES = ["cv", "radius", "nearest", "min_angle", "valence_5_7", "hausdorff"]


def _cell(row):
    """Why what Crust gave is of no use, in a few words."""
    kept, holes = row["crust"], row["with_holes"]
    if kept["triangles"] > 0:
        return f"Euler number {kept['euler']}, {kept['crowded_edges']} edges of three triangles"
    return f"nothing left; {holes['unused']} samples have no triangle before holes are trimmed"


def _rows(bench, model, counts, seeds, *arguments):
    out, _ = bench.run("ccst_paper_crust_start", bench.model(model), "--counts", counts,
                       "--seeds", seeds, *arguments)
    return [json.loads(line) for line in out.splitlines()]


def crust_start(bench):
    figure = Figure("crust", "Section 3.2: the paper's start")
    figure.header = ["surface", "samples", "white noise: usable", "blue noise: usable",
                     "by construction", "seconds", "one that was not"]
    models = {"": "blob"} if bench.quick else SMOOTH | THIN
    for model, name in models.items():
        plans = [("400", "1")] if bench.quick else [("1700", "1,2,3,4,5"), ("5000", "1,2,3,4,5"),
                                                    ("50000", "1")]
        for counts, seeds in plans:
            rows = _rows(bench, model, counts, seeds)
            even = _rows(bench, model, counts, "1", "--points", "even")
            failed = next((_cell(row) for row in rows if not row["crust"]["usable"]), "-")
            seconds = sum(row["crust"]["seconds"] for row in rows) / len(rows)
            figure.rows.append([
                name, counts,
                *(f"{sum(row['crust']['usable'] for row in r)} of {len(r)}" for r in (rows, even)),
                "all", f"{seconds:.1f}", failed])
    figure.text.append(
        "Usable: a closed manifold through all samples, with the topology of the surface. One hole "
        "is enough to lose everything: its edges are sharp, so trimming goes on until nothing is "
        "left. Blue noise here is sample elimination's, the densest that Crust can ask for. The "
        "start by construction always gives the surface's topology."
    )
    converged = Figure("crust-converged", "What both starts converge to")
    converged.header = ["surface", "start", *FIGURES]
    for model, name in list(models.items())[:1]:
        for row in _rows(bench, model, bench.count(1700), "1,2" if not bench.quick else "1",
                         "--converge"):
            for key, title in [("by_construction", "by construction"), ("by_crust", "Crust")]:
                if key in row:
                    converged.rows.append([f"{name}, seed {row['seed']}", title,
                                           *(f"{row[key][f]:.4g}" for f in FIGURES)])
    converged.text.append(
        "The same samples of white noise, connected both ways, and relaxed as ccst does: the "
        "results differ as those of two seeds do. What the start decides is whether there is one."
    )
    return [figure, converged]
