// The real program as a child process: its page's address is the first line that it prints.
import { spawn } from 'node:child_process';
import { createInterface } from 'node:readline';
import { existsSync } from 'node:fs';
import { HANGS_MS } from './browser.mjs';

/** Every child that has not ended. */
const running = new Set();
process.once('exit', () => running.forEach((child) => child.kill('SIGKILL')));

/** Ends with its test. */
export function start(file, args, options) {
  const child = spawn(file, args, options);
  running.add(child);
  child.once('exit', () => running.delete(child));
  return child;
}

/** Ends every program but this one. */
export async function endPrograms(but = undefined) {
  await Promise.all([...running].filter((child) => child !== but).map((child) => new Promise((resolve) => {
    child.once('exit', resolve);
    child.kill('SIGKILL');
  })));
}

/** Lets it do something to its end; what it said where that failed. */
export async function letProgram({ file, args, folder, env = process.env }) {
  const child = start(file, args, { cwd: folder, env, stdio: ['ignore', 'pipe', 'pipe'], timeout: 2 * HANGS_MS, killSignal: 'SIGKILL' });
  const said = [];
  for (const stream of [child.stdout, child.stderr]) stream.on('data', (data) => said.push(String(data)));
  const code = await new Promise((resolve) => child.once('exit', resolve));
  if (code !== 0) throw new Error(`${args.join(' ')} ended with ${code}: ${said.join('')}`);
}

/** Starts it and waits for its address. @param command what it is to do, "run" where none is named */
export async function startProgram({ file, port = 0, args = [], folder, command = ['run'] }) {
  if (!existsSync(file)) throw new Error(`${file} is not there: build the program first`);
  const origin = process.env.WHOLEHAND_PAGES && command[0] === 'run' ? ['--origin', process.env.WHOLEHAND_PAGES] : [];
  const child = start(file, [...command, '--port', String(port), ...origin, ...args], { cwd: folder, stdio: ['ignore', 'pipe', 'pipe'] });
  const said = [];
  const ended = new Promise((resolve) => child.once('exit', (code, signal) => resolve({ code, signal })));
  const lines = createInterface({ input: child.stdout });
  child.stderr.on('data', (data) => said.push(String(data)));
  const url = await new Promise((resolve, reject) => {
    const timer = setTimeout(() => reject(new Error('the program printed no address')), HANGS_MS);
    lines.once('line', (line) => {
      clearTimeout(timer);
      const [address] = /https?:\/\/[^\s;]+/.exec(line) ?? [];
      if (address) resolve(address);
      else reject(new Error(`the first line is no address: ${line}`));
    });
    void ended.then(({ code }) => reject(new Error(`the program ended at once (${code}): ${said.join('')}`)));
  });
  lines.on('line', (line) => said.push(`${line}\n`));
  return {
    url,
    port: Number(new URL(url).port),
    child,
    pid: child.pid,
    said,
    ended,
    /** Freezes it, or lets it go on. */
    signal(name) { child.kill(name); },
    /** Asks it to end, or ends it without asking. */
    async stop(signal = 'SIGINT') {
      child.kill(signal);
      const hangs = setTimeout(() => child.kill('SIGKILL'), HANGS_MS);
      const { code, signal: by } = await ended;
      clearTimeout(hangs);
      if (by !== null && by !== signal) throw new Error(`the program was ended by ${by}, not by ${signal}: ${said.join('')}`);
      return code;
    },
  };
}
