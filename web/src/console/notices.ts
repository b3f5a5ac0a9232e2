import { sessionWords } from './title_words';
import { hasHardware } from '../shared/hardware';
import { fill } from '../shared/i18n';
import { h, setText } from './dom';
import { texts } from './i18n';
import { Role } from '../protocol';
import type { ConsoleModel, Panel } from './model';
import { tokenOf } from '../net/open_connection';
import { figuresOf, reportUrl } from './recordings';
import type { Recording } from './recording';

/** A refusal is shown for this long [ms]. */
const REFUSAL_MS = 10_000;

/** Notices below the header, one at a time, the most severe first: stop not confirmed, connection lost, controls lost, another client commands, order refused. */
export class NoticesPanel implements Panel {
  readonly element: HTMLElement;
  private readonly t = texts();
  private readonly lost: HTMLElement;
  private readonly lostText = h('span');
  private readonly attempts = h('span', { class: 'num' });
  private readonly held: HTMLElement;
  private readonly heldText = h('span');
  private readonly watching: HTMLElement;
  private readonly left: HTMLElement;
  private readonly leftText = h('span');
  private readonly unconfirmed: HTMLElement;
  private readonly unrecorded: HTMLElement;
  private readonly refused: HTMLElement;
  private readonly refusedText = h('span');
  private readonly kept: HTMLElement;
  private shownSaved: Recording | undefined;
  private timer: ReturnType<typeof setTimeout> | undefined;

  constructor(private readonly model: ConsoleModel) {
    const t = this.t.notices;
    const retry = h('button', { type: 'button', class: 'b small', 'data-testid': 'retry' }, t.retry);
    retry.addEventListener('click', () => model.connection.retryNow());
    this.lost = h('div', { class: 'notice bad', role: 'alert', hidden: true, 'data-testid': 'lost' }, this.lostText, this.attempts, retry);
    this.unconfirmed = h('div', { class: 'notice alarm', role: 'alert', hidden: true, 'data-testid': 'stop-unconfirmed' }, h('strong', {}, t.unconfirmed), h('span', {}, t.unconfirmedMore));
    this.left = h('div', { class: 'notice warn', role: 'alert', hidden: true, 'data-testid': 'left' }, this.leftText, this.takeButton('take-again'));
    const take = this.takeButton('take-controls-banner');
    this.held = h('div', { class: 'notice', role: 'status', hidden: true, 'data-testid': 'held' }, this.heldText, take);
    this.watching = h('div', { class: 'notice warn', role: 'status', hidden: true, 'data-testid': 'watching' }, h('span', {}, t.watching));
    this.unrecorded = h('div', { class: 'notice warn', role: 'status', hidden: true, 'data-testid': 'unrecorded' }, h('strong', {}, t.unrecorded), h('span', {}, t.unrecordedMore));
    const close = h('button', { type: 'button', class: 'b small' }, t.close);
    close.addEventListener('click', () => { this.refused.hidden = true; });
    this.refused = h('div', { class: 'notice warn', role: 'alert', hidden: true, 'data-testid': 'refused' }, this.refusedText, close);
    this.kept = h('div', { class: 'notice', role: 'status', hidden: true, 'data-testid': 'saved' });
    this.element = h('div', { class: 'notices' }, this.unconfirmed, this.lost, this.left, this.refused, this.kept, this.unrecorded, this.watching, this.held);
    this.refresh();
  }

  /** Shows that an order was refused, and the reason. */
  refuse(what: string, reason: string): void {
    setText(this.refusedText, fill(this.t.notices.refused, { what, reason }));
    this.refused.hidden = false;
    clearTimeout(this.timer);
    this.timer = setTimeout(() => { this.refused.hidden = true; }, REFUSAL_MS);
  }

  refresh(): void {
    const { connection, state } = this.model;
    const t = this.t.notices;
    const { problem } = connection;
    const lost = connection.status === 'lost';
    if (this.lost.hidden === lost) this.lost.hidden = !lost;
    if (lost) {
      const hardware = hasHardware(state) ? ` ${t.hardware}` : '';
      setText(this.lostText, problem ? fill(t.version, { theirs: problem.theirs, ours: problem.ours }) : `${t.lost} ${state?.silent ? '' : t.lostMore}${hardware}`);
      setText(this.attempts, problem ? '' : fill(t.attempts, { n: connection.attempts }));
    }
    const { role, holder } = connection.controls;
    const watching = connection.status === 'open' && (role === Role.Watcher || role === Role.Player);
    if (this.watching.hidden === watching) this.watching.hidden = !watching;
    const held = connection.status === 'open' && !watching && connection.controls.held && !connection.controls.heldByYou;
    setText(this.heldText, holder === Role.Player ? t.player : holder === Role.Therapist ? t.therapist : t.held);
    if (this.held.hidden === held) this.held.hidden = !held;
    const { loss } = connection;
    const left = connection.status === 'open' && loss !== '' && !connection.controls.held;
    if (this.left.hidden === left) this.left.hidden = !left;
    if (loss !== '') setText(this.leftText, t[loss]);
    const unrecorded = this.model.recorded === false;
    if (this.unrecorded.hidden === unrecorded) this.unrecorded.hidden = !unrecorded;
    if (this.shownSaved !== this.model.saved) this.showSaved(this.shownSaved = this.model.saved);
    if (this.unconfirmed.hidden === connection.stopUnconfirmed) this.unconfirmed.hidden = !connection.stopUnconfirmed;
  }

  close(): void {
    clearTimeout(this.timer);
  }

  private showSaved(recording: Recording | undefined): void {
    this.kept.hidden = recording === undefined;
    if (!recording) return;
    const t = this.t;
    const { name } = recording;
    const link = h('a', { href: reportUrl(name, tokenOf(location)), target: '_blank', rel: 'noopener', 'aria-label': fill(t.recordings.reportOf, { name: sessionWords(recording) }) }, t.recordings.report);
    const close = h('button', { type: 'button', class: 'b small' }, t.notices.close);
    close.addEventListener('click', () => { this.model.saved = undefined; this.refresh(); });
    this.kept.replaceChildren(h('span', { title: name }, fill(t.notices.saved, { name: sessionWords(recording), figures: figuresOf(recording) })),
      ...(recording.report ? [link] : []), close);
  }

  private takeButton(testid: string): HTMLElement {
    const take = h('button', { type: 'button', class: 'b small', 'data-testid': testid }, this.t.setup.take);
    take.addEventListener('click', () => void this.take());
    return take;
  }

  private async take(): Promise<void> {
    const answer = await this.model.connection.takeControls();
    if (!answer.accepted) this.refuse(this.t.setup.take, answer.reason);
  }
}
