// What a browser test gets, and what ends with it, passed or not: every page and every program.
import { join } from 'node:path';
import { expectNoFaults, HANGS_MS, openBrowser } from './browser.mjs';
import { endPrograms, startProgram } from './program.mjs';
import { startSleeper } from './sleeper.mjs';
import { openWatcher, RENDERING } from './watcher.mjs';

export const FULL = process.env.WHOLEHAND_FULL === '1';
/** A test of real time is not judged where it fails and a thread that only sleeps was kept waiting for longer. */
const DISTURBED_MS = 20;
/** After so much silence a game is let go of (docs/safety.md). */
const LETS_GO_MS = 200;
/** A page that waits for ever was let go of, perhaps: half of that silence explains it. A shorter pause does not: such a hang is judged. */
const EXPLAINS_A_HANG_MS = LETS_GO_MS / 2;
/** Nor is any other on a machine that stood still for so long: every end of waiting may have passed meanwhile. */
const STOOD_STILL_MS = HANGS_MS / 3;

export class Harness {
  #shared = null;
  #sleeper = startSleeper();
  #more = [];

  /** @param file the program; `folder`: where it runs; `output`: where pictures and figures go */
  constructor({ file, folder, output }) {
    Object.assign(this, { file, folder, output });
  }

  /** Two browsers for all tests: one draws no 3D. A test that fails leaves neither of them, nor the program, to the next. */
  async #open() {
    [this.plain, this.drawing] = await Promise.all([openBrowser({ with3d: false }), openBrowser()]);
  }

  /** One more browser. */
  async browser(options) {
    this.#more.push(await openBrowser(options));
    return this.#more.at(-1);
  }

  /** A program of its own, which waits to be started. */
  program(...args) {
    return startProgram({ file: this.file, folder: this.folder, args: ['--wait', ...args] });
  }

  /** A console beside the program that tests share: it renders, and nobody holds the controls. */
  async watcher() {
    this.#shared ??= await this.program();
    const watcher = await openWatcher(this.plain, this.#shared.url);
    watcher.program = this.#shared;
    await watcher.free();
    if ((await watcher.now()).runState !== RENDERING) await watcher.arm();
    await watcher.rendering();
    return watcher;
  }

  /** Keeps what a page looks like, for a look later: with WHOLEHAND_FULL only. */
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
