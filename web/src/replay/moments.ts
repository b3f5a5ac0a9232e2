import type { Mark } from '../console/marks';
import { phaseSign } from '../console/marks';
import type { Span } from '../console/plot_source';
import { ownEventWords } from '../exercises/info';
import { asWords, grouped } from '../shared/format';
import type { ConsoleTexts } from '../console/i18n';
import { faultWord, fill } from '../shared/i18n';
import type { ReplayTexts } from './i18n';
import type { Gap, MarkKind, ReplayEvent, ReplayMark, SeriesPiece } from './series_piece';

/** At most this many moments of a recording are kept. */
const MOST = 50_000;

export type MomentKind = MarkKind | 'event' | 'gap';

/** A moment of a recording: an event, a mark or a gap, as the file states it. */
export interface Moment { readonly time_s: number; readonly kind: MomentKind; readonly event?: ReplayEvent; readonly mark?: ReplayMark; readonly gap?: Gap }

const BAD: readonly MomentKind[] = ['stop', 'emergency_stop', 'fault', 'controls_lost', 'gap'];

export const isBad = (moment: Pick<Moment, 'kind'>): boolean => BAD.includes(moment.kind);

/** All moments from all loaded pieces; a piece may come twice, at two levels. */
export class Moments {
  list: readonly Moment[] = [];
  gaps: readonly Gap[] = [];
  private readonly seen = new Set<string>();

  add(piece: Pick<SeriesPiece, 'events' | 'gaps' | 'marks'>): void {
    const news: Moment[] = [
      ...piece.events.map((event): Moment => ({ time_s: event.time_s, kind: 'event', event })),
      ...piece.marks.map((mark): Moment => ({ time_s: mark.time_s, kind: mark.kind, mark })),
      ...piece.gaps.map((gap): Moment => ({ time_s: gap.from_s, kind: 'gap', gap })),
    ].filter((moment) => Number.isFinite(moment.time_s) && this.isNew(moment));
    if (news.length === 0) return;
    this.list = [...this.list, ...news].sort((a, b) => a.time_s - b.time_s).slice(0, MOST);
    this.gaps = this.list.flatMap(({ gap }) => gap ?? []);
  }

  within({ from_s, to_s }: Span): Moment[] {
    return this.list.filter(({ time_s }) => time_s >= from_s && time_s <= to_s);
  }

  /** The next moment after (way 1) or before (way -1) a time; undefined where there is none. */
  beside(time_s: number, way: 1 | -1): Moment | undefined {
    const apart_s = 1e-6;
    return way > 0 ? this.list.find((moment) => moment.time_s > time_s + apart_s) : this.list.filter((moment) => moment.time_s < time_s - apart_s).at(-1);
  }

  private isNew({ time_s, kind, event, mark }: Moment): boolean {
    const key = `${time_s.toFixed(6)} ${kind} ${event?.type ?? ''} ${event?.index ?? ''} ${mark?.text ?? ''}`;
    if (this.seen.has(key)) return false;
    this.seen.add(key);
    return true;
  }
}

/** Index of the last of these sorted moments at a time; undefined: none was yet. */
export function lastAt(moments: readonly Pick<Moment, 'time_s'>[], time_s: number): number | undefined {
  const apart_s = 1e-6;
  let [low, high] = [0, moments.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (moments[middle].time_s <= time_s + apart_s) low = middle + 1;
    else high = middle;
  }
  return low === 0 ? undefined : low - 1;
}

/** The first of at most `most` shown rows out of `count`: unchanged while `meant` is among them, else so that `meant` is in the middle. */
export function rowsAround(count: number, meant: number | undefined, most: number, first: number): number {
  const last = Math.max(0, count - most);
  const here = meant ?? 0;
  return here >= first && here < first + most ? Math.min(first, last) : Math.min(last, Math.max(0, here - Math.floor(most / 2)));
}

/** Names in a file that are turned into words. */
export interface Names {
  readonly eventNames: readonly string[];
  /** The exercise's own words for an event; empty where it has none. */
  ownWords(type: number): string;
}

/** A moment in words of the page's language. */
export function wordsOf(moment: Moment, names: Names, t: ReplayTexts, ofConsole: ConsoleTexts): string {
  const { event, mark, gap } = moment;
  if (gap) return fill(t.moments.gap, { n: grouped(gap.ticks) });
  if (event) {
    const name = names.eventNames[event.type] ?? '';
    return names.ownWords(event.type) || (t.moments.events[name] ?? ownEventWords(name) ?? (name === '' ? `${event.type}` : asWords(name)));
  }
  const kind = t.moments.kinds[moment.kind] ?? moment.kind;
  const why = (mark?.text ?? '').split(', ').filter((name) => name !== '').map(faultWord).join(', ');
  const axis = mark?.axis ? ofConsole.axesLong[mark.axis] ?? mark.axis : '';
  return [kind, [why, axis].filter((word) => word !== '').join(', ')].filter((word) => word !== '').join(': ');
}

/** A moment as a vertical line in the plots. */
export function plotMark(moment: Moment, names: Names, t: ReplayTexts, ofConsole: ConsoleTexts): Mark {
  const sign = moment.event ? phaseSign(names.eventNames[moment.event.type] ?? '') ?? '' : t.moments.short[moment.kind] ?? moment.kind;
  return { time_s: moment.time_s, label: sign, meaning: wordsOf(moment, names, t, ofConsole), bad: isBad(moment) };
}
