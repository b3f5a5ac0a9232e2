// Data of the records, as their process sends it. Times are in microseconds UTC, lengths in m.
export type Side = 'right' | 'left' | 'both';
export type OneSide = Exclude<Side, 'both'>;
export type Values = Readonly<Record<string, number>>;

export interface Tile {
  readonly id: number;
  readonly name: string;
  readonly colour: string;
  /** No longer works here: the name stands at notes and in the log, without a tile. */
  readonly left?: boolean;
}

/** A folder that a backup can be written to; `own`: that of the daily backups. */
export interface BackupPlace { readonly folder: string; readonly own: boolean; readonly last_us: number; readonly free_bytes: number }

/** An entry of the log. Account 0 is the program itself. */
export interface LogEntry { readonly at_us: number; readonly account: number; readonly what: string; readonly code: string; readonly visit: number }

export interface RecordsState {
  readonly clinic: 'new' | 'locked' | 'open';
  /** Before the clinic is created: the folder of the records. An empty folder may be a disk that is not mounted. */
  readonly folder?: { readonly path: string; readonly empty: boolean };
  readonly tiles: readonly Tile[];
  readonly station: { readonly heard: boolean };
  /** Number of the open visit; 0: none. */
  readonly visit: number;
  readonly backup: { readonly last_us: number; readonly folder: string; readonly problem?: string };
}

/** Who works here now. */
export const staffOf = (state: Pick<RecordsState, 'tiles'> | null): readonly Tile[] => (state?.tiles ?? []).filter(({ left }) => !left);

export interface Item {
  readonly exercise: string;
  readonly level: number;
  readonly minutes: number;
  readonly help: 'full' | 'some' | 'none';
  readonly parameters?: Values;
}

export interface PlanPreset { readonly id: string; readonly items: readonly Item[] }

export interface Presets {
  readonly force: readonly { readonly id: string; readonly parameters: Values }[];
  readonly plans: readonly PlanPreset[];
  /** What shall become easier, and the items that train it. */
  readonly goals: readonly PlanPreset[];
  readonly course: { readonly weeks: number; readonly visits_a_week: number };
  readonly exercises: readonly { readonly id: string; readonly levels: number }[];
}

export interface PatientRow {
  readonly id: number;
  readonly code: string;
  readonly name: string;
  readonly side: Side;
  readonly visits: number;
  readonly last_visit_us: number;
  readonly state: 'open' | 'unfinished' | '';
  readonly visit: number;
}

export interface PatientList {
  readonly open: readonly PatientRow[];
  readonly patients: readonly PatientRow[];
  /** Ended visits without a patient, to be assigned or deleted. */
  readonly guests?: readonly Visit[];
  /** Actions over rows and files that are not done yet. */
  readonly under_way?: readonly { readonly what: 'erase' | 'delete' | 'restore' | 'list'; readonly problem: string }[];
  /** What a restore left to people. */
  readonly restored?: Restored | null;
  /** Patients that were found; `patients` has one page of them. */
  readonly count?: number;
  readonly page?: number;
  /** Names of damaged rows. */
  readonly damaged?: readonly string[];
  /** Changes that a damaged write-ahead log lost. */
  readonly lost?: number;
  /** When the clock jumped; 0: it did not. */
  readonly clock_jumped_us?: number;
}

export interface Restored {
  readonly at_us: number;
  /** Everything that was erased until then stays erased. */
  readonly until_us: number;
  readonly again: readonly { readonly what: 'moved' | 'joined' | 'given'; readonly to: string; readonly from?: string; readonly began_us?: number }[];
}

export interface Size { readonly length_m: number; readonly breadth_m: number; readonly limits?: readonly Limit[] }

/** The part of a device's axis that is this hand's: a way or an angle. */
export interface Limit { readonly axis: string; readonly within_m?: readonly [number, number]; readonly within_rad?: readonly [number, number] }

/** The editable data of a patient. */
export interface PatientText {
  readonly name: string;
  readonly code: string;
  readonly born: string;
  readonly number: string;
  readonly side: Side;
  readonly hands: Readonly<Partial<Record<OneSide, Size>>>;
  readonly preset: string;
  readonly parameters: Values;
  readonly warnings: string;
  readonly plan: readonly Item[];
}

/** What can be read of a damaged patient. Side, hands and limits are chosen anew. */
export interface DamagedPatient extends Omit<PatientText, 'side'> {
  readonly side: '';
  /** What the damaged row says. */
  readonly was: { readonly side: string; readonly hands: Readonly<Record<string, unknown>>; readonly preset: string; readonly parameters: Readonly<Record<string, unknown>> };
  /** Names of fields that cannot be read. */
  readonly unreadable: readonly string[];
}

export interface Note {
  readonly id: number;
  readonly visit: number;
  readonly at_us: number;
  readonly account: string | number;
  readonly kind: string;
  readonly text: string;
}

