import '../shared/tokens.css';
import '../console/console.css';
import './clinic.css';
import { startTheme } from '../console/theme';
import { openConnection } from '../net/open_connection';
import { onLanguage, startLanguage } from '../shared/i18n';
import { ClinicPage } from './page';

startTheme();
startLanguage();
const connection = await openConnection('therapist');
const page = new ClinicPage(document.querySelector<HTMLElement>('#app')!, connection);
onLanguage(() => page.build());
const frame = (now_ms: number): void => {
  requestAnimationFrame(frame);
  page.frame(now_ms);
};
requestAnimationFrame(frame);
