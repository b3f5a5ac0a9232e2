import { h, setAttribute, type Child } from '../shared/dom';

export { columns, fact, h, setAttribute, setText } from '../shared/dom';

type Attributes = Readonly<Record<string, string | number | boolean | undefined>>;

const SVG = 'http://www.w3.org/2000/svg';

export function svg<K extends keyof SVGElementTagNameMap>(
  tag: K, attributes: Attributes = {}, ...children: Child[]
): SVGElementTagNameMap[K] {
  const element = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value !== undefined && value !== false) element.setAttribute(name, String(value));
  }
  element.append(...children.filter((child): child is Node | string => child !== null && child !== undefined));
  return element;
}

export function setClass(element: Element, name: string, on: boolean): void {
  if (element.classList.contains(name) !== on) element.classList.toggle(name, on);
}

/** A group of buttons of which one is chosen. */
export function choice(
  label: string, options: readonly { key: string; name: string; title?: string }[], chosen: string, onChoice: (key: string) => void,
): { element: HTMLElement; choose: (key: string) => void } {
  const buttons = options.map(({ key, name, title }) => {
    const button = h('button', { type: 'button', 'aria-pressed': String(key === chosen), title, 'data-key': key }, name);
    if (title !== undefined && title !== name) button.setAttribute('aria-label', `${name}: ${title}`);
    button.addEventListener('click', () => onChoice(key));
    return button;
  });
  return {
    element: h('div', { class: 'seg', role: 'group', 'aria-label': label }, ...buttons),
    choose: (key) => {
      for (const button of buttons) setAttribute(button, 'aria-pressed', String(button.dataset.key === key));
    },
  };
}
