import { RunState } from '../protocol';
import { fill } from '../shared/i18n';
import { h, setText, setClass } from './dom';
import { texts } from './i18n';
import type { ConsoleModel } from './model';

/** Shows the open profile, saves the settings under a name, and loads another profile before the start. */
export class ProfileRow {
  readonly element: HTMLElement;
  private readonly t = texts().profile;
  private readonly name = h('input', { type: 'text', id: 'profile', list: 'profiles', maxlength: 60, pattern: '[A-Za-z0-9_\\-]+', autocomplete: 'off', spellcheck: 'false', 'data-testid': 'profile' });
  private readonly save: HTMLButtonElement;
  private readonly load: HTMLButtonElement;
  private readonly now = h('span', {});

  constructor(private readonly model: ConsoleModel) {
    const { t, name } = this;
    const { scene } = model;
    name.value = String(scene?.profile ?? '');
    name.placeholder = t.nameHint;
    name.title = t.name;
    const button = (words: string, id: string, onClick: () => void): HTMLButtonElement => {
      const element = h('button', { type: 'button', class: 'b small', 'data-testid': id }, words);
      element.addEventListener('click', onClick);
      return element;
    };
    this.save = button(t.save, 'save-profile', () => void model.command(t.save, () => model.connection.saveProfile(name.value.trim())));
    this.load = button(t.load, 'load-profile', () => void model.command(t.load, () => model.connection.loadProfile(name.value.trim())));
    name.addEventListener('input', () => this.refresh());
    this.element = h('div', { class: 'profile' }, h('label', { for: 'profile', role: 'status' }, this.now), name,
      h('datalist', { id: 'profiles' }, ...(scene?.profiles ?? []).map((known) => h('option', { value: String(known) }))), this.load, this.save);
    this.refresh();
  }

  refresh(): void {
    const { t, model, name } = this;
    const whose = String(model.scene?.profile ?? '');
    const wrong = name.value.trim() !== '' && !name.validity.valid;
    setText(this.now, wrong ? t.rule : fill(t.profile, { name: whose || t.noProfile }));
    setClass(this.now, 'refusal', wrong);
    const named = name.value.trim() !== '' && name.validity.valid;
    const known = (model.scene?.profiles ?? []).some((profile) => String(profile) === name.value.trim());
    const armed = model.state?.runState === RunState.Rendering || model.state?.runState === RunState.Stopping;
    this.save.disabled = !named;
    this.load.disabled = !known || armed;
    this.load.title = armed ? t.stopFirst : '';
  }
}
