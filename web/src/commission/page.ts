import { icon } from '../console/icons';
import { toggleTheme } from '../console/theme';
import { h } from '../console/dom';
import type { Connection } from '../net/connection';
import { fill, language, LANGUAGES, setLanguage, type Language } from '../shared/i18n';
import { texts as consoleTexts } from '../console/i18n';
import { texts } from './i18n';
import { StepList } from './step_list';
import { TaskCard } from './task_card';
import { stepNow, taskOf } from './view';

/** A program that sends no commissioning message within this time after its welcome commissions nothing [ms]. */
const SAYS_WITHIN_MS = 1500;

/** The page that guides a person through the commissioning of a device; its content comes from the program. */
export class CommissionPage {
  private stationWithoutCommissioning = false;
  private card: TaskCard | undefined;
  private list = new StepList();
  private about = h('p', { class: 'about' });
  private unconfirmed = h('p');

  constructor(private readonly root: HTMLElement, private readonly connection: Connection) {
    this.build();
    for (const what of ['commissioning', 'controls', 'status', 'scene', 'leaving'] as const) connection.on(what, () => this.show());
    connection.on('welcome', () => setTimeout(() => { this.stationWithoutCommissioning = true; this.show(); }, SAYS_WITHIN_MS));
  }

  /** Builds the page again, in the current language. */
  build(): void {
    const t = texts();
    this.card?.close();
    this.card = new TaskCard(this.connection);
    this.list = new StepList();
    this.about = h('p', { class: 'about' });
    const { unconfirmed, unconfirmedMore } = consoleTexts().notices;
    this.unconfirmed = h('p', { class: 'notice alarm', role: 'alert', hidden: true, 'data-testid': 'stop-unconfirmed' }, h('strong', {}, unconfirmed), ` ${unconfirmedMore}`);
    const stop = h('button', { type: 'button', class: 'b stop', 'data-testid': 'emergency-stop' }, icon('stop'), t.stop);
    // Stop acts on pointerdown, not on release.
    for (const press of ['pointerdown', 'click']) stop.addEventListener(press, () => this.stop());
    const languages = h('select', { 'aria-label': t.language, class: 'lang', 'data-testid': 'language' },
      ...LANGUAGES.map((key) => h('option', { value: key, selected: key === language(), lang: key }, key.toUpperCase())));
    languages.addEventListener('change', () => setLanguage(languages.value as Language));
    const theme = h('button', { type: 'button', class: 'b icon', 'aria-label': t.theme, title: t.theme, onclick: () => toggleTheme() }, icon('theme'));
    this.root.replaceChildren(
      h('header', { class: 'top' }, h('div', { class: 'brand' }, icon('logo'), 'Wholehand'), this.about, h('span', { class: 'sp' }), languages, theme, stop),
      this.unconfirmed, h('p', { class: 'rule' }, t.rule),
      h('main', { class: 'commission' }, this.card.element, this.list.element));
    this.show();
  }

  private stop(): void {
    this.card?.letGo();
    void this.connection.emergencyStop();
  }

  private show(): void {
    const { connection } = this;
    const t = texts();
    const c = connection.commissioning;
    const title = c?.daily ? t.daily : t.title;
    document.title = `${title}: Wholehand`;
    const task = taskOf(c, connection.status, connection.controls, this.stationWithoutCommissioning);
    document.body.dataset.task = task;
    this.about.replaceChildren(h('b', {}, title),
      c ? fill(t.by, { device: String(c.device), serial: String(c.serial), operator: String(c.operatorName) }) : '');
    if (this.unconfirmed.hidden === connection.stopUnconfirmed) this.unconfirmed.hidden = !connection.stopUnconfirmed;
    this.list.show(c);
    this.card?.show(task, c, c ? stepNow(c) : -1);
  }
}

