// The real program as a child process: its page's address is the first line that it prints.
import { spawn } from 'node:child_process';
import { createInterface } from 'node:readline';
import { existsSync } from 'node:fs';

const START_MS = 60_000;

/** Lets it do something to its end; what it said where that failed. */
export async function letProgram({ file, args, folder }) {
  const child = spawn(file, args, { cwd: folder, stdio: ['ignore', 'pipe', 'pipe'] });
  const said = [];
  for (const stream of [child.stdout, child.stderr]) stream.on('data', (data) => said.push(String(data)));
  const code = await new Promise((resolve) => child.once('exit', resolve));
  if (code !== 0) throw new Error(`${args.join(' ')} ended with ${code}: ${said.join('')}`);
}

/** Starts it and waits for its address. @param command what it is to do, "run" where none is named */
export async function startProgram({ file, port = 0, args = [], folder, command = ['run'] }) {
  if (!existsSync(file)) throw new Error(`${file} is not there: build the program first`);
  const origin = process.env.WHOLEHAND_PAGES && command[0] === 'run' ? ['--origin', process.env.WHOLEHAND_PAGES] : [];
  const child = spawn(file, [...command, '--port', String(port), ...origin, ...args], { cwd: folder, stdio: ['ignore', 'pipe', 'pipe'] });
  const said = [];
  const ended = new Promise((resolve) => child.once('exit', (code, signal) => resolve({ code, signal })));
  const lines = createInterface({ input: child.stdout });
  child.stderr.on('data', (data) => said.push(String(data)));
  const url = await new Promise((resolve, reject) => {
    const timer = setTimeout(() => reject(new Error('the program printed no address')), START_MS);
    lines.once('line', (line) => {
      clearTimeout(timer);
      if (/^https?:\/\//.test(line)) resolve(line.trim());
      else reject(new Error(`the first line is no address: ${line}`));
    });
    void ended.then(({ code }) => reject(new Error(`the program ended at once (${code}): ${said.join('')}`)));
  });
  lines.on('line', (line) => said.push(`${line}\n`));
  return {
    url,
    port: Number(new URL(url).port),
    pid: child.pid,
    said,
    ended,
    /** Freezes it, or lets it go on. */
    signal(name) { child.kill(name); },
    /** Asks it to end, or ends it without asking. */
    async stop(signal = 'SIGINT') {
      child.kill(signal);
      return ended;
    },
  };
}
