"""Figure 5: differential domain analysis of CCST, Lloyd's relaxation and Poisson disks."""

import json

import matplotlib.pyplot as plt
import numpy as np

from harness import Figure

METHODS = {"ccst": "CCST", "lloyd": "Lloyd", "poisson": "Poisson disk"}
MODELS = {"paper/bunny_6289.off": "bunny", "paper/kitten_9756.off": "kitten"}
REACH = 4.0  # Spacings that the plots show.


def plot_differentials(axes, curves):
    """Radial means and anisotropies into two axes; `curves` by label."""
    for label, figures in curves.items():
        for ax, key in zip(axes, ["radial_mean", "anisotropy"]):
            x, y = (np.array(figures[key][k]) for k in "xy")
            ax.plot(x[x < REACH], y[x < REACH], lw=1, label=label)
    axes[0].set_ylabel("radial mean")
    axes[1].set_ylabel("anisotropy [dB]")
    axes[1].set_ylim(-15, 15)
    for ax in axes:
        ax.set_xlim(0, REACH)
        ax.set_xlabel("distance [r_max]")
        ax.legend(fontsize=8)


def figure_5(bench):
    figure = Figure("figure-5", "Figure 5: differential domain analysis")
    figure.header = ["model", "method", "radius", "mean nearest", "first peak", "at"]
    models = {"": "blob"} if bench.quick else MODELS
    sets = 2 if bench.quick else 8
    _, axes = plt.subplots(len(models), 2, figsize=(12, 3.6 * len(models)), squeeze=False)
    for row, (model, name) in zip(axes, models.items()):
        curves = {}
        for method, title in METHODS.items():
            out, _ = bench.run("ccst_paper_differentials", bench.model(model), "--method", method,
                               "--count", bench.count(1700), "--sets", sets)
            curves[title] = figures = json.loads(out)
            x, y = (np.array(figures["radial_mean"][k]) for k in "xy")
            peak = np.argmax(y)
            figure.rows.append([name, title, f"{figures['radius']:.3f}",
                                f"{figures['nearest']:.3f}", f"{y[peak]:.2f}", f"{x[peak]:.2f}"])
        plot_differentials(row, curves)
        row[0].set_title(name, fontsize=10)
    plt.tight_layout()
    figure.images.append(bench.save("figure-5.png"))
    figure.text.append(
        f"{sets} sets of {bench.count(1700)} samples each. All have the empty disk of blue "
        "noise. After its first peak CCST rings less than Lloyd's relaxation, which is nearer to a "
        "crystal, and more than Poisson disks, which are the least regular. No method prefers a direction: the "
        f"anisotropy stays at {-10 * np.log10(sets):.0f} dB, what {sets} isotropic sets show."
    )
    return figure
