import { h } from '../console/dom';
import { Changes } from '../shared/changes';
import { fill } from '../shared/i18n';
import { texts } from './i18n';
import type { ClinicContext } from './clinic_context';
import type { BackupPlace } from './records';
import { action, panel, StatusMessage } from './ui';
import { clockOf, dayOf } from './words';

/** A backup older than this is reported [ms]. */
const OLD_MS = 2 * 86_400_000;
/** Sticks are looked for this often [ms]. */
const EVERY_MS = 3000;

/** When the last backup was made, and one by one press: to the usual folder, or to a stick that is plugged in. */
export class BackupPanel {
  readonly element: HTMLElement;
  private readonly t = texts().settings;
  private readonly last = h('p', {});
  private readonly places = h('ul', { class: 'places-of' });
  private readonly message = new StatusMessage();
  private readonly done = h('p', { role: 'status', 'data-testid': 'backup-done' });
  private readonly changes = new Changes();
  private asked_ms = -Infinity;

  constructor(private readonly context: ClinicContext) {
    this.element = panel(this.t.backup, 'backup', this.last, h('p', { class: 'aside' }, this.t.backupWords), this.places, this.done, this.message.element);
    this.refresh();
  }

  refresh(): void {
    const { t } = this, backup = this.context.clinic.state?.backup;
    const old = !backup || backup.problem !== undefined || backup.last_us === 0 || Date.now() - backup.last_us / 1000 > OLD_MS;
    const words = !backup || backup.folder === '' ? t.noFolder : backup.last_us === 0 ? fill(t.noBackup, { folder: backup.folder }) : fill(t.lastBackup, { day: dayOf(backup.last_us), at: clockOf(backup.last_us), folder: backup.folder });
    this.last.className = old ? 'warning' : '';
    const message = backup?.problem ? `${words} ${fill(t.backupProblem, { why: backup.problem })}` : words;
    if (this.last.textContent !== message) this.last.textContent = message;
    if (performance.now() - this.asked_ms < EVERY_MS || this.context.clinic.silentSince) return;
    this.asked_ms = performance.now();
    void this.look();
  }

  private async look(): Promise<void> {
    const { places } = await this.context.clinic.api.get<{ places: readonly BackupPlace[] }>('/api/backup/places').catch(() => ({ places: undefined }));
    if (!places || !this.changes.of(places.map(({ folder, last_us }) => [folder, last_us]))) return;
    const { t } = this;
    const rows = places.map((place, i) => {
      const press = action(t.backUpHere, `back-up-${i}`, this.message, () => this.backUp(place), place.own ? '' : 'go');
      press.setAttribute('aria-label', `${t.backUpHere}: ${nameOf(place, t.thisMachine)}`);
      return h('li', {}, h('span', {}, h('b', {}, nameOf(place, t.thisMachine)), h('small', {}, place.last_us > 0 ? fill(t.lastHere, { day: dayOf(place.last_us), at: clockOf(place.last_us) }) : t.noneHere)), press);
    });
    this.places.replaceChildren(...rows, ...(places.every(({ own }) => own) ? [h('li', { class: 'aside' }, t.noStick)] : []));
  }

  private async backUp(place: BackupPlace): Promise<void> {
    const { clinic } = this.context;
    this.message.show('');
    this.done.textContent = '';
    const { file } = await clinic.api.send<{ file: string }>('POST', '/api/backup', { folder: place.folder });
    this.done.textContent = fill(this.t.backedUp, { file });
    this.asked_ms = -Infinity;
    await clinic.look();
  }
}

/** A stick is called by its own name, as in its file manager. */
const nameOf = ({ own, folder }: BackupPlace, machine: string): string => (own ? machine : folder.split('/').at(-1) ?? folder);
