// Viridis at nine places: light grows with the value, also for eyes that see fewer colours.
const STOPS = [
  [0.267, 0.005, 0.329],
  [0.283, 0.141, 0.458],
  [0.254, 0.265, 0.53],
  [0.207, 0.372, 0.553],
  [0.164, 0.471, 0.558],
  [0.128, 0.567, 0.551],
  [0.267, 0.679, 0.481],
  [0.478, 0.821, 0.318],
  [0.993, 0.906, 0.144],
];
const UNKNOWN = [0.5, 0.5, 0.5];

/** The colour of `share`, clamped to [0, 1], as three numbers in [0, 1]; grey for NaN. */
export function colourOf(share: number): number[] {
  if (Number.isNaN(share)) return UNKNOWN;
  const place = Math.min(1, Math.max(0, share)) * (STOPS.length - 1);
  const below = Math.min(STOPS.length - 2, Math.floor(place));
  const part = place - below;
  return (STOPS[below] ?? UNKNOWN).map((c, k) => c + part * ((STOPS[below + 1]?.[k] ?? c) - c));
}

/** N colours, N x 3, of values between `low` and `high`. */
export function coloursOf(values: Float32Array, low: number, high: number): Float32Array {
  const colours = new Float32Array(3 * values.length);
  for (let i = 0; i < values.length; ++i) {
    colours.set(colourOf(((values[i] ?? NaN) - low) / (high - low)), 3 * i);
  }
  return colours;
}

/** The colour map as a CSS gradient, for legends. */
export const GRADIENT = `linear-gradient(to right, ${STOPS.map(
  (stop) => `rgb(${stop.map((c) => Math.round(255 * c)).join(' ')})`,
).join(', ')})`;
