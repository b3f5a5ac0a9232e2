// Hints rise after 6, 12 and 20 s without action (issue 13), and reset after an action.
import { expect, it } from 'vitest';
import { Hints, type HintLevel } from '../src/game/hints';

it('Hints_WithoutAction_RiseAfterSixTwelveAndTwentySeconds', () => {
  const hints = new Hints();
  const at: Record<number, HintLevel> = {};
  for (let t = 0; t <= 200; t += 1) at[t / 10] = hints.look('reach 0 0', t === 0 ? 0 : 0.1);
  expect([at[5.8], at[6.2], at[11.8], at[12.2], at[19.8]]).toEqual([0, 1, 1, 2, 2]);
  expect(hints.look('reach 0 0', 0.2)).toBe(3);
  expect(hints.look('', 0.1)).toBe(0);
  expect(hints.look('reach 0 0', 0.1)).toBe(0);
});

it('Hints_ForAnotherTask_StartAgain', () => {
  const hints = new Hints();
  hints.look('reach 0 0', 0);
  expect(hints.look('reach 0 0', 30)).toBe(3);
  expect(hints.look('squeeze 0 0', 30)).toBe(0);
});
