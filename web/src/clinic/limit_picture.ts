import { svg } from '../console/dom';
import type { LimitAxis, OwnMovement, Range } from './person_limits';

const WIDTH = 260, HEIGHT = 118, CENTRE = WIDTH / 2, BASE = 104, OUTER = 92, INNER = 66;
const BAR = { left: 14, right: WIDTH - 14, top: 44, height: 26 } as const;

type At = readonly [x: number, y: number];

/** A place on the half ring: 0 at its left end, 1 at its right end. */
const onRing = (share: number, radius: number): At => [CENTRE - radius * Math.cos(Math.PI * share), BASE - radius * Math.sin(Math.PI * share)];
const point = ([x, y]: At): string => `${x.toFixed(1)} ${y.toFixed(1)}`;

function ringPart(from: number, to: number): string {
  return `M${point(onRing(from, INNER))}L${point(onRing(from, OUTER))}A${OUTER} ${OUTER} 0 0 1 ${point(onRing(to, OUTER))}L${point(onRing(to, INNER))}A${INNER} ${INNER} 0 0 0 ${point(onRing(from, INNER))}Z`;
}
function barPart(from: number, to: number): string {
  const x = (share: number): number => BAR.left + share * (BAR.right - BAR.left);
  return `M${x(from)} ${BAR.top}H${x(to)}V${BAR.top + BAR.height}H${x(from)}Z`;
}

/** The device's range, own movement inside it, and the limit's ends: a half ring for a rotation, a bar for a way. */
export function limitPicture(axis: LimitAxis, own: OwnMovement | undefined, limit: Range | undefined, words: string): SVGElement {
  const share = (value: number): number => Math.min(1, Math.max(0, (value - axis.lower) / (axis.upper - axis.lower)));
  const part = axis.turns ? ringPart : barPart;
  const end = (value: number): SVGElement => {
    const at = share(value);
    const [from, to]: readonly [At, At] = axis.turns ? [onRing(at, INNER - 8), onRing(at, OUTER + 6)] : [[BAR.left + at * (BAR.right - BAR.left), BAR.top - 10], [BAR.left + at * (BAR.right - BAR.left), BAR.top + BAR.height + 10]];
    return svg('path', { class: 'end', d: `M${point(from)}L${point(to)}` });
  };
  return svg('svg', { class: 'limit-picture', viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: 'img', 'aria-label': words },
    svg('path', { class: 'device', d: part(0, 1) }),
    own ? svg('path', { class: 'own', d: part(share(own.lower ?? axis.lower), share(own.upper ?? axis.upper)) }) : null,
    ...(limit ? [end(limit.lower), end(limit.upper)] : []));
}
