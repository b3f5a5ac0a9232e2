import { h } from '../console/dom';
import { RefusalError } from './api';
import { texts } from './i18n';
import type { ClinicContext } from './clinic_context';
import { staffOf, type Tile } from './records';
import { button, Field, form, StatusMessage, submitButton, textInput, type Screen } from './ui';

/** Colours of tiles; white text on each has a contrast of at least 4.5. */
export const COLOURS = ['#0B6B58', '#1F5FC4', '#8E0B4E', '#7A4B00', '#5A3E9B', '#A1141A'] as const;

/** A tile's colour as a style; grey without a valid colour. */
export const inColour = (colour = ''): string => `background: ${/^#[0-9a-f]{6}$/i.test(colour) ? colour : '#5A534C'}`;

export const pinInput = (test: string, autocomplete: 'new-password' | 'current-password' | 'off'): HTMLInputElement => textInput(test, '', { type: 'password', inputmode: 'numeric', maxlength: 8, autocomplete });

// The mistake in a field; the empty text where there is none.
export const badPin = ({ input }: Field): string => (/^\d{4,8}$/.test(input.value) ? '' : texts().first.badPin);
export const noName = ({ input }: Field): string => (input.value.trim() === '' ? texts().first.noName : '');
export const shortPhrase = ({ input }: Field): string => ([...input.value].length < 8 ? texts().first.short : '');
export const otherPhrase = (again: Field, first: Field): string => (again.input.value === first.input.value ? '' : texts().first.differs);

export const initials = (name: string): string => name.split(/\s+/).filter(Boolean).slice(0, 2).map((word) => [...word][0].toUpperCase()).join('');

/** Buttons to choose a tile's colour by its name. */
export function colourChoice(chosen: string): { element: HTMLElement; value: () => string } {
  const t = texts().tile;
  const radios = COLOURS.map((colour, i) => h('input', { type: 'radio', name: 'tile-colour', value: colour, checked: colour === chosen, 'aria-label': t.colours[i] }));
  return {
    element: h('fieldset', { class: 'colours' }, h('legend', {}, t.colour), ...radios.map((radio) => h('label', { style: `background: ${radio.value}` }, radio))),
    value: () => radios.find((radio) => radio.checked)?.value ?? chosen,
  };
}

/** Unlocks the records for the day, by the pass phrase or the printed recovery code. */
export class UnlockScreen implements Screen {
  readonly element = h('main', { class: 'gate' });
  private byCode = false;

  constructor(private readonly context: ClinicContext) { this.show(); }

  private show(): void {
    const t = texts().unlock, { byCode } = this;
    const field = new Field(byCode ? t.code : t.phrase, textInput('unlock-words', '', byCode ? {} : { type: 'password', autocomplete: 'current-password' }));
    const go = submitButton(t.open, 'unlock', 'go wide');
    const message = new StatusMessage();
    this.element.replaceChildren(form({ class: 'panel narrow', 'aria-label': t.title }, go, message, async () => {
      message.show('');
      try {
        await this.context.clinic.api.send('POST', '/api/unlock', byCode ? { recovery_code: field.input.value.trim() } : { pass_phrase: field.input.value });
        await this.context.clinic.look();
      } catch (problem) {
        field.input.select();
        if (!(problem instanceof RefusalError) || problem.field !== 'recovery_code') throw problem;
        message.show(t.mistyped);
      }
    }, h('h2', {}, t.title), h('p', {}, t.words), field.element, message.element, go, button(byCode ? t.byPhrase : t.byCode, 'unlock-other', () => { this.byCode = !byCode; this.show(); }, 'wide')));
    field.input.focus();
  }
}

/** Tiles of the accounts, then the PIN pad of the chosen one. */
export class WhoScreen implements Screen {
  readonly element = h('main', { class: 'gate' });
  private readonly t = texts().who;

  constructor(private readonly context: ClinicContext) {
    const { clinic } = context;
    const tiles = staffOf(clinic.state);
    const same = clinic.stage === 'hidden' ? tiles.find(({ id }) => id === clinic.account) : undefined;
    if (same) this.pad(same);
    else if (tiles.length === 1) this.pad(tiles[0]);
    else this.tiles();
  }

  private tiles(): void {
    const { t } = this;
    this.element.replaceChildren(h('section', { class: 'panel narrow', 'aria-label': t.title }, h('h2', {}, t.title),
      h('div', { class: 'tiles' }, ...staffOf(this.context.clinic.state).map((tile) => {
        const press = button('', `tile-${tile.id}`, () => this.pad(tile), 'tile');
        press.replaceChildren(face(tile), h('span', {}, tile.name));
        return press;
      }))));
    this.element.querySelector<HTMLElement>('.tile')?.focus();
  }

  private pad(tile: Tile): void {
    const { t } = this, { clinic } = this.context;
    const hidden = clinic.stage === 'hidden' && tile.id === clinic.account;
    const field = new Field(t.pin, pinInput('pin', 'off'));
    const { input } = field;
    const message = new StatusMessage();
    const go = submitButton(t.ok, 'pin-ok', 'go');
    const key = (digit: string): HTMLElement => button(digit, `key-${digit}`, () => { input.value += digit; }, 'key');
    const back = button('⌫', 'key-back', () => { input.value = input.value.slice(0, -1); }, 'key', { 'aria-label': t.back });
    this.element.replaceChildren(form({ class: 'panel narrow pad', 'aria-label': hidden ? t.again : t.title }, go, message, async () => {
      message.show('');
      try {
        if (hidden) await clinic.show(input.value);
        else await clinic.signedIn(await clinic.api.send('POST', '/api/sign_in', { account: tile.id, pin: input.value }));
        await clinic.look();
      } catch (problem) {
        input.value = '';
        input.focus();
        throw problem;
      }
    }, h('h2', {}, hidden ? t.again : t.title), h('p', { class: 'whose' }, face(tile), h('b', {}, tile.name)), hidden ? h('p', {}, t.kept) : null, field.element, message.element,
    h('div', { class: 'keys' }, ...[...'123456789'].map(key), back, key('0'), go), staffOf(clinic.state).length > 1 ? button(t.other, 'other-tile', () => this.tiles(), 'wide') : null));
    input.focus();
  }
}

const face = ({ name, colour }: Tile): HTMLElement => h('span', { class: 'face', 'aria-hidden': 'true', style: inColour(colour) }, initials(name));
