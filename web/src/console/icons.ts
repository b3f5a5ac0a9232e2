import { svg } from './dom';

const LINE = { fill: 'none', stroke: 'currentColor', 'stroke-linecap': 'round', 'stroke-linejoin': 'round' } as const;

interface Drawing {
  box: number;
  paths: readonly (readonly [d: string, attributes: Readonly<Record<string, string | number>>])[];
}

const DRAWINGS = {
  logo: { box: 28, paths: [['M8 14V7M13 13V4M18 13.5V5.5M23 16v-6M8 14c0 0-3-2-4.5-.5S8 20 10 22s4 3 7 3 6-3 6-8', { ...LINE, 'stroke-width': 3.4 }]] },
  stop: { box: 48, paths: [['M15 3h18l12 12v18L33 45H15L3 33V15z', { fill: '#fff' }], ['M17 15h14a2 2 0 0 1 2 2v14a2 2 0 0 1-2 2H17a2 2 0 0 1-2-2V17a2 2 0 0 1 2-2z', { fill: '#B3161B' }]] },
  pause: { box: 16, paths: [['M3 1.5h2.2a1 1 0 0 1 1 1v11a1 1 0 0 1-1 1H3a1 1 0 0 1-1-1v-11a1 1 0 0 1 1-1zM10.8 1.5H13a1 1 0 0 1 1 1v11a1 1 0 0 1-1 1h-2.200a1 1 0 0 1-1-1v-11a1 1 0 0 1 1-1z', { fill: 'currentColor' }]] },
  play: { box: 16, paths: [['M3 1.5l11 6.5-11 6.5z', { fill: 'currentColor' }]] },
  back: { box: 16, paths: [['M13 2.500v11L5.500 8z', { fill: 'currentColor' }], ['M3.500 2.500v11', { ...LINE, 'stroke-width': 2 }]] },
  forward: { box: 16, paths: [['M3 2.500v11L10.500 8z', { fill: 'currentColor' }], ['M12.500 2.500v11', { ...LINE, 'stroke-width': 2 }]] },
  shorter: { box: 20, paths: [['M14.500 8.500a6 6 0 1 1-12 0a6 6 0 1 1 12 0M13 13l4.500 4.500M6 8.500h5M8.500 6v5', { ...LINE, 'stroke-width': 2 }]] },
  longer: { box: 20, paths: [['M14.500 8.500a6 6 0 1 1-12 0a6 6 0 1 1 12 0M13 13l4.500 4.500M6 8.500h5', { ...LINE, 'stroke-width': 2 }]] },
  earlier: { box: 16, paths: [['M14 2.500v11L8.500 8zM8 2.500v11L2.500 8z', { fill: 'currentColor' }]] },
  later: { box: 16, paths: [['M2 2.500v11L7.500 8zM8 2.500v11L13.500 8z', { fill: 'currentColor' }]] },
  ok: { box: 20, paths: [['M18.2 10a8.2 8.2 0 1 1-16.4 0a8.2 8.2 0 1 1 16.4 0M6.2 10.400l2.6 2.6 5-5.6', { ...LINE, 'stroke-width': 2.4 }]] },
  bad: { box: 20, paths: [['M10 2l8.5 15.500h-17zM10 8v4.200M10 15v.1', { ...LINE, 'stroke-width': 2.4 }]] },
  wait: { box: 20, paths: [['M18.2 10a8.2 8.2 0 1 1-16.4 0a8.2 8.2 0 1 1 16.4 0M10 5v5l3.5 2', { ...LINE, 'stroke-width': 2.4 }]] },
  theme: { box: 20, paths: [['M16.5 12.5A7 7 0 0 1 7.5 3.5 7 7 0 1 0 16.5 12.500z', { ...LINE, 'stroke-width': 2 }]] },
  table: { box: 20, paths: [['M2.5 4h15v12h-15zM2.5 8h15M2.5 12h15M8 4v12', { ...LINE, 'stroke-width': 1.8 }]] },
} as const satisfies Record<string, Drawing>;

export type IconName = keyof typeof DRAWINGS;

/** An icon without accessible text; a text stands beside it. */
export function icon(name: IconName): SVGSVGElement {
  const { box, paths } = DRAWINGS[name];
  return svg('svg', { viewBox: `0 0 ${box} ${box}`, 'aria-hidden': 'true', class: `icon-${name}` },
    ...paths.map(([d, attributes]) => svg('path', { d, ...attributes })));
}
