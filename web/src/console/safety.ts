import { faultWords } from './run_status';
import { fill } from '../shared/i18n';
import { h, setText, setAttribute, setClass } from './dom';
import { fixed, significant } from '../shared/format';
import { deviceLines } from './device_status';
import { displayUnits } from './history';
import { SafetyState } from '../protocol';
import { language } from '../shared/i18n';
import { texts } from './i18n';
import { icon } from './icons';
import type { ConsoleModel, Panel } from './model';
import { isArm, limitOfAxis } from './plot_specs';

/** A peak value beside its limit. */
class PeakRow {
  readonly element: HTMLElement;
  private readonly bar = h('i');
  private readonly text = h('span', { class: 'num' });
  private readonly track: HTMLElement;

  constructor(private readonly name: string, private readonly unit: string, private readonly decimals: number) {
    this.track = h('span', { class: 'tr', role: 'meter', 'aria-label': name, 'aria-valuemin': 0 }, this.bar);
    this.element = h('div', { class: 'lim' }, h('span', {}, name), this.track, this.text);
  }

  show(peak: number, limit: number, words: string): void {
    const shown = fixed(peak, this.decimals);
    const most = significant(limit, 3);
    this.bar.style.width = `${Math.min(100, (100 * peak) / limit).toFixed(1)}%`;
    setClass(this.track, 'over', peak >= 0.995 * limit);
    setText(this.text, `${shown} / ${most} ${this.unit}`);
    setAttribute(this.track, 'aria-valuemax', String(limit));
    setAttribute(this.track, 'aria-valuenow', String(Math.min(peak, limit)));
    setAttribute(this.track, 'aria-valuetext', `${this.name}: ${fill(words, { a: shown, b: most })} ${this.unit}`);
  }
}

/** Late ticks and unsettled contacts: a therapist can do nothing about them, and the session goes on. */
const FOR_ENGINEERS = (1 << 7) | (1 << 31);

/** Shows the state, its cause, the system's reaction, and the peaks relative to their limits. */
export class SafetyPanel implements Panel {
  readonly element: HTMLElement;
  private readonly t = texts();
  private readonly steps: HTMLElement[];
  private readonly cause = h('b');
  private readonly excess = h('span', { class: 'excess num' });
  private readonly did = h('small');
  private readonly todo = h('strong', { class: 'todo' });
  private readonly causeIcon = h('span', { class: 'cause-icon' });
  private readonly box: HTMLElement;
  private readonly deviceState = h('span');
  private readonly deviceFigures = h('span', { class: 'num' });
  private readonly deviceLetGo = h('strong');
  private readonly device: HTMLElement;
  private readonly fingers = new PeakRow(this.t.safety.fingers, 'N', 1);
  private readonly thumb = new PeakRow(this.t.safety.thumb, 'N', 1);
  private readonly arm = new PeakRow(this.t.safety.arm, 'N', 1);
  private readonly speed = new PeakRow(this.t.safety.speed, 'm/s', 2);

  constructor(private readonly model: ConsoleModel, private readonly engineer = true) {
    const { t } = this;
    this.steps = [t.states.disarmed, t.states.rendering, t.states.stopping, t.states.stopped].map((name) => h('li', {}, name));
    this.box = h('div', { class: 'cause' }, this.causeIcon, h('div', {}, this.cause, this.excess, this.did, this.todo));
    this.device = h('p', { class: 'device', 'data-testid': 'device' }, h('b', {}, t.device.title), this.deviceState, this.deviceFigures, this.deviceLetGo);
    const rows = [...this.handRows(), ...(model.scene?.axes.some(isArm) ? [this.arm, this.speed] : [])];
    this.element = h('section', { class: 'panel safety', 'aria-label': t.safety.title },
      h('div', { class: 'hd' }, h('h2', {}, t.safety.title), h('span', { class: 'aside' }, t.safety.peaks)),
      h('ol', { class: 'steps', 'aria-label': t.safety.state }, ...this.steps), this.box, this.device,
      ...rows.map((row) => row.element));
    this.refresh();
  }

