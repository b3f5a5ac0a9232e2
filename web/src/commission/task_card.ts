import { h, setText } from '../console/dom';
import { texts as consoleTexts } from '../console/i18n';
import type { Connection } from '../net/connection';
import type { Answer } from '../net/pending_answers';
import { QuestionKind, MotionKind, MotionState, Role, type CommissioningT } from '../protocol';
import { Changes } from '../shared/changes';
import { FreshButtons } from '../shared/fresh_buttons';
import { fill } from '../shared/i18n';
import { HoldButton } from './hold_button';
import { texts } from './i18n';
import { numbers, repeatable, typedNumber, type Task } from './view';

let presses = 0;  // number of presses on this page

const sentence = (words: string): string => words.charAt(0).toUpperCase() + words.slice(1);

/** The current task of the person: a question, a button to hold, or the reason for waiting. */
export class TaskCard {
  private readonly t = texts();
  private readonly head = h('h1', { class: 'head', tabindex: -1 });
  private readonly more = h('p', { class: 'more' });
  private readonly note = h('p', { class: 'said', role: 'alert' });
  private readonly body = h('div', { class: 'body' });
  readonly element = h('section', { class: 'panel task', 'aria-live': 'polite' }, this.head, this.more, this.body, this.note);
  private readonly fresh = new FreshButtons(this.body);
  private button: HoldButton | undefined;
  private word: HTMLElement | undefined;
  private bar: HTMLElement | undefined;
  private readonly changes = new Changes();
  private refusal = '';
  private task: Task = 'connecting';
  private now: CommissioningT | null = null;

  constructor(private readonly connection: Connection) {}

  show(task: Task, c: CommissioningT | null, step: number): void {
    this.task = task;
    this.now = c;
    // Every other task ends a held button.
    if (task !== 'hold') this.letGo();
    if (this.changes.of(task, task === 'hold' ? 0 : c?.question, task === 'next' ? c?.next : '', c?.asked, this.connection.controls.role)) {
      this.refusal = '';
      this.build(task, c, step);
    }
    if (task === 'hold') this.showMotion(c!);
    setText(this.note, this.refusal || (c && task !== 'next' ? String(c.note ?? '') : ''));
  }

  letGo(): void { this.button?.end(); }
  close(): void { this.button?.close(); }

  private build(task: Task, c: CommissioningT | null, step: number): void {
    const { t } = this;
    this.button?.close();
    this.button = this.word = this.bar = undefined;
    const focus = document.activeElement === document.body || this.element.contains(document.activeElement);
    const fills = c ? this.fills(c) : {};
    const put = (head: string, more: string, ...body: (Node | string)[]): void => {
      setText(this.head, sentence(fill(head, fills)));
      setText(this.more, fill(more, fills));
      this.body.replaceChildren(...body);
      this.fresh.changed();
    };
    switch (task) {
      case 'connecting': put(t.connecting, ''); break;
      case 'lost': put(t.lost, t.lostMore); break;
      case 'elsewhere': put(t.elsewhere, t.elsewhereMore); break;
      case 'lead': put(t.leadHead, t.leadMore, this.press('lead', t.lead, 'b go', () => this.connection.takeControls())); break;
      case 'watch':
        put(t.watchHead, t.watchMore);
        if (this.connection.controls.role === Role.Therapist) this.body.append(this.press('take-over', t.takeOver, 'b', () => this.connection.takeControls()));
        break;
      case 'yes-no': {
        const device = c!.asked === QuestionKind.ThisDevice;
        put(device ? t.ask.device : t.ask.nobody, device ? t.ask.deviceMore : t.ask.nobodyMore, this.answer('yes', device ? t.yes : t.ask.nobodyYes, 'b go'), this.answer('no', device ? t.no : t.ask.nobodyNo, 'b'));
        break;
      }
      case 'done': {
        const push = c!.asked === QuestionKind.PushAway;
        put(push ? t.ask.push : t.ask.estop, push ? t.ask.pushMore : t.ask.estopMore, this.answer('', t.done, 'b go'));
        break;
      }
      case 'number': {
        const travel = c!.asked === QuestionKind.Travel;
        put(travel ? t.ask.travel : t.ask.force, travel ? t.ask.travelMore : t.ask.forceMore, this.field(travel ? t.ask.travelField : t.ask.forceField, String(c!.unit)));
        break;
      }
      case 'next': put(t.ask.next, '', ...this.failed(c!, step)); break;
      case 'hold': put('', '', this.hold()); break;
      case 'wait': put(t.wait, t.waitMore); break;
      case 'finished': {
        const recording = String(c!.recording ?? '');
        put(c!.daily ? t.finishedDaily : t.finished, c!.daily ? '' : t.needsDaily, h('p', { class: 'file', 'data-testid': 'passport' }, String(c!.passport)));
        if (recording !== '') this.body.append(h('p', { class: 'file' }, fill(t.finishedMore, { recording })));
      }
    }
    // A key that is still down must confirm nothing, so no answer button gets the focus automatically.
    if (focus) (this.body.querySelector<HTMLElement>('.hold, input') ?? this.head).focus();
  }

