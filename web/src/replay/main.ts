import 'uplot/dist/uPlot.min.css';
import '../shared/tokens.css';
import '../console/console.css';
import './replay.css';
import { startTheme } from '../console/theme';
import { takeToken } from '../net/open_connection';
import { onLanguage, startLanguage } from '../shared/i18n';
import { answerPresses } from '../shared/pressed';
import { openRecordings } from './open_recordings';
import { openingPage } from './opening';
import { ReplayPage, type ReplayNow } from './page';
import { Problem } from './problem';
import { RecordingSource, type Fetch } from './recording_source';
import { ReportOpening } from './report_opening';

declare global {
  interface Window { wholehandReplay: ReplayNow | null }
}

startTheme();
startLanguage();
answerPresses(document);
const token = takeToken();
const asked = new URLSearchParams(location.search);
const names = ['recording', 'beside'].map((key) => asked.get(key) ?? '').filter((name, i) => i === 0 || name !== '');
const root = document.querySelector<HTMLElement>('#app')!;
/** A program that did not answer is asked again after this time [ms]. */
const AGAIN_MS = 2000;
let again: ReturnType<typeof setTimeout> | undefined;
let page: ReplayPage | undefined;
let report: ReportOpening | undefined;
let shown: { name: string; problem: Problem | 'none' | undefined } = { name: names[0], problem: undefined };
Object.defineProperty(window, 'wholehandReplay', { get: () => page?.now ?? null });

function showOpening(): void {
  root.replaceChildren(...openingPage(shown.name, shown.problem, () => void open()));
}

/** The program's HTTP interface; with ?fake, in development builds, a stand-in within the page. */
async function answers(): Promise<Fetch | undefined> {
  if (!import.meta.env.DEV || !asked.has('fake')) return undefined;
  const { FakeRecordings } = await import('../../fake/fake_recordings');
  const fake = new FakeRecordings(asked);
  return (address) => fake.answer(address);
}

async function open(): Promise<void> {
  clearTimeout(again);
  shown = { name: names[0], problem: names[0] === '' ? 'none' : undefined };
  showOpening();
  if (names[0] === '') return;
  const get = await answers();
  if (asked.has('report')) return openReport(new RecordingSource(names[0], token, get));
  const { sides, failed } = await openRecordings(names.map((name) => new RecordingSource(name, token, get)));
  if (sides.length === 0) {
    shown = failed[0];
    showOpening();
    // The page waits for a program that is busy or restarts.
    if (failed[0].problem.passes) again = setTimeout(() => void open(), AGAIN_MS);
    return;
  }
  page = new ReplayPage(root, sides, failed);
  await page.loadViews();
}

/** Replaces this page by the report. The program's answer there describes faults of the recording. */
async function openReport(source: RecordingSource): Promise<void> {
  report = new ReportOpening(root, source, (address) => fetch(address).then(() => true, () => false));
  if (await report.open((address) => location.replace(address))) return;
  report = undefined;
  shown = { name: names[0], problem: new Problem('gone') };
  showOpening();
}

onLanguage(() => (report ? report.build() : page ? page.build() : showOpening()));
function frame(now_ms: number): void {
  requestAnimationFrame(frame);
  page?.frame(now_ms);
}
requestAnimationFrame(frame);
await open();
