// Differences between two recordings that make some of their values incomparable. No elements.
import type { RecordingInfo } from './about';

export type Difference = 'patient' | 'hand' | 'device' | 'exercise';

/** The same exercise at another level counts as another exercise. */
export function differencesBetween(a: RecordingInfo, b: RecordingInfo): Difference[] {
  return (['patient', 'hand', 'device', 'exercise'] as const).filter((key) => a[key] !== b[key]
    || (key === 'exercise' && a.level !== b.level) || (key === 'patient' && a.profile !== b.profile));
}

/** Names of the axes that only one of the two recordings has. */
export function axesOfOne(a: readonly { readonly name: unknown }[], b: readonly { readonly name: unknown }[]): string[] {
  const [in_a, in_b] = [a, b].map((axes) => new Set(axes.map(({ name }) => String(name))));
  return [...new Set([...in_a, ...in_b])].filter((name) => !in_a.has(name) || !in_b.has(name));
}
