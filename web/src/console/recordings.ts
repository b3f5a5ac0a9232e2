import { sessionWords } from './title_words';
import { tokenOf } from '../net/open_connection';
import { fill, language } from '../shared/i18n';
import { h, setText } from './dom';
import { bytes, duration } from '../shared/format';
import { texts } from './i18n';
import type { ConsoleModel, Panel } from './model';
import type { WorldStateT } from '../protocol';
import type { Recording } from './recording';

/** The list is requested this often [ms]. */
const EVERY_MS = 5000;
/** Number of recordings that are shown at first: a list of years would slow the page. */
const NEWEST = 6;

/** Reads the answer of /api/recordings without malformed entries; undefined if it is not a list. */
function readRecordings(json: unknown): { recordings: Recording[]; recording: string } | undefined {
  if (typeof json !== 'object' || json === null || !Array.isArray((json as { recordings?: unknown }).recordings)) return undefined;
  const { recordings, recording } = json as { recordings: unknown[]; recording?: unknown };
  const good = recordings.filter((entry): entry is Recording =>
    typeof entry === 'object' && entry !== null && typeof (entry as Recording).name === 'string');
  return { recordings: good, recording: typeof recording === 'string' ? recording : '' };
}

/** When it was made: the time for today, else the day. */
export function whenMade({ created_utc, name }: Pick<Recording, 'created_utc' | 'name'>, now: Date, locale: string): string {
  // The name of a file that was broken off has its begin, in this machine's time.
  const made = new Date(created_utc || name.replace(/^(\d{4})(\d\d)(\d\d)-(\d\d)(\d\d)(\d\d)-.*$/, '$1-$2-$3T$4:$5:$6'));
  if (Number.isNaN(made.getTime())) return '';
  const today = made.toDateString() === now.toDateString();
  return today
    ? made.toLocaleTimeString(locale, { hour: '2-digit', minute: '2-digit', hour12: false })
    : made.toLocaleDateString(locale, { day: 'numeric', month: 'short' });
}

/** The address of a recording or its report, with the token of this page if it has one. */
export function recordingUrl(name: string, report: boolean, token: string): string {
  return `/api/recordings/${encodeURIComponent(name)}${report ? '/report' : ''}${token === '' ? '' : `?token=${encodeURIComponent(token)}`}`;
}

/** The address of the page that requests the report and shows it. */
export function reportUrl(name: string, token: string): string {
  return `/replay?recording=${encodeURIComponent(name)}&report${token === '' ? '' : `&token=${encodeURIComponent(token)}`}`;
}

/** The address of the page that replays one recording, or two side by side. */
export function replayUrl(names: readonly string[], token: string): string {
  const [recording, beside] = names.map(encodeURIComponent);
  return `/replay?recording=${recording}${beside === undefined ? '' : `&beside=${beside}`}${token === '' ? '' : `&token=${encodeURIComponent(token)}`}`;
}

/** Whether a recording is being written; false while its loop does not answer, since then nobody knows. */
export function isWriting(recording: string, state: Pick<WorldStateT, 'silent'> | null): boolean {
  return recording !== '' && !state?.silent;
}

/** Duration, size, missing ticks, and whether it is still being written, as text. @param silent the loop does not answer */
export function figuresOf(recording: Recording, silent = false): string {
  const { duration_s, bytes: size, ticks_missing, being_written } = recording;
  return [
    ...(being_written === true && !silent ? [texts().recordings.beingWritten] : []),
    // The duration is known only when the file is closed. A program that was killed closed none.
    ...(duration_s === undefined || being_written === true ? [] : [duration_s > 0 ? duration(duration_s) : texts().recordings.brokenOff]),
    ...(size === undefined ? [] : [bytes(size)]),
    ...(ticks_missing ? [fill(texts().recordings.missing, { ticks: ticks_missing.toLocaleString(language()) })] : []),
  ].join(', ');
}

/** The shown part of a list with the newest first: the newest, the one being written and the chosen ones; or all. */
export function shownOf(recordings: readonly Recording[], chosen: readonly string[], all: boolean): Recording[] {
  return recordings.filter(({ name, being_written }, k) => all || k < NEWEST || being_written === true || chosen.includes(name));
}

/** The links of a recording. One that is still being written has neither a report nor a complete file. */
export function offered({ being_written, report }: Recording): { report: boolean; download: boolean } {
  const finished = being_written !== true;
  return { report: finished && Boolean(report), download: finished };
}

/** Reports each ended recording once, when it appears in the list. */
export class SavedWatch {
  private writing = '';
  private readonly ended = new Set<string>();

  /** Updates the name of the recording being written; true if another one has ended. */
  take(writing: string): boolean {
    if (writing === this.writing) return false;
    const ended = this.writing !== '';
    if (ended) this.ended.add(this.writing);
    this.writing = writing;
    this.ended.delete(writing);
    return ended;
  }

  /** Recordings of the list that have ended and were not reported. */
  found(recordings: readonly Recording[]): Recording[] {
    return recordings.filter(({ name }) => this.ended.delete(name));
  }
}