  private fills(c: CommissioningT): Record<string, string> {
    const axis = String(c.axis ?? '');
    const bound = (value: number): string => numbers({ lower: value, upper: value }, '');
    return {
      serial: String(c.serial), driver: String(c.driver), firmware: String(c.firmware), unit: String(c.unit ?? ''),
      axis: fill(this.t.axis, { name: consoleTexts().axes[axis] ?? axis }), way: this.t.away[axis] ?? this.t.plus, lower: bound(c.lower), upper: bound(c.upper),
    };
  }

  private showMotion(c: CommissioningT): void {
    const { t } = this;
    setText(this.head, c.motionState === MotionState.Over ? t.wait : sentence(fill(t.motion[c.motion] ?? MotionKind[c.motion], this.fills(c))));
    setText(this.more, t.holdMore);
    const moves = c.motionState === MotionState.Moves;
    if (this.word) setText(this.word, this.button?.held ? t.held : t.hold);
    if (!this.bar) return;
    this.bar.classList.toggle('moves', moves && c.motionS > 0);
    this.bar.style.setProperty('--motion', `${c.motionS}s`);
  }

  private hold(): HTMLElement {
    const { t, connection } = this;
    this.word = h('span', {}, t.hold);
    this.bar = h('span', { class: 'bar', 'aria-hidden': 'true' });
    const button = h('button', { type: 'button', class: 'hold', 'data-testid': 'hold' }, this.bar, this.word);
    this.button = new HoldButton(button, { window, document }, {
      nextPress: () => ++presses,
      send: (press, held) => void connection.holdToMove(press, held),
      changed: (held) => {
        button.classList.toggle('held', held);
        button.setAttribute('aria-pressed', String(held));
        if (this.word) setText(this.word, held ? t.held : t.hold);
      },
      allowed: () => this.task === 'hold' && connection.status === 'open' && connection.controls.heldByYou,
    });
    return button;
  }

  private field(label: string, unit: string): HTMLElement {
    const input = h('input', { type: 'text', inputmode: 'decimal', autocomplete: 'off', 'data-testid': 'number', 'aria-label': `${label} [${unit}]` });
    const question = this.now?.question ?? 0;
    const form = h('form', { class: 'number' }, h('label', {}, label, input), h('span', {}, unit), h('button', { type: 'submit', class: 'b go', 'data-testid': 'answer' }, this.t.go));
    form.addEventListener('submit', (event) => {
      event.preventDefault();
      const number = typedNumber(input.value);
      if (number === '') this.refuse(this.t.ask.noNumber);
      else void this.sendAnswer(question, number);
    });
    return form;
  }

  private failed(c: CommissioningT, step: number): HTMLElement[] {
    const { t } = this;
    const at = c.steps[step];
    const problems = at && String(at.problem ?? '') !== '' ? [h('dl', { class: 'failed', lang: 'en', 'data-testid': 'failed' },
      h('dt', {}, t.why), h('dd', {}, String(at.problem)), h('dt', {}, t.remedy), h('dd', {}, String(at.remedy)))] : [];
    const name = (key: string): string => t.step[key] ?? key;
    const on = c.daily ? t.ask.check : fill(t.ask.repeat, { step: name(String(c.next)) });
    const earlier = repeatable(c);
    const rest = h('details', { class: 'earlier', hidden: earlier.length === 0 }, h('summary', {}, t.ask.earlier),
      ...earlier.map((key) => this.answer(key, name(key), 'b small')));
    return [...problems, h('div', { class: 'row' }, this.answer('', on, 'b go'), this.answer('quit', t.ask.end, 'b')), rest];
  }

  private answer(words: string, label: string, look: string): HTMLElement {
    const question = this.now?.question ?? 0;
    return this.press(`answer-${words === '' ? 'done' : words}`, label, look, () => this.sendAnswer(question, words));
  }

  private press(id: string, label: string, look: string, act: () => Promise<Answer | undefined>): HTMLElement {
    const button = h('button', { type: 'button', class: look, 'data-testid': id }, label);
    button.addEventListener('click', () => void act().then((answer) => { if (answer && !answer.accepted) this.refuse(answer.reason); }));
    return button;
  }

  /** Answers the question that the pressed button was built for. */
  private async sendAnswer(question: number, words: string): Promise<undefined> {
    const answer = await this.connection.answer(question, words);
    if (!answer.accepted && question === this.now?.question) this.refuse(answer.reason);
  }

  private refuse(why: string): void {
    this.refusal = why;
    setText(this.note, why);
  }
}
