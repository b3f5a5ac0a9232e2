// Helpers that make both pages usable without a mouse, without colour vision, and without motion.

const FOCUSABLE = 'a[href], button:not(:disabled), input:not(:disabled), select:not(:disabled), textarea:not(:disabled), [tabindex]:not([tabindex="-1"])';

function focusable(root: ParentNode): HTMLElement[] {
  return [...root.querySelectorAll<HTMLElement>(FOCUSABLE)].filter((element) => element.getClientRects().length > 0);
}

/**
 * Keeps Tab within these parts of the page: a dialog and controls such as Stop that must stay reachable beside it.
 * Returns a function that ends this and restores the focus.
 */
export function trapFocus(parts: readonly HTMLElement[], first?: HTMLElement | null): () => void {
  const before = document.activeElement instanceof HTMLElement ? document.activeElement : null;
  const onKey = (event: KeyboardEvent) => {
    if (event.key !== 'Tab') return;
    const all = parts.flatMap((part) => focusable(part));
    if (all.length === 0) return;
    const at = all.indexOf(document.activeElement as HTMLElement);
    const next = event.shiftKey ? (at <= 0 ? all.length - 1 : at - 1) : (at + 1) % all.length;
    event.preventDefault();
    all[next].focus();
  };
  document.addEventListener('keydown', onKey, true);
  (first ?? parts.flatMap((part) => focusable(part))[0])?.focus();
  return () => {
    document.removeEventListener('keydown', onKey, true);
    if (before?.isConnected) before.focus();
  };
}

/** Stores at the root element how the page was used last, "pointer" or "keys": the focus frame is drawn only for keys. */
export function markInputMethod(page: Document): void {
  const mark = (used: 'pointer' | 'keys') => () => { page.documentElement.dataset.used = used; };
  page.addEventListener('pointerdown', mark('pointer'), true);
  page.addEventListener('keydown', mark('keys'), true);
}
