import 'uplot/dist/uPlot.min.css';
import '../shared/tokens.css';
import '../console/console.css';
import '../replay/replay.css';
import './report.css';
import { h } from '../console/dom';
import { icon } from '../console/icons';
import { startTheme } from '../console/theme';
import { sessionWords } from '../console/title_words';
import { pageData } from '../embedded/page_data';
import { ExercisePanel } from '../exercises/panel';
import { headerButtons } from '../replay/header';
import { ReplayPage, type ReplayNow } from '../replay/page';
import { asProblem, Problem } from '../replay/problem';
import { ReplaySide, sceneOf } from '../replay/side';
import { fill, onLanguage, startLanguage } from '../shared/i18n';
import { answerPresses } from '../shared/pressed';
import { EmbeddedRecording } from './embedded_recording';
import { engineeringSheet } from './engineering_sheet';
import { texts } from './i18n';
import { readReport, type ReportData } from './report_data';
import { sheetContext } from './sheet';
import { therapySheet } from './therapy_sheet';

declare global {
  interface Window { wholehandReplay: ReplayNow | null }
}

/** "#replay=12.5" opens the viewer at a time. */
const REPLAY = /^#replay(?:=([\d.]+))?/;

const root = document.querySelector<HTMLElement>('#report')!;
const viewer = document.querySelector<HTMLElement>('#app')!;
let data: ReportData | undefined;
let refused: { words: 'template' | 'old' | 'broken'; problem?: Problem } | undefined;
let page: ReplayPage | undefined;

function topBar(): HTMLElement {
  const t = texts();
  return h('header', { class: 'top' }, h('h1', { class: 'brand' }, icon('logo'), t.report), h('span', { class: 'sp' }),
    data ? h('a', { class: 'b go', href: '#replay', 'data-testid': 'replay' }, icon('play'), t.replay) : null,
    data ? h('button', { type: 'button', class: 'b', 'data-testid': 'print', onclick: () => print() }, t.print) : null,
    headerButtons(build, false));
}

function problemPanel(): HTMLElement {
  const t = texts().problems;
  const why = refused?.problem?.text ?? '';
  return h('section', { class: 'panel problem', role: 'alert', 'data-testid': 'problem', 'data-kind': refused?.words }, h('h2', {}, t[refused?.words ?? 'broken']),
    why === '' ? null : h('p', {}, t.says), why === '' ? null : h('pre', { lang: 'en', dir: 'ltr' }, why));
}

/** Builds the sheets again, in the current language. */
function build(): void {
  const t = texts();
  document.title = data ? fill(t.title, { name: sessionWords(data.about, ExercisePanel.of(data.scene ?? null)?.title).slice(0, 200) }) : t.report;
  if (!data) {
    root.replaceChildren(topBar(), h('main', {}, refused ? problemPanel() : h('p', { class: 'none', role: 'status' }, t.reading)));
    return;
  }
  const context = sheetContext(data, data.scene ?? sceneOf(data.about), (time_s) => { location.hash = `replay=${time_s.toFixed(3)}`; });
  root.replaceChildren(topBar(), h('main', {}, h('p', { class: 'hint' }, t.charts.click), therapySheet(context), engineeringSheet(context)));
}

/** Shows the sheets, or the viewer. */
async function show(): Promise<void> {
  const wanted = data ? REPLAY.exec(location.hash) : null;
  document.body.dataset.view = wanted ? 'replay' : 'sheets';
  if (!wanted || !data) return;
  if (!page) {
    page = new ReplayPage(viewer, [await ReplaySide.open(new EmbeddedRecording(data))], []);
    const frame = (now_ms: number): void => {
      requestAnimationFrame(frame);
      if (document.body.dataset.view === 'replay') page?.frame(now_ms);
    };
    requestAnimationFrame(frame);
    void page.loadViews();
  }
  if (wanted[1] !== undefined) page.goTo(Number(wanted[1]));
}

async function readData(): Promise<void> {
  if (typeof DecompressionStream === 'undefined') {
    refused = { words: 'old' };
    return;
  }
  try {
    const carried = pageData(document);
    if (carried) data = await readReport(carried);
    else refused = { words: 'template' };
  } catch (thrown) {
    refused = { words: 'broken', problem: thrown instanceof SyntaxError ? new Problem('nonsense', 'the file is cut, or damaged') : asProblem(thrown) };
  }
}

async function open(): Promise<void> {
  await readData();
  document.body.dataset.state = refused ? 'problem' : 'shown';
  build();
  await show();
}

Object.defineProperty(window, 'wholehandReplay', { get: () => page?.now ?? null });
startTheme();
startLanguage();
answerPresses(document);
onLanguage(() => { build(); page?.build(); });
addEventListener('hashchange', () => void show());
build();
// Not awaited: the rest of the single-file bundle, which open() needs, runs afterwards.
void open();
