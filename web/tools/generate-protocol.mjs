// Writes src/protocol/generated from ../protocol/wholehand.fbs when the schema is newer.
import { spawnSync } from 'node:child_process';
import { existsSync, mkdirSync, readdirSync, readFileSync, renameSync, rmSync, statSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';

const web = dirname(dirname(fileURLToPath(import.meta.url)));
const schema = join(web, '..', 'protocol', 'wholehand.fbs');
const folder = join(web, 'src', 'protocol', 'generated');
const index = join(folder, 'wholehand_generated.ts');

if (!existsSync(index) || statSync(index).mtimeMs < statSync(schema).mtimeMs) {
  // The output goes to a temporary folder first: a simultaneous build never sees a partial protocol.
  const fresh = `${folder}.${process.pid}`;
  mkdirSync(fresh, { recursive: true });
  const flatc = process.env.FLATC ?? 'flatc';
  const run = spawnSync(flatc, ['--ts', '--gen-object-api', '-o', fresh, schema], { stdio: 'inherit' });
  if (run.error || run.status !== 0) {
    rmSync(fresh, { recursive: true, force: true });
    console.error(run.error
      ? `The schema compiler "${flatc}" could not be started: install the Debian package flatbuffers-compiler, or name it in FLATC.`
      : `flatc refused ${schema}.`);
    process.exit(1);
  }
  // The output of flatc does not satisfy our stricter compiler options.
  const types = join(fresh, 'wholehand', 'protocol');
  for (const name of readdirSync(types))
    writeFileSync(join(types, name), `// @ts-nocheck\n${readFileSync(join(types, name), 'utf8')}`);
  rmSync(folder, { recursive: true, force: true });
  renameSync(fresh, folder);
}
