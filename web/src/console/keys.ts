import type { Header } from './header';
import type { ConsoleModel } from './model';

/** Whether the element with the focus uses the space bar itself. */
const spaceIsTaken = (target: EventTarget | null): boolean => target instanceof Element && target.closest('input, select, textarea, button, a, summary, [role=tab]') !== null;

/** Keys of the therapist on every page: Esc stops at once, wherever the focus is; Space pauses. */
export function listenForKeys(model: Pick<ConsoleModel, 'emergencyStop'>, header: () => Pick<Header, 'pauseNow'> | undefined): void {
  addEventListener('keydown', (event) => {
    if (event.key === 'Escape' && !event.repeat) {
      event.preventDefault();
      void model.emergencyStop();
    }
    if (event.code === 'Space' && !event.repeat && !event.ctrlKey && !event.altKey && !event.metaKey && !spaceIsTaken(event.target)) {
      event.preventDefault();
      header()?.pauseNow();
    }
  }, true);
}
