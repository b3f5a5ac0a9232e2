// A bar with two dispensers in the second step of the second drink, a sunset, for tests.
import { barOf } from '../src/exercises/cocktail_bar/bar';
import { BarPlay } from '../src/exercises/cocktail_bar/play';
import { RunState, SceneT, Steering, WorldStateT } from '../src/protocol';

const NAMES = ['stage', 'drink', 'drinks', 'step', 'steps', 'target_dispenser', 'engaged_dispenser', 'squeeze_n', 'squeeze_low_n', 'squeeze_high_n',
  'squeeze_full_n', 'flow_l_s', 'pressed_l', 'over_glass', 'poured_l', 'asked_l', 'glass_l', 'spilt_l', 'stars', 'drink_time_s', 'layer_l/0', 'layer_l/1', 'layer_l/2'];

export function sceneOfSunset(): SceneT {
  const scene = new SceneT();
  scene.exerciseJson = JSON.stringify({
    kind: 'cocktail_bar', dispensers: [{ body: 'dispenser_lemon', liquid: 'lemon' }, { body: 'dispenser_cherry', liquid: 'cherry' }],
    drinks: [{ name: 'lemonade', steps: [{ liquid: 'lemon', amount_l: 0.04, tolerance_l: 0.005 }] },
      { name: 'sunset', steps: [{ liquid: 'lemon', amount_l: 0.03, tolerance_l: 0.003 }, { liquid: 'cherry', amount_l: 0.02, tolerance_l: 0.003 }] }],
  });
  scene.valueNames = NAMES;
  scene.faultNames = ['device read failed', 'device write failed', 'stop requested'];
  return scene;
}

export function moment(values: Record<string, number>, more: Partial<WorldStateT> = {}): WorldStateT {
  const state = new WorldStateT();
  const usual: Record<string, number> = { drink: 1, drinks: 2, step: 1, steps: 2, target_dispenser: 1, engaged_dispenser: -1, squeeze_low_n: 4, squeeze_high_n: 8, squeeze_full_n: 20, over_glass: 1, 'layer_l/0': 0.0304, asked_l: 0.02 };
  state.values = NAMES.map((name) => values[name] ?? usual[name] ?? 0);
  state.runState = RunState.Rendering;
  state.steering = Steering.Person;
  state.qM = state.intention = [0, 0, 0];
  return Object.assign(state, more);
}

/** The bar in the game after these states. */
export function playOfSunset(...states: WorldStateT[]): BarPlay {
  const scene = sceneOfSunset();
  const play = new BarPlay(barOf(scene)!, scene);
  for (const state of states) play.follow(state);
  return play;
}
