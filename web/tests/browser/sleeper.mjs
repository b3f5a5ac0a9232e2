// A thread that sleeps a millisecond at a time and records its longest delay: this measures how long the machine delays a
// thread that needs almost nothing.
import { Worker } from 'node:worker_threads';

const SLEEPS = `
  const { workerData: longest_ms } = require('node:worker_threads');
  const never = new Int32Array(new SharedArrayBuffer(4));
  for (let last = performance.now(); ;) {
    Atomics.wait(never, 0, 0, 1);
    const now = performance.now();
    longest_ms[0] = Math.max(longest_ms[0], now - last);
    last = now;
  }`;

/** Starts a sleeper. It returns the longest delay since the last call [ms]. */
export function startSleeper() {
  const longest_ms = new Float64Array(new SharedArrayBuffer(8));
  new Worker(SLEEPS, { eval: true, workerData: longest_ms }).unref();
  return () => {
    const longest = longest_ms[0];
    longest_ms[0] = 0;
    return longest;
  };
}
