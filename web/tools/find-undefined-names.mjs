// find-undefined-names.mjs FOLDER ...: names in the JavaScript of these folders that nothing defines. The pages are
// checked by TypeScript as a whole; the browser tests are plain JavaScript, where such a name shows only when its line
// runs, which may be after an hour. Exit code 1 where there are any.
import { readdirSync } from 'node:fs';
import { join } from 'node:path';
import ts from 'typescript';

const UNDEFINED = new Set([2304, 2552, 18004]);  // "Cannot find name", with a suggestion, in a shorthand property

const files = process.argv.slice(2).flatMap((folder) => readdirSync(folder).filter((name) => name.endsWith('.mjs')).map((name) => join(folder, name)));
const program = ts.createProgram(files, {
  allowJs: true, checkJs: true, noEmit: true, skipLibCheck: true, target: ts.ScriptTarget.ES2022, module: ts.ModuleKind.ESNext,
  moduleResolution: ts.ModuleResolutionKind.Bundler, lib: ['lib.es2022.d.ts', 'lib.dom.d.ts', 'lib.dom.iterable.d.ts'],
});
const found = files.map((file) => program.getSourceFile(file)).flatMap((source) => program.getSemanticDiagnostics(source))
  .filter(({ code }) => UNDEFINED.has(code));
for (const { file, start, messageText } of found) {
  const { line } = file.getLineAndCharacterOfPosition(start);
  console.error(`${file.fileName}:${line + 1}: ${ts.flattenDiagnosticMessageText(messageText, ' ')}`);
}
if (files.length === 0) console.error(`no .mjs file in ${process.argv.slice(2).join(', ') || 'no folder'}`);
process.exit(found.length === 0 && files.length > 0 ? 0 : 1);
