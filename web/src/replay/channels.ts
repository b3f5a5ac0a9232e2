import { displayUnits } from '../console/history';
import type { StoredSeries } from '../console/plot_source';
import type { SceneT, WorldStateT } from '../protocol';
import { channelKey } from './series_piece';

export type PerAxis = 'q_m' | 'q_s' | 'intention' | 'sent' | 'exercise_effort' | 'damping' | 'phi';
export type GlobalSeries = 'alpha' | 'palm_target_distance_m' | 'contact_force_n' | 'contact_count' | 'duration_s';

/** A column of plots, by names that are valid in every recording: of an axis, of an exercise value, or of the whole recording. */
export type Column = { readonly of: PerAxis | 'value'; readonly name: string } | { readonly of: GlobalSeries };

/** The channel of a column in one recording, in display units, and the same value in a state. */
export interface Channel { readonly key: string; readonly factor: number; readonly read: (state: WorldStateT) => number | undefined }

const OF_KEPT: Readonly<Record<StoredSeries, PerAxis>> = { effort: 'sent', device: 'q_m', avatar: 'q_s', phi: 'phi' };
export const keptColumn = (kept: StoredSeries, name: string): Column => ({ of: OF_KEPT[kept], name });

const OF_STATE: Readonly<Record<PerAxis, (state: WorldStateT) => readonly number[]>> = {
  q_m: (s) => s.qM, q_s: (s) => s.qS, intention: (s) => s.intention, sent: (s) => s.sent,
  exercise_effort: (s) => s.exerciseEffort, damping: (s) => s.damping, phi: (s) => s.phi,
};
const sizeOf = ({ forceN }: WorldStateT['contacts'][number]): number => (forceN ? Math.hypot(forceN.x, forceN.y, forceN.z) : 0);
const ALONE: Readonly<Record<GlobalSeries, { factor: number; read: (state: WorldStateT) => number | undefined }>> = {
  alpha: { factor: 1, read: (state) => state.alpha },
  palm_target_distance_m: { factor: 1000, read: (state) => (state.palmBody < 0 ? undefined : state.palmTargetDistanceM) },
  contact_force_n: { factor: 1, read: (state) => state.contacts.reduce((sum, contact) => sum + sizeOf(contact), 0) },
  contact_count: { factor: 1, read: (state) => state.contacts.length },
  duration_s: { factor: 1e6, read: () => undefined },   // no state contains it
};

/** The channel of a column in a recording; undefined where it has no such axis or value. */
export function channelOf(column: Column, scene: Pick<SceneT, 'axes' | 'valueNames'>): Channel | undefined {
  if (!('name' in column)) return { key: channelKey(column.of), ...ALONE[column.of] };
  const { of, name } = column;
  if (of === 'value') {
    const index = scene.valueNames.findIndex((other) => String(other) === name);
    return index < 0 ? undefined : { key: channelKey('value', index), factor: 1, read: (state) => state.values[index] };
  }
  const index = scene.axes.findIndex((axis) => String(axis.name) === name);
  if (index < 0) return undefined;
  const { coordinate, effort } = displayUnits(scene.axes[index]);
  const factor = of === 'phi' ? 1 : of === 'q_m' || of === 'q_s' || of === 'intention' ? coordinate : effort;
  return { key: channelKey(of, index), factor, read: (state) => OF_STATE[of](state)[index] };
}

/** Numbers the columns, equally for all recordings that are shown together. */
export class ColumnList {
  private readonly list: Column[] = [];
  private readonly numbers = new Map<string, number>();

  at(number: number): Column {
    return this.list[number];
  }

  numberOf(column: Column): number {
    const key = JSON.stringify(column);
    const known = this.numbers.get(key);
    if (known !== undefined) return known;
    this.list.push(column);
    this.numbers.set(key, this.list.length - 1);
    return this.list.length - 1;
  }
}
