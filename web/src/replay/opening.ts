import { h } from '../console/dom';
import { icon } from '../console/icons';
import { headerButtons } from './header';
import { texts } from './i18n';
import type { Problem } from './problem';

/** The page before a recording is open, or if it cannot be opened. */
export function openingPage(name: string, problem: Problem | 'none' | undefined, again: () => void): HTMLElement[] {
  const t = texts();
  document.title = t.brand;
  document.body.dataset.state = problem === undefined ? 'opening' : 'problem';
  const header = h('header', { class: 'top' }, h('h1', { class: 'brand' }, icon('logo'), t.brand), h('span', { class: 'sp' }), headerButtons(again));
  if (problem === undefined) return [header, h('div'), h('main', { class: 'replay alone' }, h('p', { class: 'none', role: 'status' }, t.opening))];
  const kind = problem === 'none' ? 'none' : problem.kind;
  const text = problem === 'none' ? '' : problem.text;
  return [header, h('div'), h('main', { class: 'replay alone' }, h('section', { class: 'panel problem', role: 'alert', 'data-testid': 'problem', 'data-kind': kind },
    h('h2', {}, t.problems[kind]),
    name === '' ? null : h('p', { class: 'called' }, h('bdi', { title: name }, name)),
    text === '' ? null : h('p', {}, h('span', { class: 'aside' }, `${t.problems.says} `)), text === '' ? null : h('pre', { lang: 'en', dir: 'ltr' }, text),
    h('p', { class: 'row' }, kind === 'none' ? null : h('button', { type: 'button', class: 'b go', 'data-testid': 'again', onclick: again }, t.problems.again),
      h('a', { class: 'b', href: '/console' }, t.problems.console))))];
}
