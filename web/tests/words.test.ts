// The strip's text for a person without help: the direction to the target. Numbers of the program's row: the hand
// drawn back is 150 mm in front of a target's grip, its stretched fingers enter beside it.
import { expect, it } from 'vitest';
import { wayTo } from '../src/game/words';

const MIRRORED = { 'hint.left': 'hint.right', 'hint.right': 'hint.left' } as Record<string, string>;

it.each([
  ['in front, to the left of the target', 0.15, 0.043, 'hint.right'],
  ['in front, far to its right', 0.15, -0.06, 'hint.left'],
  ['in front, where the fingers pass beside it', 0.15, -0.015, 'hint.forward'],
  ['in the row, behind its other side: sideways it would be pressed against it', 0.08, 0.05, 'hint.back'],
  ['in the row, beside it', 0.08, -0.02, 'hint.forward'],
  ['as far in as it is, not at it yet', 0.005, -0.03, 'hint.left'],
] as const)('a right hand %s, and a left one mirrored', (_, ahead_m, left_m, expected) => {
  expect(wayTo({ ahead_m, left_m, goesIn: 1 })).toBe(expected);
  expect(wayTo({ ahead_m, left_m: -left_m, goesIn: -1 })).toBe(MIRRORED[expected] ?? expected);
});
