import { Connection } from './connection';
import { followPresence } from './presence';
import { WorkerConnection } from './worker_connection';

/** The role that a page requests: the game that of the player, the console that of the therapist. */
export type PageRole = 'player' | 'therapist';

/** Token of the address, "?token=…" or "#token=…"; the second form appears in no server log. */
export function tokenOf(address: Pick<Location, 'search' | 'hash'>): string {
  const fragment = new URLSearchParams(address.hash.replace(/^#/, ''));
  return new URLSearchParams(address.search).get('token') ?? fragment.get('token') ?? '';
}

/** Address of the program's WebSocket. ?server=host:port names another one, only on this machine and in development. */
export function socketUrl(address: Pick<Location, 'protocol' | 'host' | 'search' | 'hash'>, development: boolean, role: PageRole, token = tokenOf(address)): string {
  const asked = development ? new URLSearchParams(address.search).get('server') : null;
  const host = asked && /^(localhost|127\.0\.0\.1)(:\d+)?$/.test(asked) ? asked : address.host;
  const scheme = address.protocol === 'https:' ? 'wss' : 'ws';
  // "?role=watcher" requests a connection that only watches.
  const wanted = new URLSearchParams(address.search).get('role') === 'watcher' ? 'watcher' : role;
  return `${scheme}://${host}/ws?role=${wanted}${token ? `&token=${encodeURIComponent(token)}` : ''}`;
}

const STORED = 'wholehand.token';

/** Takes the token out of the address, where it would be visible, bookmarked and shared. The tab keeps it over a reload. */
export function takeToken(): string {
  const shown = tokenOf(location);
  try {
    if (!shown) return sessionStorage.getItem(STORED) ?? '';
    sessionStorage.setItem(STORED, shown);
  } catch {
    return shown;  // without storage a reload would lose the token, so it stays in the address
  }
  const address = new URL(location.href);
  address.searchParams.delete('token');
  const fragment = new URLSearchParams(address.hash.replace(/^#/, ''));
  fragment.delete('token');
  address.hash = fragment.toString();
  history.replaceState(history.state, '', address);
  return shown;
}

/** The connection of this page; with ?fake, in development builds, to a stand-in inside the page. */
export async function openConnection(role: PageRole): Promise<Connection> {
  const connection = await connect(role);
  followPresence(connection);
  return connection;
}

async function connect(role: PageRole): Promise<Connection> {
  const token = takeToken();
  const url = socketUrl(location, import.meta.env.DEV, role, token);
  if (import.meta.env.DEV && new URLSearchParams(location.search).has('fake')) {
    const { FakeProgram } = await import('../../fake/fake_program');
    const program = new FakeProgram(new URLSearchParams(location.search));
    return new Connection({ url, token, open: () => program.connect() });
  }
  const why = async () => (await fetch(url.replace(/^ws/, 'http'), { cache: 'no-store' })).status;
  return new Connection({ url, token, why, open: (address) => new WorkerConnection(address) });
}
