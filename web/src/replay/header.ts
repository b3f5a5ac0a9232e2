import { h, setText } from '../console/dom';
import { texts as consoleTexts } from '../console/i18n';
import { icon } from '../console/icons';
import { sessionWords } from '../console/title_words';
import { toggleTheme } from '../console/theme';
import { fill, language, LANGUAGES, setLanguage, type Language } from '../shared/i18n';
import { dateWords } from './facts_panel';
import { texts } from './i18n';
import type { ReplaySide } from './side';

/** The names of the recordings, the loaded share, and buttons for language and colours. */
export class Header {
  readonly element: HTMLElement;
  private readonly t = texts();
  private readonly progress = h('span', { class: 'aside num', role: 'status', 'data-testid': 'progress' });

  constructor(private readonly sides: readonly ReplaySide[], rebuild: () => void) {
    const { t } = this;
    const names = sides.map(({ about, source }) => sessionWords({ ...about, name: about.name || source.name }));
    document.title = fill(t.title, { name: names.join(', ').slice(0, 200) });
    this.element = h('header', { class: 'top' },
      h('h1', { class: 'brand' }, icon('logo'), t.brand), ...sides.map((side, i) => this.who(side, names[i])), h('span', { class: 'sp' }), this.progress,
      ...(sides.length === 1 ? [this.reportLink(sides[0].source.reportUrl, names[0])] : []), headerButtons(rebuild));
    this.refresh();
  }

  refresh(): void {
    const share = Math.min(...this.sides.map(({ series }) => series.progress));
    setText(this.progress, share < 1 ? fill(this.t.loading, { percent: Math.floor(100 * share) }) : '');
  }

  private who({ about }: ReplaySide, name: string): HTMLElement {
    return h('div', { class: 'who', title: name }, h('b', {}, h('bdi', {}, name)), h('span', {}, dateWords(about.created_utc, language())));
  }

  private reportLink(href: string, called: string): HTMLElement {
    return h('a', { class: 'b', href, target: href.startsWith('#') ? undefined : '_blank', rel: 'noopener', 'data-testid': 'report', 'aria-label': fill(this.t.reportOf, { name: called }) }, this.t.report);
  }
}

/** Buttons for language and colours, and for tables where there are plots that have them. */
export function headerButtons(rebuild: () => void, withTables = true): DocumentFragment {
  const t = consoleTexts();
  const languages = h('select', { 'aria-label': t.language, class: 'lang', 'data-testid': 'language' },
    ...LANGUAGES.map((key) => h('option', { value: key, selected: key === language(), lang: key }, key.toUpperCase())));
  languages.addEventListener('change', () => setLanguage(languages.value as Language));
  const theme = h('button', { type: 'button', class: 'b icon', 'aria-label': t.theme, title: t.theme, 'data-testid': 'theme', onclick: () => { toggleTheme(); rebuild(); } }, icon('theme'));
  const on = document.body.classList.contains('tables');
  const tables = h('button', { type: 'button', class: 'b icon', 'aria-label': t.tables, title: t.tables, 'aria-pressed': String(on), 'data-testid': 'tables' }, icon('table'));
  tables.addEventListener('click', () => tables.setAttribute('aria-pressed', String(document.body.classList.toggle('tables'))));
  const all = document.createDocumentFragment();
  all.append(languages, theme);
  if (withTables) all.append(tables);
  return all;
}
