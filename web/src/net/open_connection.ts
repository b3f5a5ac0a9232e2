import { Connection } from './connection';
import { followPresence } from './presence';
import { WorkerLine } from './worker_line';

/** Token of the address, "?token=…" or "#token=…"; the second one is in no server's log. */
export function tokenOf(address: Pick<Location, 'search' | 'hash'>): string {
  const fragment = new URLSearchParams(address.hash.replace(/^#/, ''));
  return new URLSearchParams(address.search).get('token') ?? fragment.get('token') ?? '';
}

/** Where the program's WebSocket is. ?server=host:port names another one, of this machine and in development only. */
export function socketUrl(address: Pick<Location, 'protocol' | 'host' | 'search' | 'hash'>, development: boolean): string {
  const asked = development ? new URLSearchParams(address.search).get('server') : null;
  const host = asked && /^(localhost|127\.0\.0\.1)(:\d+)?$/.test(asked) ? asked : address.host;
  const token = tokenOf(address);
  const scheme = address.protocol === 'https:' ? 'wss' : 'ws';
  return `${scheme}://${host}/ws${token ? `?token=${encodeURIComponent(token)}` : ''}`;
}

/** The connection of this page; with ?fake, in development builds, to a stand-in inside the page. */
export async function openConnection(): Promise<Connection> {
  const connection = await connect();
  followPresence(connection);
  return connection;
}

async function connect(): Promise<Connection> {
  const token = tokenOf(location);
  const url = socketUrl(location, import.meta.env.DEV);
  if (import.meta.env.DEV && new URLSearchParams(location.search).has('fake')) {
    const { FakeProgram } = await import('./fake_program');
    const program = new FakeProgram(new URLSearchParams(location.search));
    return new Connection({ url, token, open: () => program.line() });
  }
  const why = async () => (await fetch(url.replace(/^ws/, 'http'), { cache: 'no-store' })).status;
  return new Connection({ url, token, why, open: (address) => new WorkerLine(address) });
}
