import { Chart } from '../charts/chart';
import type { RunHistory } from '../job/run_history';
import { find } from '../ui/dom';

/** How even the capacities are and what is minimised, an alternation each; bars mark edge flips. */
export class RunCharts {
  private readonly variation: Chart;
  private readonly energy: Chart;

  constructor(private readonly box: HTMLElement) {
    box.innerHTML = `<h2>Variation of capacities</h2><div class="chart variation"></div>
      <h2>Energy <span class="quiet">and edge flips</span></h2><div class="chart energy"></div>`;
    this.variation = new Chart(find(box, '.variation'), {
      title: 'Variation of capacities by alternation',
      xLabel: 'alternation',
      logarithmic: true,
      series: [{ label: 'variation', colour: '--chart-1' }],
    });
    this.energy = new Chart(find(box, '.energy'), {
      title: 'Energy by alternation',
      xLabel: 'alternation',
      logarithmic: true,
      series: [
        { label: 'energy', colour: '--chart-2' },
        { label: 'flips', colour: '--chart-3', bars: true },
      ],
    });
  }

  show(history: RunHistory): void {
    // A logarithm has no place for zero.
    const positive = (values: number[]) => values.map((v) => (v > 0 ? v : null));
    this.variation.setData(history.iterations, [positive(history.capacityCvs)]);
    this.energy.setData(history.iterations, [positive(history.energies), history.flips]);
  }

  destroy(): void {
    this.variation.destroy();
    this.energy.destroy();
    this.box.replaceChildren();
  }
}
