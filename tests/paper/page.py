"""Makes all figures of the paper and one page of them; see README.md.

usage: page.py [--quick] [--only NAME,...] [--output DIR]
"""

import argparse
import html
import sys
import time
from pathlib import Path

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parent))
from crust import crust_start  # noqa: E402
from densities import figure_4, figure_8  # noqa: E402
from developable import figure_6  # noqa: E402
from differentials import figure_5  # noqa: E402
from energies import two_energies  # noqa: E402
from geometry import figure_2, figure_3, figure_7  # noqa: E402
from harness import ROOT, Bench, Figure, Skipped, say  # noqa: E402
from timing import section_5_6  # noqa: E402

MAKERS = [figure_2, figure_3, figure_4, figure_5, figure_6, figure_7, figure_8, section_5_6,
          two_energies, crust_start]

STYLE = """
body { font: 15px/1.45 sans-serif; max-width: 1200px; margin: 2em auto; padding: 0 1em; }
img { max-width: 100%; display: block; margin: 0.5em 0; }
table { border-collapse: collapse; margin: 0.5em 0; }
th, td { border-bottom: 1px solid #ccc; padding: 2px 12px 2px 0; text-align: left; }
"""


def table(figure):
    if not figure.rows:
        return ""
    cells = lambda tag, row: "".join(f"<{tag}>{html.escape(str(x))}</{tag}>" for x in row)  # noqa
    lines = [f"<tr>{cells('td', row)}</tr>" for row in figure.rows]
    return f"<table><tr>{cells('th', figure.header)}</tr>{''.join(lines)}</table>"


def section(figure):
    parts = [f'<h2 id="{figure.name}">{html.escape(figure.title)}</h2>']
    parts += [f"<p>{html.escape(text)}</p>" for text in figure.text]
    parts += [f'<img src="{image}" alt="{html.escape(figure.title)}">' for image in figure.images]
    return "\n".join([*parts, table(figure)])


def main():
    parser = argparse.ArgumentParser(description="The figures of the CCST paper")
    parser.add_argument("--quick", action="store_true", help="few samples of a mesh made by code")
    parser.add_argument("--only", default="", help="names of makers, for example figure_3,figure_6")
    parser.add_argument("--output", default=ROOT / "build/paper")
    options = parser.parse_args()
    known = {maker.__name__: maker for maker in MAKERS}
    names = options.only.split(",") if options.only else list(known)
    if unknown := [name for name in names if name not in known]:
        parser.error(f"no figure {unknown[0]}; there are {' '.join(known)}")

    bench = Bench(options.output, options.quick)
    figures = []
    skipped = 0
    for name in names:
        start = time.monotonic()
        try:
            made = known[name](bench)
        except Skipped as reason:
            say(f"{name}: SKIPPED: {reason}")
            made = Figure(name, f"{name.replace('_', ' ')}: skipped", text=[str(reason)])
            skipped += 1
        figures += made if isinstance(made, list) else [made]
        say(f"{name}: {time.monotonic() - start:.1f} s")
    page = bench.output / "index.html"
    page.write_text(
        f"<!doctype html><html lang=en><meta charset=utf-8><title>The figures of the CCST paper"
        f"</title><style>{STYLE}</style><h1>The figures of the CCST paper, by ccst</h1>\n"
        + "\n".join(map(section, figures)) + "\n</html>\n"
    )
    print(f"{page}: {len(figures) - skipped} sections, {skipped} skipped")


if __name__ == "__main__":
    main()
