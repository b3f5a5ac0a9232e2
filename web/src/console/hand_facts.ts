import type { SceneT } from '../protocol';
import { fill } from '../shared/i18n';
import { fact, h } from './dom';
import { asWords, fixed } from '../shared/format';
import { displayUnits } from './history';
import { texts } from './i18n';
import { isArm } from './plot_specs';

/** The loaded hand: its name, and the range that the device allows for each axis. */
export function handFacts(scene: SceneT): HTMLElement {
  const t = texts();
  const name = String(scene.handName ?? '');
  const ranges = scene.axes.filter((axis) => !isArm(axis)).map((axis) => {
    const { coordinate, coordinateUnit } = displayUnits(axis);
    const words = fill(t.handFacts.range, { lo: fixed(axis.lower * coordinate, 0), hi: fixed(axis.upper * coordinate, 0) });
    return fact(t.axesLong[String(axis.name)] ?? String(axis.name), `${words} ${coordinateUnit}`);
  });
  return h('dl', { class: 'facts', 'data-testid': 'hand-facts' }, fact(t.handFacts.now, t.hands[name] ?? asWords(name)),
    fact(t.handFacts.side, scene.rightHand ? t.handFacts.right : t.handFacts.left), ...ranges);
}
