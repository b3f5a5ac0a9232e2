// The stand-in bar as messages: its parts of a scene and of a state.
import { BodyT, ContactPointT, type SceneT, type WorldStateT } from '../src/protocol';
import { box, cylinder, pose, vec } from './fake_shapes';
import { Stage } from '../src/exercises/cocktail_bar/bar';
import { GEOMETRY as g, LEVEL_NAMES, SQUEEZE, type FakeBar } from './fake_bar';

export const EVENT_NAMES = ['approached', 'touched', 'engaged', 'disengaged', 'pour_began', 'pour_ended', 'line_reached', 'overfilled', 'spilt',
  'wrong_dispenser', 'knocked_over', 'stood_up', 'step_done', 'drink_done', 'level_done', 'paused', 'resumed', 'restarted'];
/** Bodies of the scene before the first dispenser: counter, rail, glass. */
const FIRST_DISPENSER = 3;

/** Plays until a named stage of a step ("pour"); does nothing for an unknown name. */
export function playTo(bar: FakeBar, at: string, drink: number, step: number): void {
  const stages: Record<string, number> = { reach: Stage.Reach, squeeze: Stage.Squeeze, pour: Stage.Pour, letgo: Stage.LetGo, breathe: Stage.Breathe, success: Stage.DrinkDone, level: Stage.LevelDone, drawback: Stage.DrawBack };
  const stage = stages[at];
  const there = (): boolean => bar.stage === stage && bar.drink >= drink && bar.step >= step;
  for (let k = 0; stage !== undefined && k < 12000 && !there(); k++) bar.advance(1 / 60, true, true);
}

function valuesOf(bar: FakeBar): [string, number][] {
  const asked = bar.steps[Math.min(bar.step, bar.steps.length - 1)];
  return [
    ['stage', bar.stage], ['drink', bar.drink], ['drinks', bar.drinks.length], ['step', bar.step], ['steps', bar.steps.length],
    ['target_dispenser', bar.target], ['engaged_dispenser', bar.engaged], ['squeeze_n', bar.squeeze_n], ['squeeze_low_n', SQUEEZE.low_n],
    ['squeeze_high_n', SQUEEZE.high_n], ['squeeze_full_n', SQUEEZE.full_n], ['flow_l_s', bar.flow_l_s], ['pressed_l', bar.pressed_l],
    ['over_glass', Number(bar.flow_l_s > 0 && bar.engaged === bar.target)], ['poured_l', bar.poured_l], ['asked_l', asked.amount_l],
    ['tolerance_l', asked.tolerance_l], ['glass_l', bar.layers_l.reduce((a, b) => a + b, 0)], ['spilt_l', bar.spilt_l], ['score', bar.score],
    ['stars', bar.stars], ['drink_time_s', bar.drinkTime_s], ['row_y_m', bar.row_y],
    ...bar.liquids.map((l, i): [string, number] => [`left_l/${l.name}`, bar.left_l[i]]),
    ...bar.layers_l.map((v, i): [string, number] => [`layer_l/${i}`, v]),
  ];
}

export function describeBar(s: SceneT, bar: FakeBar): void {
  s.exerciseJson = JSON.stringify({
    kind: 'cocktail_bar', level: bar.level, levels: LEVEL_NAMES.map((name, i) => ({ level: i + 1, name })), liquids: bar.liquids,
    dispensers: bar.liquids.map((l) => ({ body: `dispenser_${l.name}`, liquid: l.name, free: false, radius_m: g.bottle_r, height_m: g.bottle_h, nozzle_m: [0, 0, g.nozzle_z], grip_m: [0, 0, 0] })),
    glass: { body: 'glass', radius_m: g.glass_r, height_m: g.glass_h, m_per_l: g.m_per_l, capacity_l: g.capacity_l },
    counter_z_m: g.counter_z, rail_z_m: g.rail_z, drinks: bar.drinks,
  });
  s.bodies = [
    new BodyT('counter', true, '#765443', [box([0.25, 0.6, 0.02])]),
    new BodyT('rail', true, '#D0A869', [cylinder(0.008, 1.2, [Math.SQRT1_2, 0, 0, Math.SQRT1_2])]),
    new BodyT('glass', true, '#DDE8E8', [cylinder(g.glass_r, g.glass_h)]),
    ...bar.liquids.map((l) => new BodyT(`dispenser_${l.name}`, true, l.color, [cylinder(g.bottle_r, g.bottle_h)])),
  ];
  s.valueNames = valuesOf(bar).map(([name]) => name);
  s.eventNames = EVENT_NAMES;
}

export function fillBar(s: WorldStateT, bar: FakeBar): void {
  s.palmBody = bar.palmDistance_m < 0.2 ? FIRST_DISPENSER + Math.max(bar.engaged, bar.target) : -1;
  s.palmTargetDistanceM = bar.palmDistance_m;
  s.bodies = [
    pose([0.2, 0, g.counter_z - 0.02]), pose([g.row_x, 0, g.rail_z]), pose([g.row_x, bar.glass_y, g.counter_z + g.glass_h / 2]),
    ...bar.liquids.map((_, i) => pose([g.row_x, bar.dispenserY(i), g.bottle_z])),
  ];
  s.contacts = bar.contacts.map((c) => new ContactPointT(c.capsule, FIRST_DISPENSER + c.dispenser, vec(c.point), vec(c.force)));
  s.values = valuesOf(bar).map(([, value]) => value);
}
