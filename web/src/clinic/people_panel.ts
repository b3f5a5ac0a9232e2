import { h } from '../console/dom';
import { fill } from '../shared/i18n';
import { RefusalError } from './api';
import { texts } from './i18n';
import type { ClinicContext } from './clinic_context';
import { staffOf } from './records';
import { badPin, COLOURS, colourChoice, inColour, noName, pinInput } from './sign_in';
import { Field, form, panel, refused, StatusMessage, submitButton, textInput, twice } from './ui';

/** Who works here: taking a colleague off, one's own PIN, somebody new. */
export class PeoplePanel {
  readonly element: HTMLElement;
  private readonly t = texts().settings;
  private readonly list = h('ul', { class: 'people' });
  private readonly message = new StatusMessage();

  constructor(private readonly context: ClinicContext) {
    this.element = panel(this.t.people, 'people', this.list, this.message.element, this.ownPin(), this.somebodyNew());
    this.show();
  }

  private show(): void {
    const { t, context: { clinic } } = this;
    this.list.replaceChildren(...staffOf(clinic.state).map((tile) => h('li', {}, h('i', { style: inColour(tile.colour) }), h('span', { class: 'grow' }, tile.name),
      tile.id === clinic.account ? h('small', {}, t.you) : twice(t.leaves, fill(t.leavesYes, { name: tile.name }), `leave-${tile.id}`, this.message, async () => {
        await clinic.api.send('POST', `/api/accounts/${tile.id}/leave`);
        await clinic.look();
      }, () => this.show()))));
  }

  private ownPin(): HTMLElement {
    const { t, context: { clinic } } = this;
    const now = new Field(t.pinNow, pinInput('pin-now', 'current-password'));
    const next = new Field(t.pinNew, pinInput('pin-new', 'new-password'), { hint: texts().first.pinHint });
    const message = new StatusMessage(), done = h('p', { role: 'status', 'data-testid': 'pin-changed' });
    const press = submitButton(t.pinChange, 'change-pin');
    return h('details', {}, h('summary', { 'data-testid': 'own-pin' }, t.ownPin), form({}, press, message, async () => {
      message.show('');
      done.textContent = '';
      if (refused([next, badPin(next)])) return;
      try {
        await clinic.api.send('POST', '/api/pin', { pin: now.input.value, new_pin: next.input.value });
      } catch (problem) {
        if (problem instanceof RefusalError && problem.code === 'wrong_pin') now.input.select();
        throw problem;
      }
      done.textContent = t.pinChanged;
      now.input.value = next.input.value = '';
    }, now.element, next.element, message.element, done, press));
  }

  private somebodyNew(): HTMLElement {
    const { t, context: { clinic } } = this;
    const name = new Field(t.name, textInput('account-name', '', { maxlength: 60 }));
    const pin = new Field(texts().first.pin, pinInput('account-pin', 'new-password'), { hint: texts().first.pinHint });
    const colour = colourChoice(COLOURS[(clinic.state?.tiles.length ?? 0) % COLOURS.length]);
    const message = new StatusMessage();
    const add = submitButton(t.add, 'add-account', 'go');
    return form({}, add, message, async () => {
      if (refused([name, noName(name)], [pin, badPin(pin)])) return;
      await clinic.api.send('POST', '/api/accounts', { name: name.input.value.trim(), colour: colour.value(), pin: pin.input.value });
      message.show('');
      name.input.value = pin.input.value = '';
      await clinic.look();
      this.show();
    }, h('h3', {}, t.newPerson), name.element, colour.element, pin.element, message.element, add);
  }
}
