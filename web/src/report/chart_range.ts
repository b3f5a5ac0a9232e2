export interface ChartLine { readonly name: string; readonly color: string; readonly dash?: readonly number[]; readonly width?: number; readonly values: ArrayLike<number> }

/** All values with some room, and what is to be held at least; one end at zero where all values lie on its side. */
export function rangeOf(lines: readonly ChartLine[], holds: readonly [number, number] = [Infinity, -Infinity]): [number, number] {
  let [low, high] = holds;
  for (const { values } of lines) {
    for (let i = 0; i < values.length; i += 1) {
      if (values[i] < low) low = values[i];
      if (values[i] > high) high = values[i];
    }
  }
  if (!(low <= high)) return [0, 1];
  const room = 0.06 * (high - low) || 0.5;
  return [low < 0 || low > 0 ? low - room : 0, high + room];
}
