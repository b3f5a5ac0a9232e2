import { h } from '../console/dom';
import { fill } from '../shared/i18n';
import { texts } from './i18n';
import type { ClinicContext } from './clinic_context';
import { otherPhrase, shortPhrase } from './sign_in';
import { action, Field, form, panel, refused, StatusMessage, submitButton, textInput } from './ui';

interface Changed { readonly recovery_code?: string; readonly old_copies: readonly string[] }

/** Changes the pass phrase and the recovery code. The clinic's key stays. */
export function keysPanel(context: ClinicContext): HTMLElement {
  const t = texts().keys, first = texts().first, { api } = context.clinic;
  const now = new Field(t.now, textInput('phrase-now', '', { type: 'password', autocomplete: 'current-password' }));
  const phrase = new Field(t.phrase, textInput('phrase-new', '', { type: 'password', autocomplete: 'new-password' }), { hint: first.phraseHint });
  const again = new Field(first.again, textInput('phrase-again', '', { type: 'password', autocomplete: 'new-password' }));
  const message = new StatusMessage(), code = h('p', { class: 'code', 'data-testid': 'new-code' });
  const done = (words: string, { old_copies }: Changed): void => message.show([words, ...(old_copies.length > 0 ? [fill(t.old, { files: old_copies.join(', ') })] : [])].join(' '));
  /** The pass phrase that is typed, or the recovery code in its place. */
  const secret = (): Record<string, string> => ({ [/^[0-9A-Za-z]{5}(-[0-9A-Za-z]{5}){5}$/.test(now.input.value.trim()) ? 'recovery_code' : 'pass_phrase']: now.input.value.trim() });
  const change = submitButton(t.change, 'change-phrase', 'go');
  const draw = action(t.draw, 'draw-code', message, async () => {
    const changed = await api.send<Changed>('POST', '/api/recovery_code', secret());
    code.textContent = changed.recovery_code ?? '';
    done(first.code.paper, changed);
  });
  return panel(t.title, 'keys', h('p', {}, t.words), form({}, change, message, async () => {
    if (refused([phrase, shortPhrase(phrase)], [again, otherPhrase(again, phrase)])) return;
    done(t.done, await api.send<Changed>('POST', '/api/phrase', { ...secret(), new_pass_phrase: phrase.input.value }));
    now.input.value = phrase.input.value = again.input.value = '';
  }, now.element, phrase.element, again.element, message.element, code, h('div', { class: 'pair' }, change, draw)));
}
