// Tracks whether a person can see this page: after leaving it they cannot see what the robot does.
import type { Connection } from './connection';

export function followPresence(connection: Connection): void {
  const look = (): void => { if (document.hidden) connection.leave(); else connection.comeBack(); };
  document.addEventListener('visibilitychange', look);
  addEventListener('pageshow', look);
  // The page is closed, replaced by another one, or suspended.
  addEventListener('pagehide', () => connection.leave());
  document.addEventListener('freeze', () => connection.leave());
  document.addEventListener('resume', look);
  look();
}
