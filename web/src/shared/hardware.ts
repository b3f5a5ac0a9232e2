import type { WorldStateT } from '../protocol';

/** Whether the device is a real one. Only a simulated one reports what its virtual patient intends. */
export function hasHardware(state: Pick<WorldStateT, 'qM' | 'intention'> | null): boolean {
  return state !== null && state.qM.length > 0 && !state.intention.some(Number.isFinite);
}