export interface Result { readonly name: string; readonly value: number; readonly unit: string }

export interface Trial {
  readonly item: number;
  readonly exercise: string;
  readonly level: number;
  readonly recording: string;
  readonly began_us: number;
  /** null where nothing was measured. */
  readonly active_s: number | null;
  readonly helped_share: number | null;
  /** Part of the active time with some help, and time in which the page led the hand. */
  readonly helped_s?: number | null;
  readonly led_s?: number | null;
  /** How the session ended. */
  readonly ended_by?: 'stop' | 'fault' | 'broken_off' | '';
  /** Mean time of the person's reaches, greatest speed, and path length relative to the straight line. */
  readonly reach_s?: number | null;
  readonly peak_speed_m_s?: number | null;
  readonly path_ratio?: number | null;
  readonly results: readonly Result[];
  readonly state: 'measured' | 'waiting' | 'failed';
  readonly why?: string;
}

/** A recording made outside of a visit, or while the records did not answer. It belongs to no patient yet. */
export interface LooseSession extends Omit<Trial, 'item'> {
  readonly id: number;
  readonly duration_s: number;
  readonly side: OneSide;
}

export interface Visit {
  readonly id: number;
  /** null: no patient is assigned yet. */
  readonly patient: number | null;
  readonly side: OneSide;
  readonly began_us: number;
  readonly ended_us: number;
  readonly offset_min: number;
  /** damaged: the row is, and nothing but the number is shown. */
  readonly state: 'open' | 'unfinished' | 'done' | 'no_show' | 'guest' | 'damaged';
  readonly account: string | number;
  readonly plan: readonly Item[];
  /** Index of the plan's item that is set up. */
  readonly item: number;
  readonly trials: readonly Trial[];
  readonly notes?: readonly Note[];
  /** 0 is an answer; null: not asked. */
  readonly pain_before: number | null;
  readonly pain_after: number | null;
}

export interface Curve { readonly name: string; readonly exercise?: string; readonly unit?: string; readonly points: readonly (readonly [t_us: number, value: number])[] }

export interface Patient extends PatientText {
  readonly id: number;
  readonly version: number;
  readonly visits: readonly Visit[];
  readonly notes: readonly Note[];
  readonly today: readonly Item[];
  readonly curves: readonly Curve[];
}

type Times = 'active_s' | 'helped_s' | 'led_s';
/** A time of a visit over its trials [s]. */
export const timeOf_s = ({ trials }: Pick<Visit, 'trials'>, time: Times): number => trials.reduce((sum, trial) => sum + (trial[time] ?? 0), 0);
/** Whether figures of the visit are still missing, because a recording of it is being measured. */
export const isCounting = ({ trials }: Pick<Visit, 'trials'>): boolean => trials.some(({ state }) => state === 'waiting');

/** Active seconds of an item of the plan. */
export const activeOf_s = ({ trials }: Pick<Visit, 'trials'>, item: number): number =>
  trials.filter((trial) => trial.item === item).reduce((sum, { active_s }) => sum + (active_s ?? 0), 0);

/** The index of the item that is set up, limited to the plan. */
export const itemNow = ({ plan, item }: Pick<Visit, 'plan' | 'item'>): number => Math.max(0, Math.min(item, plan.length - 1));

/** Whether the visit is open: training continues in it, and no other visit may begin. */
export const isOpen = ({ state, ended_us }: Visit): boolean => state === 'open' || (state === 'guest' && ended_us === 0);

/** Whether a visit took place and belongs to a patient. */
export const tookPlace = ({ state }: Visit): boolean => state === 'done' || state === 'unfinished';

/** The newest wish for the next visit, and whether it was written in the last visit; undefined: none. */
export const nextWish = ({ notes, visits }: Pick<Patient, 'notes' | 'visits'>): Note | undefined => {
  const last = newestFirst(visits).find(tookPlace), all = [...notes, ...visits.flatMap((visit) => visit.notes ?? [])];
  return all.filter(({ kind, visit, text }) => kind === 'next' && text.trim() !== '' && visit === last?.id).sort((a, b) => b.at_us - a.at_us)[0];
};

/** The person's notes and those of their visits, the newest first; marks without words are left out. */
export const allNotes = ({ notes, visits }: Pick<Patient, 'notes' | 'visits'>): Note[] =>
  [...new Map([...visits.flatMap((visit) => visit.notes ?? []), ...notes].filter(({ text }) => text.trim() !== '').map((note) => [`${note.id} ${note.at_us}`, note])).values()].sort((a, b) => b.at_us - a.at_us);

/** Visits sorted by date, the newest first. */
export const newestFirst = (visits: readonly Visit[]): Visit[] => [...visits].sort((a, b) => b.began_us - a.began_us);
