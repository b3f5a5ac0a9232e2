import { h } from '../console/dom';
import type { ClinicContext } from './clinic_context';

/** Saves a table as a file. The request needs the session's token, so a plain link would be refused. */
export async function saveText({ clinic }: ClinicContext, path: string, file_name: string): Promise<void> {
  const url = URL.createObjectURL(new Blob([await clinic.api.text(path)], { type: 'text/csv' }));
  h('a', { href: url, download: file_name }).click();
  setTimeout(() => URL.revokeObjectURL(url), 10_000);
}
