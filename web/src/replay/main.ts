import 'uplot/dist/uPlot.min.css';
import '../shared/tokens.css';
import '../console/console.css';
import './replay.css';
import { startTheme } from '../console/theme';
import { takeToken } from '../net/open_connection';
import { onLanguage, startLanguage } from '../shared/i18n';
import { answerPresses } from '../shared/pressed';
import { openingPage } from './opening';
import { ReplayPage, type ReplayNow } from './page';
import { asProblem, type Problem } from './problem';
import { RecordingSource, type Fetch } from './recording_source';
import { ReplaySide } from './side';

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
/** After so long a program that did not answer is asked again [ms]. */
const AGAIN_MS = 2000;
let again: ReturnType<typeof setTimeout> | undefined;
let page: ReplayPage | undefined;
let shown: { name: string; problem: Problem | 'none' | undefined } = { name: names[0], problem: undefined };
Object.defineProperty(window, 'wholehandReplay', { get: () => page?.now ?? null });

function showOpening(): void {
  root.replaceChildren(...openingPage(shown.name, shown.problem, () => void open()));
}

/** The program's answers; with ?fake, in development builds, those of a stand-in within the page. */
async function answers(): Promise<Fetch | undefined> {
  if (!import.meta.env.DEV || !asked.has('fake')) return undefined;
  const { FakeRecordings } = await import('../net/fake_recordings');
  const fake = new FakeRecordings(asked);
  return (address) => fake.answer(address);
}

async function open(): Promise<void> {
  clearTimeout(again);
  shown = { name: names[0], problem: names[0] === '' ? 'none' : undefined };
  showOpening();
  if (names[0] === '') return;
  const get = await answers();
  const sides: ReplaySide[] = [];
  try {
    for (const name of names) {
      shown.name = name;
      sides.push(await ReplaySide.open(new RecordingSource(name, token, get)));
    }
  } catch (thrown) {
    for (const side of sides) side.close();
    shown.problem = asProblem(thrown);
    showOpening();
    // A program that is busy, or starts again, is waited for.
    if (shown.problem.passes) again = setTimeout(() => void open(), AGAIN_MS);
    return;
  }
  page = new ReplayPage(root, sides);
  await page.loadViews();
}

onLanguage(() => (page ? page.build() : showOpening()));
function frame(now_ms: number): void {
  requestAnimationFrame(frame);
  page?.frame(now_ms);
}
requestAnimationFrame(frame);
await open();
