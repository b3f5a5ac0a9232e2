import 'uplot/dist/uPlot.min.css';
import '../shared/tokens.css';
import '../console/console.css';
import './charts.css';
import { h } from '../console/dom';
import { icon } from '../console/icons';
import { startTheme } from '../console/theme';
import { pageData } from '../embedded/page_data';
import { headerButtons } from '../replay/header';
import { asProblem, Problem } from '../replay/problem';
import { onLanguage, startLanguage } from '../shared/i18n';
import { answerPresses } from '../shared/pressed';
import { FONT } from '../shared/chart_marks';
import { redrawCharts } from './chart';
import { readChartPage, type ChartPageData } from './chart_page_data';
import { texts } from './i18n';
import { chartSheet } from './sheet';
import { wordsOf } from './words';

const root = document.querySelector<HTMLElement>('#charts')!;
let data: ChartPageData | undefined;
let refused: { words: 'template' | 'broken'; problem?: Problem } | undefined;

function problemPanel(words: 'template' | 'broken', problem?: Problem): HTMLElement {
  const t = texts().problems;
  return h('section', { class: 'panel problem', role: 'alert', 'data-testid': 'problem', 'data-kind': words }, h('h2', {}, t[words]),
    problem ? h('p', {}, t.says) : null, problem ? h('pre', { lang: 'en', dir: 'ltr' }, problem.text) : null);
}

/** Builds the page again, in the current language and colours. */
function build(): void {
  const t = texts();
  document.title = data ? wordsOf(data.title).slice(0, 200) : t.charts;
  root.replaceChildren(
    h('header', { class: 'top' }, h('p', { class: 'brand' }, icon('logo'), t.charts), h('span', { class: 'sp' }),
      data ? h('button', { type: 'button', class: 'b', 'data-testid': 'print', onclick: () => print() }, t.print) : null, headerButtons(build, false)),
    h('main', {}, data ? chartSheet(data) : problemPanel(refused?.words ?? 'broken', refused?.problem)));
}

function read(): void {
  try {
    const carried = pageData(document);
    if (carried) data = readChartPage(carried);
    else refused = { words: 'template' };
  } catch (thrown) {
    refused = { words: 'broken', problem: thrown instanceof SyntaxError ? new Problem('nonsense', 'the file is cut, or damaged') : asProblem(thrown) };
  }
}

/** Switches to light colours for printing. */
function printLight(): void {
  const { dataset } = document.documentElement;
  let theme = dataset.theme;
  const paint = (name: string | undefined): void => {
    dataset.theme = name;
    redrawCharts(root);
  };
  addEventListener('beforeprint', () => { theme = dataset.theme; paint('light'); });
  addEventListener('afterprint', () => paint(theme));
}

/** Resolves when all charts are drawn, which happens once they are in the page. */
async function allDrawn(): Promise<void> {
  while (root.querySelector('.chart:not(:has(canvas))')) await new Promise(requestAnimationFrame);
}

/** Waits for the fonts, since a drawn canvas does not change when its font is loaded. */
async function open(): Promise<void> {
  read();
  await document.fonts.load(`11px ${FONT}`);
  build();
  await allDrawn();
  document.body.dataset.state = refused ? 'problem' : 'shown';
}

startTheme();
startLanguage();
answerPresses(document);
onLanguage(build);
printLight();
void open();
