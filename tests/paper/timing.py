"""Section 5.6: time against the number of samples."""

import matplotlib.pyplot as plt
import numpy as np

from harness import Figure

METHODS = {"ccst": "CCST", "poisson": "Poisson disk", "lloyd": "Lloyd"}


def section_5_6(bench):
    figure = Figure("section-5-6", "Section 5.6: time")
    figure.header = ["method", "samples", "processor seconds", "alternations or steps",
                     "microseconds a sample"]
    mesh = bench.model("paper/bunny_6289.off")
    slopes = []
    for method, title in METHODS.items():
        counts = [200, 400] if bench.quick else [1000, 3000, 10000, 30000, 100000]
        if method != "ccst":
            counts = counts[:4]
        seconds = []
        for count in counts:
            options = [] if method == "ccst" else ["--method", method]
            summary = bench.sample(mesh, count, f"time-{method}-{count}", *options)
            seconds.append(summary["cpu_seconds"])
            figure.rows.append([title, count, f"{seconds[-1]:.2f}", summary["alternations"] or "-",
                                f"{1e6 * seconds[-1] / count:.0f}"])
        large = slice(-2 if bench.quick else counts.index(10000), None)
        slope = np.polyfit(np.log(counts[large]), np.log(seconds[large]), 1)[0]
        slopes.append(f"{title} {slope:.2f}")
        plt.loglog(counts, seconds, "o-", label=f"{title}, slope {slope:.2f}")
    plt.gcf().set_size_inches(7, 4.5)
    plt.xlabel("samples")
    plt.ylabel("processor seconds, one thread")
    plt.legend()
    figure.images.append(bench.save("section-5-6.png"))
    figure.text.append(
        "Processor time of one run on one thread, reading the mesh and writing the samples "
        f"included. Slopes of the log-log lines from 10,000 samples on: {', '.join(slopes)}. The paper "
        "says O(n) for the geometry phase, which dominates. Of few samples the fixed work is most, "
        "and where they hardly resolve the surface it takes more alternations."
    )
    return figure
