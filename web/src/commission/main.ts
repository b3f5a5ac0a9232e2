import '../shared/tokens.css';
import '../console/console.css';
import './commission.css';
import { startTheme } from '../console/theme';
import { openConnection } from '../net/open_connection';
import { showAlarm } from '../shared/alarm';
import { onLanguage, startLanguage } from '../shared/i18n';
import { CommissionPage } from './page';

startTheme();
startLanguage();
const connection = await openConnection('therapist');
showAlarm(connection);
const page = new CommissionPage(document.querySelector<HTMLElement>('#app')!, connection);
onLanguage(() => page.build());
