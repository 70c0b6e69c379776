"""Figures 2, 3 and 7: the geometry phase, the evolution, two starts."""

import json

import matplotlib.pyplot as plt

from differentials import plot_differentials
from harness import Figure, panels, show, show_halves

NAMES = {"paper/eight_7402.off": "eight", "paper/kitten_9756.off": "kitten"}


def evolve(bench, mesh, stem, *arguments):
    """What ccst_paper_evolution reports; its pictures are work/STEM-*.png."""
    out, _ = bench.run(
        "ccst_paper_evolution", mesh, "--pictures", bench.work / f"{stem}-", *arguments
    )
    return json.loads(out)


def figure_2(bench):
    """Sample meshes before and after one geometry phase, without flips."""
    figure = Figure("figure-2", "Figure 2: the geometry phase")
    figure.header = ["model", "capacity cv before", "after", "passes"]
    _, axes = plt.subplots(1, 4, figsize=(16, 5))
    for column, (model, name) in enumerate(NAMES.items()):
        report = evolve(
            bench, bench.model(model), name, "--count", bench.count(5000), "--phases", 1,
            "--picture-at", "0,1", "--picture-before-flips",
        )
        for k, (suffix, moment) in enumerate([("0", "initial"), ("1-moved", "after one phase")]):
            show(axes[2 * column + k], panels(bench.work / f"{name}-{suffix}.png")[1],
                 f"{name}, {moment}")
        moved = [row for row in report["rows"] if row["phase"] == 1 and row["pass"] > 0]
        figure.rows.append([name, f"{report['rows'][0]['cv']:.3f}", f"{moved[-1]['cv']:.3f}",
                            len(moved)])
    figure.images.append(bench.save("figure-2.png"))
    figure.text.append(
        "5000 samples of white noise, connected by construction, and the same after one geometry "
        "phase: areas become even, triangles long and thin where the connectivity does not fit. "
        "As in the paper."
    )
    return figure


def _plot_energy(axes, rows, key, label):
    """The energy over the passes; stars where flips changed the connectivity."""
    axes.plot([row[key] for row in rows], lw=1, label=label)
    flips = [i for i, row in enumerate(rows) if row["pass"] < 0]
    axes.plot(flips, [rows[i][key] for i in flips], "r*", ms=7)


def figure_3(bench):
    """The paper's loop, and below it what the command does."""
    figure = Figure("figure-3", "Figure 3: evolution")
    mesh, count = bench.model("paper/kitten_9756.off"), bench.count(5000)
    phases = 3 if bench.quick else 8
    moments = [0, 1, 2, phases]
    report = evolve(
        bench, mesh, "evolution", "--count", count, "--phases", phases,
        "--picture-at", ",".join(map(str, moments)),
    )
    _, axes = plt.subplots(2, 4, figsize=(14, 8))
    for column, phase in enumerate(moments):
        show_halves(axes[0, column], axes[1, column], bench.work / f"evolution-{phase}.png",
                    "start" if phase == 0 else f"after {phase} alternation{'s' * (phase > 1)}")
    figure.images.append(bench.save("figure-3.png"))

    command = bench.sample(mesh, count, "evolution-command")
    _, (left, right) = plt.subplots(1, 2, figsize=(13, 4))
    rows = report["rows"]
    _plot_energy(left, rows, "target", "variance about the target")
    left.set_yscale("log")
    left.set_xlabel("pass; stars: edges flipped")
    left.set_title("the paper's loop: passes to rest, then flips", fontsize=10)
    left.legend()
    progress = command["progress"]
    right.plot([p["iteration"] for p in progress], [p["energy"] for p in progress], lw=1)
    moved = [p for p in progress if p["relocations"] > 0]
    right.plot([p["iteration"] for p in moved], [p["energy"] for p in moved], "bv", ms=5,
               label="samples relocated")
    right.set_yscale("log")
    right.set_xlabel("alternation of three passes, flips after each")
    right.set_title("ccst sample", fontsize=10)
    right.legend()
    figure.images.append(bench.save("figure-3-energy.png"))
    passes = sum(row["pass"] > 0 for row in rows)
    figure.header = ["", "passes", "edges flipped", "capacity cv", "radius", "smallest angle"]
    final = report["figures"]
    figure.rows = [
        ["the paper's loop", passes, sum(row["flips"] for row in rows), f"{final['cv']:.3f}",
         f"{final['radius']:.3f}", f"{final['min_angle']:.1f}"],
        ["ccst sample", command["passes"], sum(p["flips"] for p in progress),
         f"{command['capacity_cv']:.3f}", f"{command['relative_radius']:.3f}", ""],
    ]
    figure.text.append(
        "The energy falls within every phase and rises at every flip (stars), each rise smaller "
        "than the last: as in the paper. The energy needs more passes than the ten that the paper "
        "names until it rests in a phase; the first are cut off."
    )
    return figure


def figure_7(bench):
    """Starts of three kinds, and what becomes of them."""
    figure = Figure("figure-7", "Figure 7: different starts")
    figure.header = ["start", "capacity cv", "radius", "mean nearest", "smallest angle",
                     "valence 5 to 7"]
    starts = {"white": "white noise", "uneven": "four times denser on the right",
              "strata": "one in each stratum (ccst)"}
    mesh = bench.model("paper/kitten_9756.off")
    phases = 2 if bench.quick else 8
    curves = {}
    _, axes = plt.subplots(2, 3, figsize=(11, 8))
    for column, (points, title) in enumerate(starts.items()):
        stem = f"start-{points}"
        report = evolve(
            bench, mesh, stem, "--points", points, "--count", bench.count(1700), "--phases", phases,
            "--picture-at", f"0,{phases}",
        )
        show(axes[0, column], panels(bench.work / f"{stem}-0.png")[0], title)
        show(axes[1, column], panels(bench.work / f"{stem}-{phases}.png")[0])
        curves[title] = f = report["figures"]
        figure.rows.append([title, f"{f['cv']:.3f}", f"{f['radius']:.3f}", f"{f['nearest']:.3f}",
                            f"{f['min_angle']:.1f}", f"{100 * f['valence_5_7']:.1f} %"])
    figure.images.append(bench.save("figure-7.png"))
    _, axes = plt.subplots(1, 2, figsize=(11, 3.5))
    plot_differentials(axes, curves)
    figure.images.append(bench.save("figure-7-differentials.png"))
    figure.text.append(
        f"Three starts and what {phases} phases of the paper's loop make of each. White noise and "
        "one sample in each stratum end alike, as in the paper. Four times as many samples on one "
        "side do not: moves and flips are local, so what is uneven on the largest scale evens out "
        "last, and leaves a lower first peak."
    )
    return figure
