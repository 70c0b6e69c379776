"""Figures 4 and 8: samples that follow curvature, and samples that draw an image."""

import matplotlib.pyplot as plt
import numpy as np

from harness import Figure, panels, show, show_halves
from shapes import write_textured_sphere


def figure_4(bench):
    figure = Figure("figure-4", "Figure 4: curvature")
    figure.header = ["model", "capacity cv", "radius, over the local spacing", "alternations"]
    models = {"": "blob"} if bench.quick else {
        "paper/bunny_6289.off": "bunny", "paper/kitten_9756.off": "kitten"}
    _, axes = plt.subplots(1, 2 * len(models), figsize=(8 * len(models), 5))
    for k, (model, name) in enumerate(models.items()):
        summary = bench.sample(bench.model(model), bench.count(10000), f"curvature-{name}",
                               "--density", "curvature", picture=True)
        show_halves(axes[2 * k], axes[2 * k + 1], f"{summary['stem']}.png", name)
        figure.rows.append([name, f"{summary['capacity_cv']:.3f}",
                            f"{summary['relative_radius']:.3f}", summary["alternations"]])
    figure.images.append(bench.save("figure-4.png"))
    figure.text.append(
        "10,000 samples, the density the square root of the absolute Gaussian curvature, as in the "
        "paper. Here the largest density is at most 100 times the smallest, so that flat places "
        "keep some samples."
    )
    return figure


def _image(path):
    """A grey picture for the sphere: a sun, dark as ink, over waves, where the camera looks."""
    u, v = np.meshgrid(np.linspace(0, 1, 512), np.linspace(1, 0, 256))
    sun = np.clip((np.hypot(2 * (u - 0.80), v - 0.68) - 0.13) * 60, 0, 1)
    waves = 0.5 + 0.5 * np.sin(60 * (v + 0.03 * np.sin(6 * np.pi * u)))
    grey = np.where(v < 0.45, 0.15 + 0.8 * waves, 0.25 + 0.5 * sun)
    plt.imsave(path, grey, cmap="gray", vmin=0, vmax=1)
    return path


def figure_8(bench):
    figure = Figure("figure-8", "Figure 8: halftones")
    figure.header = ["surface", "samples", "capacity cv", "alternations"]
    sphere = write_textured_sphere(bench.work / "sphere.obj")
    subjects = [("sphere made by code", sphere, _image(bench.work / "sphere.png"))]
    if not bench.quick:
        folder = bench.model("textured/spot/spot_triangulated.obj").parent
        subjects.append(("spot", folder / "spot_triangulated.obj", folder / "spot_texture.png"))
    _, axes = plt.subplots(1, len(subjects), figsize=(7 * len(subjects), 7), squeeze=False)
    for ax, (name, mesh, image) in zip(axes[0], subjects):
        count = bench.count(20000)
        summary = bench.sample(mesh, count, f"halftone-{name.split()[0]}",
                               "--density", f"texture:{image}", picture=True)
        show(ax, panels(f"{summary['stem']}.png")[0], name)
        figure.rows.append([name, count, f"{summary['capacity_cv']:.3f}", summary["alternations"]])
    figure.images.append(bench.save("figure-8.png"))
    figure.text.append("The grey values of a texture are the density; dark places are dense.")
    return figure
