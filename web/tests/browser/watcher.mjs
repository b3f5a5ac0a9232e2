// Reads the program's messages through the console's page: the same messages that a therapist's page gets.
import { openPage, pageUrl, pressUntil, until } from './browser.mjs';

export const RENDERING = 1;
export const STOPPED = 3;

/** A state in one line, for an error message. */
function inWords(now) {
  if (!now) return 'none';
  const { runState, steering, faults, level, tick, values, q } = now;
  return JSON.stringify({ runState, steering, faults, level, tick, values, q: q.map((v) => +v.toFixed(3)) });
}

/** A console without 3D: a therapist's, or with `query.role` "watcher" one that only watches. */
export async function openWatcher(browser, programUrl, query = {}) {
  const page = await openPage(browser, pageUrl(programUrl, '/console', { lang: 'en', theme: 'light', ...query }));
  const watcher = {
    page,
    url: programUrl,
    /** The latest state in plain numbers; figures of the exercise by their names. */
    async now() {
      return page.evaluate(() => {
        const { state, scene } = window.wholehandNow ?? {};
        if (!state || !scene) return null;
        const values = Object.fromEntries(scene.valueNames.map((name, i) => [name, state.values[i]]));
        const bar = scene.exerciseJson ? JSON.parse(scene.exerciseJson) : {};
        const bodies = Object.fromEntries(scene.bodies.map((body, i) => {
          const p = state.bodies[i]?.positionM;
          return [body.name, p ? [p.x, p.y, p.z] : null];
        }));
        return {
          values, bodies, dispensers: (bar.dispensers ?? []).map((d) => d.body), exerciseJson: scene.exerciseJson, rightHand: scene.rightHand,
          axes: scene.axes.map((axis) => axis.name),
          q: state.qM, sent: state.sent, runState: state.runState, steering: state.steering, faults: state.faults, session: state.session, level: scene.level,
          tick: Number(state.tick), endings: state.endings, shown: document.body.dataset.state,
        };
      });
    },
    /** Waits until a state looks so; where none does, the error shows the last one. */
    async until(what, look, options) {
      let last = null;
      try {
        return await until(what, async () => {
          last = await watcher.now();
          return last && await look(last) ? last : null;
        }, options);
      } catch (error) {
        throw new Error(`${error.message}; the last state: ${inWords(last)}`, { cause: error });
      }
    },
    rendering: () => watcher.until('rendering', (now) => now.runState === RENDERING),
    /** Stopped, with every effort at neutral. */
    neutral: () => watcher.until('neutral', (now) => now.runState === STOPPED && now.sent.every((effort) => Math.abs(effort) < 1e-6)),
    steered: () => watcher.until('the person steering', (now) => now.steering === 1 && now.runState === RENDERING),
    /** Nobody holds the controls. A page that has closed holds them until the program notices. */
    free: () => page.waitForSelector('[data-testid=holder]:has-text("free")'),
    /** Starts as a therapist does, to the end of the rehearsal. */
    arm: () => pressUntil('rendering', page, {
      async press() {
        for (const close of await page.locator('[data-testid=refused] button:visible').all()) await close.click();
        await page.click('[data-testid=arm]:enabled');
      },
      acted: async () => (await watcher.now())?.runState === RENDERING, refusal: '[data-testid=refused]',
    }),
    /** This much of the program's own time; one that does not render has none, and is given as many milliseconds. */
    async pass(ticks) {
      const { tick, runState } = await watcher.now();
      if (runState === RENDERING) await watcher.until(`${ticks} ticks more`, (now) => now.tick >= tick + ticks || now.runState !== RENDERING);
      else await new Promise((resolve) => setTimeout(resolve, ticks));
    },
  };
  await watcher.until('the first state', () => true);
  return watcher;
}
