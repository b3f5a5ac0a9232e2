import { h } from '../console/dom';
import { fill } from '../shared/i18n';
import { texts } from './i18n';
import type { ClinicContext } from './clinic_context';
import { RefusalError } from './api';
import type { SignInResult } from './clinic';
import { COLOURS, colourChoice, goodPin } from './sign_in';
import { button, Field, once, problemWords, StatusMessage, textInput, type Screen } from './ui';

/** Creates the clinic: pass phrase, first account tile, and the recovery code, which is shown only once. */
export class FirstStart implements Screen {
  readonly element = h('main', { class: 'gate' });
  stays = false;
  private readonly t = texts().first;
  private readonly phrase = new Field(this.t.phrase, textInput('pass-phrase', '', { type: 'password', autocomplete: 'new-password' }), { hint: this.t.phraseHint });
  private readonly again = new Field(this.t.again, textInput('pass-phrase-again', '', { type: 'password', autocomplete: 'new-password' }));
  private readonly name = new Field(this.t.name, textInput('tile-name', '', { maxlength: 60 }));
  private readonly pin = new Field(this.t.pin, textInput('tile-pin', '', { type: 'password', inputmode: 'numeric', maxlength: 8, autocomplete: 'off' }), { hint: this.t.pinHint });
  private readonly colour = colourChoice(COLOURS[0]);
  private readonly message = new StatusMessage();

  constructor(private readonly context: ClinicContext) {
    const { t } = this;
    const make = h('button', { type: 'submit', class: 'b go wide', 'data-testid': 'make-clinic' }, t.make);
    const folder = context.clinic.state?.folder;
    const where = !folder ? null : h('p', { class: folder.empty ? 'warning' : '', 'data-testid': 'folder' }, [fill(t.folder, { path: folder.path }), ...(folder.empty ? [t.folderEmpty, t.folderAsk] : [])].join(' '));
    const form = h('form', { class: 'panel narrow', 'aria-label': t.title }, h('h2', {}, t.title), h('p', {}, t.words), where,
      this.phrase.element, this.again.element, h('h3', {}, t.tile), this.name.element, this.colour.element, this.pin.element, this.message.element, make);
    form.addEventListener('submit', (event) => { event.preventDefault(); void once(make, () => this.make()); });
    this.element.append(form);
  }

  private async make(): Promise<void> {
    const { t, phrase, again, name, pin } = this;
    phrase.refuse([...phrase.input.value].length < 8 ? t.short : '');
    again.refuse(again.input.value === phrase.input.value ? '' : t.differs);
    name.refuse(name.input.value.trim() === '' ? t.noName : '');
    pin.refuse(goodPin(pin.input.value) ? '' : t.badPin);
    const wrong = [phrase, again, name, pin].find(({ input }) => input.getAttribute('aria-invalid') === 'true');
    if (wrong) return wrong.input.focus();
    this.message.show('');
    this.stays = true;
    try {
      const made = await this.context.clinic.api.send<SignInResult & { recovery_code: string }>('POST', '/api/init',
        { pass_phrase: phrase.input.value, tile: { name: name.input.value.trim(), colour: this.colour.value(), pin: pin.input.value } });
      this.showCode(made);
    } catch (problem) {
      this.stays = false;
      if (problem instanceof RefusalError && problem.field.includes('pass_phrase')) phrase.refuse(problemWords(problem));
      else this.message.showProblem(problem);
    }
  }

  /** Shows the recovery code; the page continues only after it is confirmed. */
  private showCode(made: SignInResult & { readonly recovery_code: string }): void {
    const t = this.t.code;
    const kept = h('input', { type: 'checkbox', id: 'code-kept', 'data-testid': 'code-kept' });
    const on = button(t.on, 'code-done', async () => {
      await this.context.clinic.signedIn(made);
      this.stays = false;
      void this.context.clinic.look();
    }, 'go wide');
    on.disabled = true;
    kept.addEventListener('change', () => { on.disabled = !kept.checked; });
    this.element.replaceChildren(h('section', { class: 'panel narrow', 'aria-label': t.title }, h('h2', {}, t.title), h('p', {}, t.words),
      h('p', { class: 'code', 'data-testid': 'recovery-code', tabindex: -1 }, made.recovery_code), h('p', { class: 'paper' }, t.paper),
      button(t.print, 'print-code', () => print(), 'wide'), h('label', { class: 'tick', for: 'code-kept' }, kept, t.kept), on));
    this.element.querySelector<HTMLElement>('.code')?.focus();
  }
}
