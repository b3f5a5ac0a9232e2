import { h } from '../console/dom';
import { fill } from '../shared/i18n';
import { texts } from './i18n';
import type { ClinicContext } from './clinic_context';
import { RefusalError } from './api';
import type { SignInResult } from './clinic';
import { badPin, COLOURS, colourChoice, noName, otherPhrase, pinInput, shortPhrase } from './sign_in';
import { button, Field, form, problemWords, refused, StatusMessage, submitButton, textInput, type Screen } from './ui';

/** Creates the clinic: pass phrase, first account tile, and the recovery code, which is shown only once. */
export class FirstStart implements Screen {
  readonly element = h('main', { class: 'gate' });
  stays = false;
  private readonly t = texts().first;
  private readonly phrase = new Field(this.t.phrase, textInput('pass-phrase', '', { type: 'password', autocomplete: 'new-password' }), { hint: this.t.phraseHint });
  private readonly again = new Field(this.t.again, textInput('pass-phrase-again', '', { type: 'password', autocomplete: 'new-password' }));
  private readonly name = new Field(this.t.name, textInput('tile-name', '', { maxlength: 60 }));
  private readonly pin = new Field(this.t.pin, pinInput('tile-pin', 'off'), { hint: this.t.pinHint });
  private readonly colour = colourChoice(COLOURS[0]);
  private readonly message = new StatusMessage();

  constructor(private readonly context: ClinicContext) {
    const { t } = this;
    const make = submitButton(t.make, 'make-clinic', 'go wide');
    const folder = context.clinic.state?.folder;
    const where = !folder ? null : h('p', { class: folder.empty ? 'warning' : '', 'data-testid': 'folder' }, [fill(t.folder, { path: folder.path }), ...(folder.empty ? [t.folderEmpty, t.folderAsk] : [])].join(' '));
    this.element.append(form({ class: 'panel narrow', 'aria-label': t.title }, make, this.message, () => this.make(), h('h2', {}, t.title), h('p', {}, t.words), where,
      this.phrase.element, this.again.element, h('h3', {}, t.tile), this.name.element, this.colour.element, this.pin.element, this.message.element, make));
  }

  private async make(): Promise<void> {
    const { phrase, again, name, pin } = this;
    if (refused([phrase, shortPhrase(phrase)], [again, otherPhrase(again, phrase)], [name, noName(name)], [pin, badPin(pin)])) return;
    this.message.show('');
    this.stays = true;
    try {
      const made = await this.context.clinic.api.send<SignInResult & { recovery_code: string }>('POST', '/api/init',
        { pass_phrase: phrase.input.value, tile: { name: name.input.value.trim(), colour: this.colour.value(), pin: pin.input.value } });
      this.showCode(made);
    } catch (problem) {
      this.stays = false;
      if (!(problem instanceof RefusalError) || !problem.field.includes('pass_phrase')) throw problem;
      phrase.refuse(problemWords(problem));
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
    }, 'go wide', { disabled: true });
    kept.addEventListener('change', () => { on.disabled = !kept.checked; });
    this.element.replaceChildren(h('section', { class: 'panel narrow', 'aria-label': t.title }, h('h2', {}, t.title), h('p', {}, t.words),
      h('p', { class: 'code', 'data-testid': 'recovery-code', tabindex: -1 }, made.recovery_code), h('p', { class: 'paper' }, t.paper),
      button(t.print, 'print-code', () => print(), 'wide'), h('label', { class: 'tick', for: 'code-kept' }, kept, t.kept), on));
    this.element.querySelector<HTMLElement>('.code')?.focus();
  }
}
