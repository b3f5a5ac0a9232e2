// The real program as a child process: its page's address is the first line that it prints.
import { spawn } from 'node:child_process';
import { createInterface } from 'node:readline';
import { existsSync } from 'node:fs';

const START_MS = 60_000;

/** Starts it and waits for its address. */
export async function startProgram({ file, port = 0, args = [], folder }) {
  if (!existsSync(file)) throw new Error(`${file} is not there: build the program first`);
  const origin = process.env.WHOLEHAND_PAGES ? ['--origin', process.env.WHOLEHAND_PAGES] : [];
  const child = spawn(file, ['run', '--port', String(port), ...origin, ...args], { cwd: folder, stdio: ['ignore', 'pipe', 'pipe'] });
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
