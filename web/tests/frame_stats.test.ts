import { expect, test } from 'vitest';
import { ClockOffset, FrameStats } from '../src/game/frame_stats';
import { quantile, Ring } from '../src/shared/ring';

test('Ring_WhenFull_KeepsTheNewestInOrder', () => {
  const ring = new Ring(3, 2);
  for (let i = 1; i <= 5; i++) ring.push([i, -i]);
  expect([0, 1, 2].map((row) => ring.at(row, 0))).toEqual([3, 4, 5]);
  const out = new Float64Array(3);
  expect(ring.copy(1, out)).toBe(3);
  expect([...out]).toEqual([-3, -4, -5]);
});

test('Quantile_IsTheNearestRank', () => {
  const samples = Array.from({ length: 100 }, (_, i) => 100 - i);
  expect([quantile(samples, 0.5), quantile(samples, 0.95), quantile(samples, 1), quantile(samples, 0)]).toEqual([50, 95, 100, 1]);
  expect(quantile([], 0.5)).toBeNaN();
});

test('ClockOffset_Ages_AreRelativeToTheFastestMessage', () => {
  const clock = new ClockOffset(3);
  // Delays of 5, 2 and 9 ms, clocks 1000 ms apart.
  clock.addSample(0, 1005);
  clock.addSample(10, 1012);
  clock.addSample(20, 1029);
  expect(clock.age_ms(20, 1030)).toBe(8);
  // The fastest message leaves the window: the next fastest one counts.
  clock.addSample(30, 1035);
  clock.addSample(40, 1046);
  expect(clock.age_ms(40, 1046)).toBe(1);
});

test('FrameStats_At50FramesPerSecond_Reports50', () => {
  const stats = new FrameStats();
  for (let i = 0; i < 200; i++) stats.add(20 * i, i % 10 === 0 ? 6 : 2, i);
  const report = stats.report('low');
  expect(report.fps).toBeCloseTo(50, 9);
  expect(report.script_ms_p95).toBe(6);   // a tenth of the frames took 6 ms
  expect(report.state_age_ms_p99).toBe(197);
  expect([report.quality, report.frames]).toEqual(['low', 200]);
});

test('FrameStats_BelowOneFramePerSecond_ReportsARate', () => {
  const stats = new FrameStats();
  stats.add(0, 1, 0);
  stats.add(4000, 1, 0);
  expect(stats.report('high').fps).toBe(0.25);
});
