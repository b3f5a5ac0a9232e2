// After the last band the valley's other balloons rise once, and stay.
import { Group } from 'three';
import type { Quality } from '../../scene/quality';
import { makeBalloon, type BalloonColors } from './balloon';

/** Final position of each relative to the stage's middle and over the counter, its size [m], and the time when it begins to rise [s]. */
const FLEET: readonly { readonly x: number; readonly y: number; readonly radius: number; readonly from_s: number; readonly colors: BalloonColors }[] = [
  { x: -0.27, y: 0.33, radius: 0.016, from_s: 0.2, colors: { main: '#F6C636', stripe: '#FFF6E6' } },
  { x: -0.08, y: 0.24, radius: 0.013, from_s: 0.6, colors: { main: '#3B6FD1', stripe: '#FBF4E6' } },
  { x: 0.11, y: 0.37, radius: 0.02, from_s: 0, colors: { main: '#0B6B58', stripe: '#FFE3A3' } },
  { x: 0.2, y: 0.24, radius: 0.014, from_s: 0.8, colors: { main: '#A31D38', stripe: '#F6C636' } },
  { x: 0.31, y: 0.33, radius: 0.024, from_s: 0.4, colors: { main: '#F6C636', stripe: '#C8452F' } },
  { x: 0.5, y: 0.3, radius: 0.018, from_s: 1, colors: { main: '#3B6FD1', stripe: '#FFE3A3' } },
];
const RISE_S = 2.4;
const FROM_M = 0.1;

/** Progress of a rising balloon at a time, 0 .. 1. */
export function risen(since_s: number, from_s: number): number {
  const share = Math.min(1, Math.max(0, (since_s - from_s) / RISE_S));
  return share * share * (3 - 2 * share);
}

export class Fleet {
  readonly root = new Group();
  private readonly balloons: Group[];
  private since_s = 0;

  /** @param side 1: the hand is a right one; -1: everything is mirrored */
  constructor(private readonly side: 1 | -1, quality: Quality) {
    this.balloons = FLEET.map(({ radius, colors }) => makeBalloon(radius, colors, quality));
    this.root.add(...this.balloons);
  }

  /** @param still no motion: they appear at once */
  update(done: boolean, still: boolean, dt_s: number): void {
    this.since_s = !done ? 0 : still ? Infinity : this.since_s + dt_s;
    this.balloons.forEach((balloon, i) => {
      const { x, y, from_s } = FLEET[i]!, share = risen(this.since_s, from_s);
      balloon.visible = done && share > 0;
      balloon.position.set(this.side * x, FROM_M + (y - FROM_M) * share, 0);
    });
  }
}
