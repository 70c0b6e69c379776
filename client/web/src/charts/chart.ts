import uPlot from 'uplot';
import 'uplot/dist/uPlot.min.css';

/** One line, or row of bars, of a chart. */
export interface ChartSeries {
  label: string;
  /** Name of a colour of the page, as `--chart-1`. */
  colour: string;
  /** Bars have an axis of their own on the right. */
  bars?: boolean;
}

export interface ChartOptions {
  title: string;
  xLabel: string;
  series: ChartSeries[];
  logarithmic?: boolean;
}

/** Curves over one axis: every x of any of them, null where a curve has no value. */
export function onOneAxis(curves: { x: number[]; y: number[] }[]): {
  x: number[];
  ys: (number | null)[][];
} {
  const x = [...new Set(curves.flatMap((curve) => curve.x))].sort((a, b) => a - b);
  const ys = curves.map((curve) => {
    const byX = new Map(curve.x.map((place, i) => [place, curve.y[i] ?? null]));
    return x.map((place) => byX.get(place) ?? null);
  });
  return { x, ys };
}

/** A line chart that grows; its name says its last numbers to those who do not see it. */
export class Chart {
  private readonly plot: uPlot;
  private readonly sizes: ResizeObserver;
  private readonly scheme = matchMedia('(prefers-color-scheme: dark)');
  private frame = 0;
  private data: uPlot.AlignedData = [[]];

  constructor(
    private readonly box: HTMLElement,
    private readonly options: ChartOptions,
  ) {
    box.setAttribute('role', 'img');
    this.plot = new uPlot(this.uplotOptions(), [[], ...options.series.map(() => [])], box);
    this.sizes = new ResizeObserver(() => this.resize());
    this.sizes.observe(box);
    this.scheme.addEventListener('change', this.redraw);
    document.addEventListener('themechange', this.redraw);
    this.setData([], options.series.map(() => []));
  }

  /** Shows the series over `x`; arrays may be those of before, longer. */
  setData(x: number[], series: (number | null)[][]): void {
    this.box.dataset['points'] = String(x.length);
    const last = series[0]?.at(-1);
    this.box.setAttribute(
      'aria-label',
      x.length === 0
        ? `${this.options.title}: nothing yet`
        : `${this.options.title}: ${x.length} points, the last ${last?.toPrecision(3)} at ${x.at(-1)}`,
    );
    this.data = [x, ...series] as uPlot.AlignedData;
    // Once a frame at most, however fast reports come.
    this.frame ||= requestAnimationFrame(() => {
      this.frame = 0;
      this.plot.setData(this.data);
    });
  }

  readonly redraw = (): void => this.plot.redraw(false, true);

  destroy(): void {
    cancelAnimationFrame(this.frame);
    this.scheme.removeEventListener('change', this.redraw);
    document.removeEventListener('themechange', this.redraw);
    this.sizes.disconnect();
    this.plot.destroy();
  }

  private colour(name: string): string {
    return getComputedStyle(this.box).getPropertyValue(name).trim();
  }

  private resize(): void {
    const { clientWidth: width, clientHeight: height } = this.box;
    if (width === 0 || height === 0) return;
    this.plot.setSize({ width, height: this.plot.height });
    // How many lines the legend takes follows from the width, which the plot sets in a microtask.
    queueMicrotask(() => this.plot.setSize({ width, height: height - this.legendHeight() }));
  }

  private legendHeight(): number {
    return this.box.querySelector<HTMLElement>('.u-legend')?.offsetHeight ?? 0;
  }

  private uplotOptions(): uPlot.Options {
    const axis = (more: uPlot.Axis): uPlot.Axis => ({
      stroke: () => this.colour('--text-2'),
      grid: { stroke: () => this.colour('--line'), width: 1 },
      ticks: { show: false },
      font: '11px system-ui, sans-serif',
      size: 44,
      ...more,
    });
    const bars = this.options.series.some((s) => s.bars);
    return {
      width: 300,
      height: 160,
      padding: [8, bars ? 0 : 12, 0, 0],
      cursor: { y: false, points: { size: 6 } },
      legend: { live: true },
      scales: {
        x: { time: false },
        y: this.options.logarithmic ? { distr: 3 } : {},
        bars: { range: (_plot, _low, high) => [0, Math.max(1, 3 * high)] },
      },
      axes: [
        axis({ size: 26 }),
        axis({ values: (_plot, ticks) => ticks.map((t) => (t === null ? '' : compact(t))) }),
        ...(bars ? [axis({ scale: 'bars', side: 1, grid: { show: false } })] : []),
      ],
      series: [
        { label: this.options.xLabel },
        ...this.options.series.map((series): uPlot.Series => {
          const stroke = () => this.colour(series.colour);
          const value = (_plot: uPlot, v: number | null) => (v === null ? '–' : compact(v));
          if (!series.bars) {
            return { label: series.label, stroke, width: 2, value, spanGaps: true, points: { show: false } };
          }
          const paths = uPlot.paths.bars?.({ size: [0.7, 12] });
          return {
            label: series.label,
            scale: 'bars',
            fill: stroke,
            stroke,
            width: 0,
            value,
            points: { show: false },
            ...(paths ? { paths } : {}),
          };
        }),
      ],
    };
  }
}

function compact(value: number): string {
  if (value !== 0 && (Math.abs(value) < 1e-3 || Math.abs(value) >= 1e5)) return value.toExponential(0);
  return String(Number(value.toPrecision(3)));
}
