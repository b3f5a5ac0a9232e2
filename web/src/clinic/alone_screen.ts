import type { EventT } from '../protocol';
import { h, say } from '../console/dom';
import { viewOf } from '../console/parameter_model';
import { texts as consoleTexts } from '../console/i18n';
import { texts } from './i18n';
import type { Room } from './page';
import type { OneSide } from './records';
import { gently, running, SideQuestion, Training } from './training';
import { button, Said, type Screen } from './ui';
import { itemWords, parameterWords, sideWords } from './words';

/** A session while the records are gone: an open visit goes on with its limits, a new session has the gentle ones and is given to a patient later. */
export class AloneScreen implements Screen {
  readonly element = h('main', { class: 'visit' });
  private readonly t = texts().alone;
  private readonly training: Training;
  private readonly side: SideQuestion;
  private readonly said = new Said();
  private readonly title = h('h2', {});
  private readonly words = h('p', {});
  private readonly limits = h('dl', { class: 'facts' });
  private readonly stop: HTMLButtonElement;
  private readonly leave: HTMLButtonElement;
  private shown = '';
  private lowering = false;

  constructor(private readonly room: Room) {
    const { t } = this;
    this.training = new Training(room);
    this.side = new SideQuestion(`alone-${Date.now()}`, () => this.hand, t.wrongSide, () => this.refresh());
    this.stop = button(texts().visit.stop, 'gentle-stop', async () => { if (!await gently(room, texts().visit.stop)) this.said.say(texts().visit.doesNotStop); }, 'wide');
    this.leave = button(t.leave, 'leave-alone', () => room.go({ at: 'patients' }), 'wide');
    this.element.append(h('div', { class: 'col seen' }, this.side.element, this.training.picture),
      h('div', { class: 'col' }, h('section', { class: 'panel planned', 'aria-label': t.title, 'data-testid': 'alone' }, this.title, this.words, this.limits, this.said.element, this.stop, this.leave), this.training.controls));
    this.training.begin();
    this.refresh();
  }

  who(): readonly [string, string] { return [this.ofVisit ? texts().visit.hiddenName : texts().visit.noPatient, [this.hand ? sideWords(this.hand) : '', this.ofVisit ? '' : texts().visit.gentle].filter(Boolean).join(' · ')]; }
  what(): readonly [string, string] {
    const { scene, recorded } = this.room.model, t = texts().visit;
    return [itemWords({ exercise: String(scene?.exerciseName ?? ''), level: scene?.level ?? 0 }), recorded === undefined ? '' : recorded ? t.recorded : t.unrecorded];
  }
  startable(): boolean { return this.side.said && this.above.length === 0; }

  refresh(): void {
    const { t, room: { model } } = this;
    say(this.title, this.ofVisit ? t.visitGoesOn : t.title);
    say(this.words, this.ofVisit ? t.visitWords : t.words);
    this.side.refresh();
    this.training.refresh();
    const runs = running(this.room);
    this.stop.disabled = !runs;
    // What is set before the start would not be gentle.
    this.training.controls.hidden = !runs && !this.ofVisit;
    if (!runs) void this.lower();
    this.leave.hidden = runs || this.room.clinic.stage !== 'in';
    const shown = JSON.stringify([model.scene?.parameters.map(({ name }) => String(name)), model.state?.parameters]);
    if (shown === this.shown) return;
    this.shown = shown;
    this.limits.replaceChildren(...(model.scene?.parameters ?? []).filter(({ name }) => String(name).startsWith('effort_limit_')).map((parameter) => {
      const view = viewOf(parameter, consoleTexts().parameters.names);
      const [name, words] = parameterWords(view.name, model.parameter(view.name) ?? parameter.initial);
      return h('div', {}, h('dt', {}, name), h('dd', {}, words));
    }));
  }

  draw(): void { this.training.draw(); }
  take(events: readonly EventT[]): void { this.training.take(events); }
  sceneChanged(): void { this.training.sceneChanged(); }
  close(): void { this.training.close(); }

  /** What holds above the gentle preset, of a session that is not a visit's and does not run yet. */
  private get above(): readonly (readonly [name: string, value: number])[] {
    const { room: { model, clinic } } = this;
    if (this.ofVisit || running(this.room)) return [];
    return Object.entries(clinic.gentle).filter(([name, value]) => (model.parameter(name) ?? 0) > value * (1 + 1e-6));
  }

  /** Whoever had a limit raised has gone. */
  private async lower(): Promise<void> {
    const { model } = this.room;
    if (this.lowering) return;
    this.lowering = true;
    for (const [name, value] of this.above) await model.command(name, () => model.connection.setParameter(name, value), { quietly: true });
    this.lowering = false;
  }

  private get ofVisit(): boolean { return Number(this.room.model.scene?.visit ?? 0) !== 0; }
  private get hand(): OneSide | undefined { return this.room.model.scene ? (this.room.model.scene.rightHand ? 'right' : 'left') : undefined; }
}
