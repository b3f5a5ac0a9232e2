// The real program as a child process: its page's address is the first line of its output.
import { spawn } from 'node:child_process';
import { createInterface } from 'node:readline';
import { existsSync } from 'node:fs';
import { HANGS_MS } from './browser.mjs';

/** All children that have not ended. */
const running = new Set();
process.once('exit', () => running.forEach((child) => child.kill('SIGKILL')));

/** It ends with its test. */
export function start(file, args, options) {
  const child = spawn(file, args, options);
  running.add(child);
  child.once('exit', () => running.delete(child));
  return child;
}

/** Ends every program except this one. */
export async function endPrograms(but = undefined) {
  await Promise.all([...running].filter((child) => child !== but).map((child) => new Promise((resolve) => {
    child.once('exit', resolve);
    child.kill('SIGKILL');
  })));
}

/** Runs a command to its end; throws its output if it failed. */
export async function letProgram({ file, args, folder, env = process.env }) {
  const child = start(file, args, { cwd: folder, env, stdio: ['ignore', 'pipe', 'pipe'], timeout: 2 * HANGS_MS, killSignal: 'SIGKILL' });
  const output = [];
  for (const stream of [child.stdout, child.stderr]) stream.on('data', (data) => output.push(String(data)));
  const code = await new Promise((resolve) => child.once('exit', resolve));
  if (code !== 0) throw new Error(`${args.join(' ')} ended with ${code}: ${output.join('')}`);
}

/** Starts the program and waits for its address. @param command the command, "run" by default */
export async function startProgram({ file, port = 0, args = [], folder, command = ['run'] }) {
  if (!existsSync(file)) throw new Error(`${file} is not there: build the program first`);
  const origin = process.env.WHOLEHAND_PAGES && command[0] === 'run' ? ['--origin', process.env.WHOLEHAND_PAGES] : [];
  const child = start(file, [...command, '--port', String(port), ...origin, ...args], { cwd: folder, stdio: ['ignore', 'pipe', 'pipe'] });
  const output = [];
  const ended = new Promise((resolve) => child.once('exit', (code, signal) => resolve({ code, signal })));
  const lines = createInterface({ input: child.stdout });
  child.stderr.on('data', (data) => output.push(String(data)));
  const url = await new Promise((resolve, reject) => {
    const timer = setTimeout(() => reject(new Error('the program printed no address')), HANGS_MS);
    lines.once('line', (line) => {
      clearTimeout(timer);
      const [address] = /https?:\/\/[^\s;]+/.exec(line) ?? [];
      if (address) resolve(address);
      else reject(new Error(`the first line is no address: ${line}`));
    });
    void ended.then(({ code }) => reject(new Error(`the program ended at once (${code}): ${output.join('')}`)));
  });
  lines.on('line', (line) => output.push(`${line}\n`));
  return {
    url,
    port: Number(new URL(url).port),
    child,
    pid: child.pid,
    output,
    ended,
    /** Suspends the program, or resumes it. */
    signal(name) { child.kill(name); },
    /** Asks it to end, or kills it. */
    async stop(signal = 'SIGINT') {
      child.kill(signal);
      const hangs = setTimeout(() => child.kill('SIGKILL'), HANGS_MS);
      const { code, signal: by } = await ended;
      clearTimeout(hangs);
      if (by !== null && by !== signal) throw new Error(`the program was ended by ${by}, not by ${signal}: ${output.join('')}`);
      return code;
    },
  };
}
