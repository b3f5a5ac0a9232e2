// A person who plays only with keys: looks ten times a second, and presses what the help says.

const STAGE = { reach: 0, squeeze: 1, pouring: 2, letGo: 3, drinkDone: 4, levelDone: 5, drawBack: 6, breathe: 7 };
/** x in front of the row, and at a dispenser [m]. */
const IN_FRONT_M = -0.055;
const AT_M = 0.058;
/** Lateral offset from a right palm to the axis of the gripped object [m]. */
const GRIP_SIDE_M = 0.041;

/** Without help nothing moves the hand to its lane: stretched fingers enter this far beside a bottle's axis [m], with this tolerance. */
const LANE_M = 0.014;
const LANE_WIDE_M = 0.018;

/** The keys that a person would hold now; with `help` "none" the person must enter beside the bottle without help. */
export function keysFor(now, help = 'full') {
  const [x, y] = [now.q[now.axes.indexOf('x')], now.q[now.axes.indexOf('y')]];
  const { stage, target_dispenser: target, squeeze_n: squeeze } = now.values;
  const body = now.bodies[now.dispensers[target]];
  if (!body || stage === STAGE.drinkDone || stage === STAGE.levelDone || stage === STAGE.breathe) return [];
  if (stage === STAGE.letGo || stage === STAGE.drawBack) return squeeze > 1 || x < -0.074 ? [] : ['ArrowDown'];
  const aside = body[1] - GRIP_SIDE_M - y;
  const alone = help === 'none';
  if (alone && x < AT_M && Math.abs(aside - LANE_M) > LANE_WIDE_M) {
    if (x > IN_FRONT_M && aside < 0) return ['ArrowDown'];
    return [aside > LANE_M ? 'ArrowLeft' : 'ArrowRight'];
  }
  if (alone && x >= AT_M && aside > 0.012) return ['ArrowLeft'];
  if (x > IN_FRONT_M && Math.abs(aside) > 0.05) return ['ArrowDown'];
  if (x < IN_FRONT_M) {
    if (Math.abs(aside) > 0.04) return [aside > 0 ? 'ArrowLeft' : 'ArrowRight'];
    return ['ArrowUp'];
  }
  return x < AT_M || Math.abs(aside) > 0.012 ? ['ArrowUp'] : ['Space'];
}

/** Time limit for one drink, in the program's time. */
const WITHIN_TICKS = 300_000;

/** Plays until a drink is done; returns the last state. */
export async function playOneDrink(page, watcher, { help = 'full' } = {}) {
  const { tick: began } = await watcher.now();
  const held = new Set();
  const hold = async (wanted) => {
    for (const key of [...held].filter((k) => !wanted.includes(k))) {
      await page.keyboard.up(key);
      held.delete(key);
    }
    for (const key of wanted.filter((k) => !held.has(k))) {
      await page.keyboard.down(key);
      held.add(key);
    }
  };
  return watcher.until('a drink', async (now) => {
    if (now.values.stage === STAGE.drinkDone || now.values.stage === STAGE.levelDone) return true;
    if (now.tick - began > WITHIN_TICKS) throw new Error(`no drink within ${WITHIN_TICKS} ticks`);
    await hold(keysFor(now, help));
    return false;
  }, { within_ms: Infinity });
}
