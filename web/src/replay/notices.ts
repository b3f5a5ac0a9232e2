import { h } from '../console/dom';
import { Changes } from '../shared/changes';
import { grouped } from '../shared/format';
import { fill } from '../shared/i18n';
import { texts as consoleTexts } from '../console/i18n';
import { clockTime } from './clock';
import { axesOfOne, differencesBetween } from './differences';
import { texts } from './i18n';
import type { OpenFailure } from './open_recordings';
import type { ReplaySide } from './side';

/** Notices about the shown recordings: one grows, has gaps, or has a part that cannot be read. */
export class ReplayNotices {
  readonly element = h('div', { class: 'notices replay-notices' });
  private readonly changes = new Changes();

  /** @param failed requested recordings that cannot be shown */
  constructor(private readonly sides: readonly ReplaySide[], private readonly failed: readonly OpenFailure[], private readonly readOn: (side: ReplaySide) => void) {}

  refresh(): void {
    const [first] = this.sides;
    const lines = this.sides.map((side, i) => [...(i === 0 ? this.failed.map(lineOfFailed) : linesOfSecond(first, side)), ...linesOf(side)]);
    if (!this.changes.of(lines)) return;
    // Each recording's notices stand above it.
    this.element.replaceChildren(...lines.map((own, i) => h('div', {}, ...own.map((line) => this.notice(line, i)))));
  }

  private notice({ kind, text, act }: Line, i: number): HTMLElement {
    const { sides, notices: t } = texts();
    const side = this.sides[i];
    const acts = { retry: () => side.retry(), 'read-on': () => this.readOn(side), reload: () => location.reload() };
    const button = act === undefined ? null : h('button', { type: 'button', class: 'b small', 'data-testid': act, onclick: acts[act] }, act === 'read-on' ? t.readOn : t.retry);
    return h('div', { class: `notice ${kind}`, role: kind === 'bad' ? 'alert' : 'status' },
      this.sides.length > 1 ? h('b', {}, i === 0 ? sides.a : sides.b) : null, h('bdi', { class: 'clip', title: text }, text), button);
  }
}

interface Line { readonly kind: string; readonly text: string; readonly act?: 'retry' | 'read-on' | 'reload' }

/** The notice for a recording that cannot be shown beside the others. */
export function lineOfFailed({ name, problem }: OpenFailure): Line {
  const why = [texts().problems[problem.kind], problem.text].filter((words) => words !== '').join(' ');
  return { kind: 'bad', text: fill(texts().notices.failed, { name, why }), act: 'reload' };
}

/** Notices on what cannot be compared between the second recording and the first. */
export function linesOfSecond(first: Pick<ReplaySide, 'about' | 'scene'>, second: Pick<ReplaySide, 'about' | 'scene'>): Line[] {
  const { notices: t, facts } = texts();
  const names = consoleTexts().axesLong;
  const different = differencesBetween(first.about, second.about).map((what) => facts[what]);
  const axes = axesOfOne(first.scene.axes, second.scene.axes).map((name) => names[name] ?? name);
  return [
    ...(different.length > 0 ? [{ kind: '', text: fill(t.differs, { what: different.join(', ') }) }] : []),
    ...(axes.length > 0 ? [{ kind: '', text: fill(t.axesOfOne, { axes: axes.join('; ') }) }] : []),
  ];
}

export function linesOf(side: ReplaySide): Line[] {
  const t = texts().notices;
  const { about, problem } = side;
  const lines: Line[] = [];
  if (problem?.kind === 'gone') lines.push({ kind: 'bad', text: t.gone, act: 'retry' });
  else if (problem) lines.push({ kind: 'warn', text: fill(t.piece, { why: problem.text || texts().problems[problem.kind] }), act: 'retry' });
  if (about.still_written) lines.push({ kind: '', text: t.written, act: 'read-on' });
  if (!about.whole) lines.push({ kind: 'warn', text: about.unreadable_from_s === undefined ? t.damagedEnd : fill(t.damaged, { time: clockTime(about.unreadable_from_s + side.shift_s, 3) }) });
  if (about.ticks === 0) lines.push({ kind: 'warn', text: t.empty });
  if (side.about.ticks_missing > 0) lines.push({ kind: 'warn', text: fill(t.holes, { n: grouped(side.about.ticks_missing) }) });
  if (!side.hasScene) lines.push({ kind: '', text: about.no_picture_because === '' ? t.noPictureAtAll : fill(t.noPicture, { why: about.no_picture_because }) });
  if (about.exercise === '') lines.push({ kind: '', text: t.noExercise });
  return lines;
}
