"""Figure 6: planar samples against unrolled ones of a cylinder and a cone, by Ulichney's spectra."""

import matplotlib.pyplot as plt
import numpy as np

import shapes
from harness import Figure, read_points

HALF_RING = np.pi  # A cone of half angle 30 degrees unrolls to half a turn.


def _square(points, left, bottom, side):
    """Points of a window, scaled to the unit square."""
    p = (points - [left, bottom]) / side
    return p[((p >= 0) & (p < 1)).all(axis=1)]


def plane_window(p):
    return _square(p[:, :2], 0.2, 0.2, 1.6)


def cylinder_window(p):
    angle = np.arctan2(p[:, 1], p[:, 0]) % (2 * np.pi)
    return _square(np.column_stack([4 * angle / (2 * np.pi), p[:, 2]]), 1.0, 0.2, 1.6)


def cone_window(p):
    slant = np.linalg.norm(p, axis=1)
    turn = (np.arctan2(p[:, 1], p[:, 0]) % (2 * np.pi)) / (2 * np.pi) * HALF_RING
    flat = np.column_stack([slant * np.cos(turn), slant * np.sin(turn)])
    return _square(flat, -0.65, 0.4, 1.3)


# Name: mesh, its area over the window's, the window.
SURFACES = {
    "plane (CCDT)": (lambda: shapes.plane(2.0, 2.0), 4.0 / 1.6**2, plane_window),
    "cylinder, unrolled": (lambda: shapes.cylinder(4.0, 2.0), 8.0 / 1.6**2, cylinder_window),
    "cone, unrolled": (lambda: shapes.cone(0.2, 2.0), np.pi / 2 * 3.96 / 1.3**2, cone_window),
}


def periodogram(points, reach):
    """|sum exp(-2 pi i k p)|^2 / N at the whole k of [-reach, reach]^2; on these the window's own
    transform vanishes, but at 0."""
    k = np.arange(-reach, reach + 1)
    x = np.exp(-2j * np.pi * np.outer(k, points[:, 0]))
    y = np.exp(-2j * np.pi * np.outer(k, points[:, 1]))
    return np.abs(x @ y.T) ** 2 / len(points)


def radial_figures(periodograms, reach):
    """Frequencies, radially averaged power and anisotropy in dB, after Ulichney: the spectrum is
    estimated by the mean periodogram; variance over squared mean along each ring."""
    mean = np.mean(periodograms, axis=0)
    k = np.arange(-reach, reach + 1)
    ring = np.rint(np.hypot(*np.meshgrid(k, k))).astype(int)
    frequencies = np.arange(2, reach + 1)
    power = np.array([mean[ring == f].mean() for f in frequencies])
    spread = np.array([mean[ring == f].var(ddof=1) for f in frequencies])
    return frequencies, power, 10 * np.log10(np.maximum(spread / power**2, 1e-3))


def figure_6(bench):
    figure = Figure("figure-6", "Figure 6: developable surfaces")
    figure.header = ["surface", "samples in the window", "peak of the power", "at", "power below half the "
                     "peak's frequency", "mean anisotropy"]
    sets, wanted = (2, 300) if bench.quick else (8, 1000)
    _, axes = plt.subplots(3, 4, figsize=(15, 10))
    for row, (name, (mesh, share, window)) in zip(axes, SURFACES.items()):
        stem = name.split()[0].strip(",")
        path = shapes.write_off(bench.work / f"{stem}.off", mesh())
        windows = []
        for seed in range(1, sets + 1):
            summary = bench.sample(path, round(wanted * share), f"{stem}-{seed}", "--seed", seed)
            windows.append(window(read_points(f"{summary['stem']}.csv")))
        reach = round(3 * np.sqrt(wanted))
        spectra = [periodogram(p, reach) for p in windows]
        f, power, anisotropy = radial_figures(spectra, reach)
        f = f / np.sqrt(wanted)
        row[0].plot(*windows[0].T, "k.", ms=2)
        row[0].set_aspect("equal")
        row[0].set_title(name, fontsize=10)
        row[0].set_axis_off()
        row[1].imshow(np.mean(spectra, axis=0), cmap="gray", vmin=0, vmax=3)
        row[1].set_axis_off()
        row[1].set_title("mean periodogram", fontsize=10)
        row[2].plot(f, power, lw=1)
        row[2].axhline(1, color="0.7", lw=0.5)
        row[2].set_title("radially averaged power", fontsize=10)
        row[3].plot(f, anisotropy, lw=1)
        row[3].axhline(-10 * np.log10(sets), color="0.7", lw=0.5)
        row[3].set_ylim(-20, 5)
        row[3].set_title("anisotropy [dB]", fontsize=10)
        for ax in row[2:]:
            ax.set_xlabel("frequency / sqrt(n)")
        peak = np.argmax(power)
        low = power[f < 0.5 * f[peak]].mean()
        figure.rows.append([name, round(np.mean([len(p) for p in windows])), f"{power[peak]:.2f}",
                            f"{f[peak]:.2f}", f"{low:.3f}", f"{anisotropy.mean():.1f} dB"])
    plt.tight_layout()
    figure.images.append(bench.save("figure-6.png", dpi=90))
    figure.text.append(
        f"{sets} sets each, in a square window far from the boundaries. The spectra of the plane, "
        "which is CCDT, of the cylinder and of the cone are one: the same empty low frequencies, "
        "the same peak, the anisotropy at the level of isotropic sets (grey line). As in the paper."
    )
    return figure
