import '../shared/tokens.css';
import '../console/console.css';
import './clinic.css';
import { startTheme } from '../console/theme';
import { openConnection } from '../net/open_connection';
import type { SceneT, WorldStateT } from '../protocol';
import { showAlarm } from '../shared/alarm';
import { onLanguage, startLanguage } from '../shared/i18n';
import { ClinicPage } from './page';

declare global {
  interface Window {
    /** The newest messages of the program, for tests and debugging. */
    wholehandNow: { state: WorldStateT | null; scene: SceneT | null };
  }
}

startTheme();
startLanguage();
const connection = await openConnection('therapist');
showAlarm(connection);
const page = new ClinicPage(document.querySelector<HTMLElement>('#app')!, connection);
onLanguage(() => page.build());
Object.defineProperty(window, 'wholehandNow', { get: () => ({ state: connection.latestState, scene: connection.scene }) });
const frame = (now_ms: number): void => {
  requestAnimationFrame(frame);
  page.frame(now_ms);
};
requestAnimationFrame(frame);