  refresh(): void {
    this.refreshState();
    this.refreshDevice();
    this.refreshPeaks();
  }

  private handRows(): PeakRow[] {
    const axes = this.model.scene?.axes ?? [];
    const has = (thumb: boolean): boolean => axes.some((axis) => !isArm(axis) && String(axis.name).startsWith('thumb') === thumb);
    return [...(has(false) ? [this.fingers] : []), ...(has(true) ? [this.thumb] : [])];
  }

  private refreshState(): void {
    const { t } = this;
    const status = this.model.status;
    this.steps.forEach((step, i) => {
      setClass(step, 'on', i === status.step && !status.bad);
      setClass(step, 'bad', i === status.step && status.bad);
      if (i === status.step) setAttribute(step, 'aria-current', 'step');
      else step.removeAttribute('aria-current');
    });
    setText(this.steps[1], this.model.state?.safetyState === SafetyState.Armed ? t.states.armed : t.states.rendering);
    setText(this.steps[3], status.name === 'faulted' ? t.states.faulted : t.states.stopped);
    if (this.box.dataset.bad !== String(status.bad)) {
      this.box.dataset.bad = String(status.bad);
      this.causeIcon.replaceChildren(icon(status.bad ? 'bad' : 'ok'));
    }
    setClass(this.box, 'bad', status.bad);
    setText(this.cause, status.cause);
    setText(this.excess, status.excess ?? '');
    setText(this.did, status.did || this.lastNotice());
    setText(this.todo, status.todo ?? '');
  }

  /** Lines of a real device. */
  private refreshDevice(): void {
    const { state } = this.model;
    const lines = deviceLines(state?.device, this.t, state?.silent, state?.workJ);
    this.device.hidden = lines === undefined;
    setText(this.deviceState, lines?.state ?? '');
    setText(this.deviceFigures, lines?.figures ?? '');
    setText(this.deviceLetGo, lines?.letGo ?? '');
  }

  private lastNotice(): string {
    const { notice } = this.model;
    const bits = (notice?.bits ?? 0) & ~(this.engineer ? 0 : FOR_ENGINEERS);
    if (!notice || bits === 0) return this.t.safety.nothingYet;
    return fill(this.t.safety.lastNotice, { time: notice.at.toLocaleTimeString(language(), { hour12: false }), what: faultWords(bits, this.model.scene?.faultNames ?? []).join(', ') });
  }

  private refreshPeaks(): void {
    const { model, t } = this;
    const { scene, history } = model;
    if (!scene || history.samples.length === 0) return;
    const indices = scene.axes.map((_, i) => i);
    const nameOf = (i: number): string => String(scene.axes[i].name);
    // The axis nearest to its own limit is shown: an axis with more room does not hide one at its limit.
    const show = (row: PeakRow, wanted: readonly number[]): void => {
      const peaks = wanted.map((i) => ({ peak: history.peak('effort', i), limit: limitOfAxis(scene.axes[i], (name) => model.parameter(name)) }));
      const nearest = peaks.reduce((a, b) => (b.peak / b.limit > a.peak / a.limit ? b : a), peaks[0] ?? { peak: 0, limit: 1 });
      row.show(nearest.peak, nearest.limit, t.safety.of);
    };
    const inNewton = (i: number): boolean => displayUnits(scene.axes[i]).effortUnit === 'N';
    show(this.fingers, indices.filter((i) => !isArm(scene.axes[i]) && !nameOf(i).startsWith('thumb') && inNewton(i)));
    show(this.thumb, indices.filter((i) => nameOf(i).startsWith('thumb') && inNewton(i)));
    const arm = indices.filter((i) => isArm(scene.axes[i]) && String(scene.axes[i].unit) === 'm');
    if (arm.length === 0) return;
    show(this.arm, arm);
    this.speed.show(history.peakSpeed(arm), scene.axes[arm[0]].speedLimit || 1, t.safety.of);
  }
}
