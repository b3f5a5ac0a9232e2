import type { AxisT, SceneT } from '../protocol';
import { displayUnits } from './history';
import type { ConsoleTexts } from './i18n';
import type { PlotColumns } from './plot_source';

export interface SeriesSpec {
  name: string;
  /** CSS custom property of the colour. */
  color: string;
  dash: readonly number[];
  column: number;
  decimals: number;
}

export interface PlotSpec {
  /** 'hand', 'arm', 'axis', 'ratios', or an identifier that a page adds. */
  id: string;
  title: string;
  unit: string;
  series: readonly SeriesSpec[];
  /** Smallest span of the values shown. */
  leastSpan: number;
  withZero: boolean;
  /** Fixed range, where the values have one. */
  range?: readonly [number, number];
}

/** The part of a scene that plots are made from. */
export type Axes = Pick<SceneT, 'axes'>;

/** Colour of an axis and its dash, which repeats the distinction: solid, long, dotted. */
const LOOKS: Readonly<Record<string, readonly [string, readonly number[]]>> = {
  x: ['--ax-x', []], y: ['--ax-y', [11, 4]], z: ['--ax-z', [2, 3]],
  roll: ['--ax-c', [7, 3, 2, 3]], pitch: ['--ax-f', [14, 4]], yaw: ['--ax-t', [4, 4]],
  finger_flexion: ['--ax-f', []], thumb_circumduction: ['--ax-c', [2, 3]], thumb_flexion: ['--ax-t', [11, 4]],
};
const ARM = ['x', 'y', 'z', 'roll', 'pitch', 'yaw'];
const AVATAR_DASH = [7, 5];

export function isArm(axis: Pick<AxisT, 'name'>): boolean {
  return ARM.includes(String(axis.name));
}

/** Colour and dash of an axis. */
export const lookOf = (axis: AxisT): readonly [string, readonly number[]] => lookOfName(String(axis.name));
export const lookOfName = (name: string): readonly [string, readonly number[]] => LOOKS[name] ?? ['--ax-x', []];

/** Efforts of one part of the device; a unit that differs from the plot's is written at the series. */
function efforts(id: 'hand' | 'arm', scene: Axes, columns: PlotColumns, t: ConsoleTexts): PlotSpec {
  const wanted = scene.axes.map((axis, i) => ({ axis, i })).filter(({ axis }) => isArm(axis) === (id === 'arm'));
  const series = wanted.map(({ axis, i }): SeriesSpec => {
    const [color, dash] = lookOf(axis);
    const { effortUnit } = displayUnits(axis);
    const name = t.axes[String(axis.name)] ?? String(axis.name);
    return {
      name: effortUnit === 'N' ? name : `${name}, ${effortUnit}`, color, dash,
      column: columns.column('effort', i), decimals: effortUnit === 'N' ? 1 : 2,
    };
  });
  return { id, title: t.plots[id], unit: 'N', series, leastSpan: 6, withZero: true };
}

/** Device and avatar coordinate of one axis. */
export function coordinateSpec(scene: Axes, columns: PlotColumns, axis: number, t: ConsoleTexts): PlotSpec {
  const spec = scene.axes[axis];
  const name = String(spec.name);
  const [color] = lookOf(spec);
  return {
    id: 'axis', title: t.axesLong[name] ?? name, unit: displayUnits(spec).coordinateUnit, leastSpan: 8, withZero: false,
    series: [
      { name: t.plots.device, color, dash: [], column: columns.column('device', axis), decimals: 0 },
      { name: t.plots.avatar, color: '--ax-a', dash: AVATAR_DASH, column: columns.column('avatar', axis), decimals: 0 },
    ],
  };
}

/** φ of the hand's axes and α; φ of every axis where there is no hand. */
function ratios(scene: Axes, columns: PlotColumns, t: ConsoleTexts): PlotSpec {
  const all = scene.axes.map((axis, i) => ({ axis, i }));
  const hand = all.filter(({ axis }) => !isArm(axis));
  const series = (hand.length > 0 ? hand : all).map(({ axis, i }): SeriesSpec => {
    const [color, dash] = lookOf(axis);
    return { name: `φ ${t.axes[String(axis.name)] ?? String(axis.name)}`, color, dash, column: columns.column('phi', i), decimals: 2 };
  });
  const alpha = { name: 'α', color: '--ax-a', dash: AVATAR_DASH, column: columns.alphaColumn, decimals: 2 };
  return { id: 'ratios', title: t.plots.ratios, unit: '', series: [...series, alpha], leastSpan: 1, withZero: true, range: [-0.05, 1.08] };
}

/** The four plots for a scene, with the chosen axis in the third. */
export function plotSpecs(scene: Axes, columns: PlotColumns, axis: number, t: ConsoleTexts): PlotSpec[] {
  return [
    efforts('hand', scene, columns, t), efforts('arm', scene, columns, t),
    coordinateSpec(scene, columns, axis, t), ratios(scene, columns, t),
  ].filter((spec) => spec.series.length > 0);
}

/** The limit of one axis in a plot. */
export interface AxisLimit { readonly column: number; readonly name: string; readonly limit: number }

/** The limit in force for an axis, in display units: the lower one of the device's limit and the limit set for its part. */
export function limitOfAxis(axis: AxisT, parameter: (name: string) => number | undefined): number {
  const { effort, effortUnit } = displayUnits(axis);
  const set = effortUnit === 'N' ? parameter(isArm(axis) ? 'effort_limit_arm_n' : 'effort_limit_hand_tip_n') : undefined;
  return Math.min(axis.effortLimit * effort, set ?? Infinity);
}

/** The limits in force for the axes of a plot of efforts [N]; each axis has its own, not the largest of its part. */
export function limitsOf(id: string, scene: Axes, columns: PlotColumns, parameter: (name: string) => number | undefined, t: ConsoleTexts): AxisLimit[] {
  if (id !== 'hand' && id !== 'arm') return [];
  return scene.axes.flatMap((axis, i) => (isArm(axis) !== (id === 'arm') || displayUnits(axis).effortUnit !== 'N' ? []
    : [{ column: columns.column('effort', i), name: t.axes[String(axis.name)] ?? String(axis.name), limit: limitOfAxis(axis, parameter) }]));
}
