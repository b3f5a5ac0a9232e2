import { store, stored } from '../shared/i18n';

/** Colours for canvas drawing, read once from the style sheet. */
export interface Theme {
  ink2: string;
  grid: string;
  line2: string;
  bad: string;
  color(customProperty: string): string;
}

const STORED = 'wholehand.theme';
type Name = 'light' | 'dark';

/** Applies the theme of the address (?theme=), else the stored choice, else the system's preference. */
export function startTheme(): void {
  const asked = new URLSearchParams(location.search).get('theme') ?? stored(STORED);
  const dark = asked === null ? matchMedia('(prefers-color-scheme: dark)').matches : asked === 'dark';
  apply(dark ? 'dark' : 'light');
}

export function toggleTheme(): void {
  const next = document.documentElement.dataset.theme === 'dark' ? 'light' : 'dark';
  store(STORED, next);
  apply(next);
}

export function readTheme(): Theme {
  const style = getComputedStyle(document.documentElement);
  const color = (name: string): string => style.getPropertyValue(name).trim();
  return { ink2: color('--ink-2'), grid: color('--grid'), line2: color('--line-2'), bad: color('--bad'), color };
}

function apply(name: Name): void {
  document.documentElement.dataset.theme = name;
}
