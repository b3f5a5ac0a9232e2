import type { EventT } from '../protocol';
import { fact, h, setText } from '../console/dom';
import { viewOf } from '../console/parameter_model';
import { texts as consoleTexts } from '../console/i18n';
import { Changes } from '../shared/changes';
import { texts } from './i18n';
import type { ClinicContext } from './clinic_context';
import type { OneSide } from './records';
import { gently, running, SideQuestion, Training } from './training';
import { button, StatusMessage, type Screen } from './ui';
import { itemWords, parameterWords, sideWords } from './words';

/** A session while the records do not answer. An open visit continues with its own limits; a new session has the gentle limits and is assigned to a patient later. */
export class AloneScreen implements Screen {
  readonly element = h('main', { class: 'visit' });
  private readonly t = texts().alone;
  private readonly training: Training;
  private readonly side: SideQuestion;
  private readonly message = new StatusMessage();
  private readonly title = h('h2', {});
  private readonly words = h('p', {});
  private readonly limits = h('dl', { class: 'facts' });
  private readonly stop: HTMLButtonElement;
  private readonly leave: HTMLButtonElement;
  private readonly changes = new Changes();
  private lowering = false;

  constructor(private readonly context: ClinicContext) {
    const { t } = this;
    this.training = new Training(context);
    this.side = new SideQuestion(`alone-${Date.now()}`, () => this.hand, t.wrongSide, () => this.refresh());
    this.stop = button(texts().visit.stop, 'gentle-stop', async () => { if (!await gently(context, texts().visit.stop)) this.message.show(texts().visit.doesNotStop); }, 'wide');
    this.leave = button(t.leave, 'leave-alone', () => context.go({ at: 'patients' }), 'wide');
    this.element.append(h('div', { class: 'col seen' }, this.side.element, this.training.picture),
      h('div', { class: 'col' }, h('section', { class: 'panel planned', 'aria-label': t.title, 'data-testid': 'alone' }, this.title, this.words, this.limits, this.message.element, this.stop, this.leave), this.training.controls));
    this.training.begin();
    this.refresh();
  }

  who(): readonly [string, string] { return [this.ofVisit ? texts().visit.hiddenName : texts().visit.noPatient, [this.hand ? sideWords(this.hand) : '', this.ofVisit ? '' : texts().visit.gentle].filter(Boolean).join(' · ')]; }
  what(): readonly [string, string] {
    const { scene, recorded } = this.context.model, t = texts().visit;
    return [itemWords({ exercise: String(scene?.exerciseName ?? ''), level: scene?.level ?? 0 }), recorded === undefined ? '' : recorded ? t.recorded : t.unrecorded];
  }
  startable(): boolean { return this.side.confirmed && this.above.length === 0; }

  refresh(): void {
    const { t, context: { model } } = this;
    setText(this.title, this.ofVisit ? t.visitGoesOn : t.title);
    setText(this.words, this.ofVisit ? t.visitWords : t.words);
    this.side.refresh();
    this.training.refresh();
    const runs = running(this.context);
    this.stop.disabled = !runs;
    // Values set before the start would replace the gentle preset, so the controls are hidden until then.
    this.training.controls.hidden = !runs && !this.ofVisit;
    if (!runs) void this.lower();
    this.leave.hidden = runs || this.context.clinic.stage !== 'in';
    if (!this.changes.of(model.scene?.parameters.map(({ name }) => String(name)), model.state?.parameters)) return;
    this.limits.replaceChildren(...(model.scene?.parameters ?? []).filter(({ boundsEffort }) => boundsEffort).map((parameter) => {
      const view = viewOf(parameter, consoleTexts().parameters.names);
      const [name, words] = parameterWords(view.name, model.parameter(view.name) ?? parameter.initial);
      return fact(name, words);
    }));
  }

  draw(): void { this.training.draw(); }
  take(events: readonly EventT[]): void { this.training.take(events); }
  sceneChanged(): void { this.training.sceneChanged(); }
  close(): void { this.training.close(); }

  /** Parameters above the gentle preset, in a session that belongs to no visit and is not running. */
  private get above(): readonly (readonly [name: string, value: number])[] {
    const { context: { model, clinic } } = this;
    if (this.ofVisit || running(this.context)) return [];
    return Object.entries(clinic.gentle).filter(([name, value]) => (model.parameter(name) ?? 0) > value * (1 + 1e-6));
  }

  /** Lowers parameters that were raised earlier back to the gentle preset. */
  private async lower(): Promise<void> {
    const { model } = this.context;
    if (this.lowering) return;
    this.lowering = true;
    for (const [name, value] of this.above) await model.command(name, () => model.connection.setParameter(name, value), { quietly: true });
    this.lowering = false;
  }

  private get ofVisit(): boolean { return Number(this.context.model.scene?.visit ?? 0) !== 0; }
  private get hand(): OneSide | undefined { return this.context.model.scene ? (this.context.model.scene.rightHand ? 'right' : 'left') : undefined; }
}
