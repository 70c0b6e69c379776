"""One page that opens anywhere, of what was measured: log-log plots with slopes, and tables."""

import html
import io
import math

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

from limits import machine_table, pass_table  # noqa: E402
from programs import PHASES, number  # noqa: E402

STYLE = """
body { font: 15px/1.45 sans-serif; max-width: 1300px; margin: 2em auto; padding: 0 1em; }
svg { max-width: 100%; height: auto; }
table { border-collapse: collapse; margin: 0.5em 0; }
th, td { border-bottom: 1px solid #ccc; padding: 2px 14px 2px 0; text-align: right; }
th:first-child, td:first-child { text-align: left; }
"""

# Below this the clock and the start of the program are most of it.
LEAST_SECONDS = 1e-3


def slope(xs, ys):
    """Exponent b of the least-squares fit y = a x^b; None of fewer than two different x."""
    points = [(math.log(x), math.log(y)) for x, y in zip(xs, ys) if x > 0 and y > 0]
    mean_x = sum(x for x, _ in points) / max(len(points), 1)
    mean_y = sum(y for _, y in points) / max(len(points), 1)
    spread = sum((x - mean_x) ** 2 for x, _ in points)
    if spread == 0:
        return None
    return sum((x - mean_x) * (y - mean_y) for x, y in points) / spread


def plot(title, xlabel, ylabel, curves, least=0.0):
    """SVG of {name: (xs, ys)}; slopes of what is not under `least` go into the legend."""
    figure, axes = plt.subplots(figsize=(8, 4.5))
    for name, (xs, ys) in curves.items():
        kept = [(x, y) for x, y in zip(xs, ys) if y >= least]
        fitted = slope(*zip(*kept)) if len(kept) > 1 else None
        label = name if fitted is None else f"{name}, slope {fitted:.2f}"
        shown = [(x, y) for x, y in zip(xs, ys) if y > 0]
        if shown:
            axes.loglog(*zip(*shown), "o-", label=label)
    axes.set(title=title, xlabel=xlabel, ylabel=ylabel)
    axes.grid(True, which="major", alpha=0.3)
    axes.legend(fontsize=8)
    text = io.StringIO()
    figure.savefig(text, format="svg", bbox_inches="tight")
    plt.close(figure)
    svg = text.getvalue()
    return svg[svg.index("<svg"):]


def table(header, rows):
    cells = lambda tag, row: "".join(f"<{tag}>{html.escape(str(x))}</{tag}>" for x in row)  # noqa
    body = "".join(f"<tr>{cells('td', row)}</tr>" for row in rows)
    return f"<table><tr>{cells('th', header)}</tr>{body}</table>"


def sweep(title, rows, key, xlabel):
    """Plots and table of a sweep over `key` of the jobs."""
    single = [row for row in rows if row["threads"] == 1] or rows
    xs = [row[key] for row in single]
    curves = {phase: (xs, [row["processor"][phase] for row in single])
              for phase in [*PHASES, "total"]}
    parts = [f"<h2>{html.escape(title)}</h2>",
             plot("Processor time, one thread", xlabel, "seconds", curves, LEAST_SECONDS),
             plot("Peak memory", xlabel, "MiB",
                  {"peak of the job": (xs, [row["peak_mib"] for row in single])})]
    header = ["samples", "faces", "threads", "runs", *PHASES, "total [s]",
              "processor [s]", "alternations", "passes", "samples swept a second",
              "peak [MiB]"]
    lines = []
    for row in rows:
        seconds = [number(row["seconds"].get(phase, 0.0)) for phase in [*PHASES, "total"]]
        lines.append([number(row["count"]), number(row["faces"]), row["threads"], row["runs"],
                      *seconds, number(row["processor"]["total"]), row["alternations"],
                      row["passes"], number(row["samples_swept_per_second"]),
                      number(row["peak_mib"])])
    return "\n".join([*parts, table(header, lines)])


def parts(rows):
    lines = [[row["name"], number(1e6 * row["seconds"]), number(row["items_per_second"])]
             for row in rows]
    return "<h2>Parts</h2>" + table(["part", "microseconds", "items a second"], lines)


def write_page(path, results):
    """One self-contained HTML file of the sections that `results` has."""
    body = [f"<p>{html.escape(results['about'])}</p>"]
    if results.get("by_count"):
        body.append(sweep("Against the number of samples", results["by_count"], "count", "samples"))
    if results.get("by_faces"):
        body.append(sweep("Against the size of the surface", results["by_faces"], "faces", "faces"))
    if results.get("instructions"):
        rows = [[phase, number(count)] for phase, count in results["instructions"].items()]
        body.append("<h2>Instructions a sample</h2>" + table(["phase", "instructions"], rows))
    counters = results.get("counters")
    if isinstance(counters, dict):
        rows = [[name, number(count)] for name, count in counters.items()]
        body.append("<h2>Counters of the processor, a sample</h2>" + table(["", ""], rows))
    elif counters:
        body.append(f"<h2>Counters of the processor</h2><p>None: {html.escape(counters)}.</p>")
    if results.get("pass"):
        body.append("<h2>What limits a geometry pass, an update</h2>"
                    + table(*pass_table(results["pass"])))
        body.append("<h3>The machine</h3>" + table(["", ""], machine_table(results["machine"])))
    if results.get("parts"):
        body.append(parts(results["parts"]))
    path.write_text("<!doctype html>\n<meta charset='utf-8'>\n<title>ccst benchmarks</title>\n"
                    f"<style>{STYLE}</style>\n<h1>ccst benchmarks</h1>\n" + "\n".join(body) + "\n")
