// The environment of a browser test; every page and program of it ends with the test.
import { join } from 'node:path';
import { expectNoFaults, HANGS_MS, openBrowser } from './browser.mjs';
import { endPrograms, startProgram } from './program.mjs';
import { startSleeper } from './sleeper.mjs';
import { openWatcher, RENDERING } from './watcher.mjs';

export const FULL = process.env.WHOLEHAND_FULL === '1';
/** A failed real-time test is not judged if a thread that only sleeps was delayed for longer than this. */
const DISTURBED_MS = 20;
/** A game without a heartbeat for this long loses the controls (docs/safety.md). */
const LETS_GO_MS = 200;
/** A page that waits forever may have lost the controls: half of that silence explains it. After a shorter delay such a hang is judged. */
const EXPLAINS_A_HANG_MS = LETS_GO_MS / 2;
/** A test on a machine that stalled for this long is not judged either: every timeout may have expired meanwhile. */
const STOOD_STILL_MS = HANGS_MS / 3;

export class Harness {
  #shared = null;
  #sleeper = startSleeper();
  #more = [];

  /** @param file the program @param folder its working folder @param output folder for pictures and figures */
  constructor({ file, folder, output }) {
    Object.assign(this, { file, folder, output });
  }

  /** Two browsers for all tests: one without 3D. After a failed test both and the program are replaced. */
  async #open() {
    [this.plain, this.drawing] = await Promise.all([openBrowser({ with3d: false }), openBrowser()]);
  }

  /** Starts an additional browser. */
  async browser(options) {
    this.#more.push(await openBrowser(options));
    return this.#more.at(-1);
  }

  /** A program of its own, which is not started yet. */
  program(...args) {
    return startProgram({ file: this.file, folder: this.folder, args: ['--wait', ...args] });
  }

  /** A console for the shared program: it renders, and nobody holds the controls. */
  async watcher() {
    this.#shared ??= await this.program();
    const watcher = await openWatcher(this.plain, this.#shared.url);
    watcher.program = this.#shared;
    await watcher.free();
    if ((await watcher.now()).runState !== RENDERING) await watcher.arm();
    await watcher.rendering();
    return watcher;
  }

  /** Takes a screenshot for later inspection, only with WHOLEHAND_FULL. */
  async picture(page, name) {
    if (FULL) await page.screenshot({ path: join(this.output, `${name}.png`) });
  }

  async close() {
    await Promise.all([this.plain, this.drawing, ...this.#more].map((browser) => browser?.close()));
    [this.plain, this.drawing, this.#more] = [undefined, undefined, []];
    await endPrograms();
    this.#shared = null;
  }

  /** Runs a test. @return 'ok', 'FAIL' or 'not judged' */
  async run(name, check, { paced = false } = {}) {
    const began_ms = Date.now();
    this.#sleeper();
    try {
      if (!this.plain) await this.#open();
      const words = (await check(this)) ?? '';
      const contexts = [this.plain, this.drawing, ...this.#more].flatMap((browser) => browser.contexts());
      expectNoFaults(...contexts.flatMap((context) => context.pages()).filter(({ faults }) => faults));
      for (const opened of [contexts, this.#more.splice(0)]) await Promise.all(opened.map((each) => each.close()));
      await endPrograms(this.#shared?.child);
      console.log(`ok    ${name} (${((Date.now() - began_ms) / 1000).toFixed(1)} s) ${words}`);
      return 'ok';
    } catch (error) {
      const kept_ms = this.#sleeper(), hung = Date.now() - began_ms >= HANGS_MS;
      await this.close();
      const judged = kept_ms <= (!paced ? STOOD_STILL_MS : hung ? EXPLAINS_A_HANG_MS : DISTURBED_MS);
      console.log(judged ? `FAIL  ${name}: ${error.message.slice(0, 3000)}` : `not judged: ${name}: this machine kept a sleeper waiting for ${kept_ms.toFixed(0)} ms (${error.message.split('\n')[0]})`);
      return judged ? 'FAIL' : 'not judged';
    }
  }
}
