// Type-checks pages, tests and tools in one run of the compiler, which takes half as long as three runs.
//  - Pages and tests as web/tests/tsconfig.json says.
//   - Pages must not use names of @types/node.
//   - Browser tests and tools are plain JavaScript: every name must be defined. An undefined name would otherwise show only
//       when its line runs, which may be after an hour.
import { readdirSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import ts from 'typescript';

const WEB = dirname(dirname(fileURLToPath(import.meta.url)));
const UNDEFINED = new Set([2304, 2552, 18004]);  // "Cannot find name", with a suggestion, in a shorthand property
const scripts = ['tests/browser', 'tools'].flatMap((folder) => readdirSync(join(WEB, folder)).filter((name) => name.endsWith('.mjs')).map((name) => join(WEB, folder, name)));
if (scripts.length === 0) throw new Error('no script in tests/browser and tools');

const { options, fileNames, errors } = ts.getParsedCommandLineOfConfigFile(join(WEB, 'tests', 'tsconfig.json'), {}, {
  ...ts.sys, onUnRecoverableConfigFileDiagnostic: (problem) => { throw new Error(ts.flattenDiagnosticMessageText(problem.messageText, '\n')); },
});
const program = ts.createProgram([...fileNames, ...scripts, ...ts.sys.readDirectory(join(WEB, 'src'), ['.ts'])], { ...options, allowJs: true, checkJs: true });
const checker = program.getTypeChecker();
const problems = [...errors, ...program.getGlobalDiagnostics(), ...program.getSyntacticDiagnostics()];

const saysNode = (symbol) => symbol?.declarations?.length > 0 && symbol.declarations.every((one) => one.getSourceFile().fileName.includes('/@types/node/'));
function nodesNames(file, node) {
  if ((ts.isIdentifier(node) || ts.isStringLiteral(node)) && saysNode(checker.getSymbolAtLocation(node))) {
    problems.push({ file, start: node.getStart(), length: node.getWidth(), category: ts.DiagnosticCategory.Error, code: 1, messageText: `"${node.text}" is of Node, which no page has` });
  }
  ts.forEachChild(node, (child) => nodesNames(file, child));
}

for (const file of program.getSourceFiles()) {
  if (file.isDeclarationFile || file.fileName.includes('/node_modules/')) continue;
  const found = program.getSemanticDiagnostics(file);
  problems.push(...(file.fileName.endsWith('.mjs') ? found.filter(({ code }) => UNDEFINED.has(code)) : found));
  if (file.fileName.startsWith(join(WEB, 'src/')) && !file.fileName.includes('/generated/')) nodesNames(file, file);
}
if (problems.length > 0) console.error(ts.formatDiagnostics(problems, { getCurrentDirectory: () => WEB, getCanonicalFileName: (name) => name, getNewLine: () => '\n' }));
process.exit(problems.length > 0 ? 1 : 0);
