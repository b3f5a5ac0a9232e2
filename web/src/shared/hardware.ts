import type { WorldStateT } from '../protocol';

/** Whether the device is real. Only a simulated one reports its virtual patient's intention. */
export function hasHardware(state: Pick<WorldStateT, 'qM' | 'intention'> | null): boolean {
  return state !== null && state.qM.length > 0 && !state.intention.some(Number.isFinite);
}
