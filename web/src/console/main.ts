import 'uplot/dist/uPlot.min.css';
import '../shared/tokens.css';
import './console.css';
import { openConnection } from '../net/open_connection';
import { ClockOffset, FrameStats, type WholehandStats } from '../game/frame_stats';
import type { SceneT, WorldStateT } from '../protocol';
import { showAlarm } from '../shared/alarm';
import { onLanguage, startLanguage } from '../shared/i18n';
import { ConsolePage } from './page';
import { startTheme } from './theme';

declare global {
  interface Window {
    wholehandStats: WholehandStats;
    /** The newest messages of the program, for tests and debugging. */
    wholehandNow: { state: WorldStateT | null; scene: SceneT | null };
  }
}

startTheme();
startLanguage();
const connection = await openConnection('therapist');
showAlarm(connection);
const page = new ConsolePage(document.querySelector<HTMLElement>('#app')!, connection);
onLanguage(() => page.build());

// Frame times of the page and the age of its data.
const stats = new FrameStats();
const clock = new ClockOffset();
connection.on('state', (state) => clock.addSample(Number(state.sentMonotonicNs) / 1e6, connection.latestStateAt_ms));
Object.defineProperty(window, 'wholehandStats', { get: () => stats.report(page.quality) });
Object.defineProperty(window, 'wholehandNow', { get: () => ({ state: connection.latestState, scene: connection.scene }) });

function frame(now_ms: number): void {
  requestAnimationFrame(frame);
  const began_ms = performance.now();
  const state = connection.latestState;
  if (!page.frame(began_ms)) return;
  // uPlot draws in a microtask of its own, whose time counts too.
  queueMicrotask(() => {
    const ended_ms = performance.now();
    const age_ms = state ? clock.age_ms(Number(state.sentMonotonicNs) / 1e6, ended_ms) : NaN;
    stats.add(now_ms, ended_ms - began_ms + connection.takeReading_ms(), age_ms);
  });
}
requestAnimationFrame(frame);
await page.loadView();
stats.reset();
