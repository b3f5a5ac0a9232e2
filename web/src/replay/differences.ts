// In what two recordings differ, so that not all of one can be compared with the other. No elements.
import type { About } from './about';

export type Difference = 'patient' | 'hand' | 'device' | 'exercise';

/** An exercise of another level is another one. */
export function differencesBetween(a: About, b: About): Difference[] {
  return (['patient', 'hand', 'device', 'exercise'] as const).filter((key) => a[key] !== b[key]
    || (key === 'exercise' && a.level !== b.level) || (key === 'patient' && a.profile !== b.profile));
}

/** Names of the axes that only one of two recordings has. */
export function axesOfOne(a: readonly { readonly name: unknown }[], b: readonly { readonly name: unknown }[]): string[] {
  const [in_a, in_b] = [a, b].map((axes) => new Set(axes.map(({ name }) => String(name))));
  return [...new Set([...in_a, ...in_b])].filter((name) => !in_a.has(name) || !in_b.has(name));
}