/** The recordings with replay, report and download, and the one being written. */
export class RecordingsPanel implements Panel {
  readonly element: HTMLElement;
  private readonly t = texts().recordings;
  private readonly list = h('ul', { class: 'recs', 'data-testid': 'recordings' });
  private readonly words = h('p', { class: 'none', role: 'status' }, this.t.none);
  private readonly now: HTMLElement;
  private readonly nowText = h('span', { class: 'num' });
  private readonly timer: ReturnType<typeof setInterval>;
  private readonly beside = h('a', { target: '_blank', rel: 'noopener', hidden: true, 'data-testid': 'replay-beside' }, this.t.beside);
  private readonly more = h('button', { type: 'button', class: 'b small', hidden: true, 'data-testid': 'all-recordings' });
  private recordings: readonly Recording[] = [];
  private chosen: string[] = [];
  private all = false;
  private silent = false;

  constructor(private readonly model: ConsoleModel, private readonly watch: SavedWatch) {
    this.now = h('span', { class: 'rec', hidden: true }, h('i'), `${this.t.now} `, this.nowText);
    this.element = h('section', { class: 'panel recordings', 'aria-label': this.t.title },
      h('div', { class: 'hd' }, h('h2', {}, this.t.title), this.beside, this.now), this.words, this.list, this.more);
    this.list.addEventListener('change', ({ target }) => { if (target instanceof HTMLInputElement) this.choose(target); });
    this.more.addEventListener('click', () => { this.all = !this.all; this.show(); });
    this.timer = setInterval(() => void this.read(), EVERY_MS);
    void this.read();
  }

  refresh(): void {
    const state = this.model.state;
    const size = Number(state?.recordingBytes ?? 0n);
    const writing = String(this.model.scene?.recording ?? '');
    if (this.watch.take(writing)) void this.read();
    const runs = isWriting(writing, state), silent = state?.silent === true;
    if (silent !== this.silent) {
      this.silent = silent;
      this.show();
    }
    if (this.now.hidden === runs) this.now.hidden = !runs;
    if (runs) setText(this.nowText, `${duration(state?.timeS ?? 0)}, ${bytes(size)}`);
  }

  close(): void {
    clearInterval(this.timer);
  }

  private async read(): Promise<void> {
    if (document.hidden) return;
    const token = tokenOf(location);
    try {
      const answer = await fetch(`/api/recordings${token === '' ? '' : `?token=${encodeURIComponent(token)}`}`);
      const found = answer.ok ? readRecordings(await answer.json()) : undefined;
      if (!found) throw new Error('no list');
      this.take(found.recordings);
      const finished = found.recordings.filter(({ name }) => name !== found.recording);
      for (const recording of this.watch.found(finished)) this.model.saved = recording;
    } catch {
      setText(this.words, this.t.failed);
      this.words.hidden = false;
    }
  }

  private take(recordings: readonly Recording[]): void {
    this.words.hidden = recordings.length > 0;
    setText(this.words, this.t.none);
    if (JSON.stringify(recordings) === JSON.stringify(this.recordings)) return;
    this.recordings = recordings;
    this.chosen = this.chosen.filter((name) => recordings.some((recording) => recording.name === name));
    this.showBeside();
    this.show();
  }

  private show(): void {
    const shown = shownOf(this.recordings, this.chosen, this.all);
    this.list.replaceChildren(...shown.map((recording) => this.row(recording, tokenOf(location))));
    this.more.hidden = this.recordings.length <= NEWEST;
    setText(this.more, this.all ? this.t.newest : fill(this.t.all, { n: this.recordings.length.toLocaleString(language()) }));
  }

  /** Chooses up to two recordings, which are replayed side by side; a third one replaces the first. */
  private choose(box: HTMLInputElement): void {
    const name = box.value;
    this.chosen = box.checked ? [...this.chosen, name].slice(-2) : this.chosen.filter((other) => other !== name);
    for (const each of this.list.querySelectorAll('input')) each.checked = this.chosen.includes(each.value);
    this.showBeside();
  }

  private showBeside(): void {
    this.beside.hidden = this.chosen.length < 2;
    if (this.chosen.length === 2) this.beside.href = replayUrl(this.chosen, tokenOf(location));
  }

  private row(recording: Recording, token: string): HTMLElement {
    const { t } = this;
    const { name } = recording;
    const can = offered(recording);
    const when = whenMade(recording, new Date(), language());
    const called = sessionWords(recording);
    const reportLink = can.report ? h('a', { href: reportUrl(name, token), target: '_blank', rel: 'noopener', 'aria-label': fill(t.reportOf, { name: called }) }, t.report) : null;
    const replayLink = h('a', { href: replayUrl([name], token), target: '_blank', rel: 'noopener', 'aria-label': fill(t.replayOf, { name: called }), 'data-testid': 'replay' }, t.replay);
    const downloadLink = can.download ? h('a', { href: recordingUrl(name, false, token), download: name, 'aria-label': fill(t.downloadOf, { name: called }) }, t.download) : null;
    const box = h('input', { type: 'checkbox', value: name, 'aria-label': fill(t.besideOf, { name: called }) });
    box.checked = this.chosen.includes(name);
    return h('li', { title: name }, h('label', { class: 'pick' }, box), h('span', {}, h('b', {}, when), ' ', h('bdi', {}, called), h('small', {}, figuresOf(recording, this.silent))),
      h('span', { class: 'links' }, replayLink, reportLink, downloadLink));
  }
}
