// Before every file of tests: Node 18, which is Debian's, has WebCrypto, but not by its name of the browser.
import { webcrypto } from 'node:crypto';

if (!('crypto' in globalThis)) Object.defineProperty(globalThis, 'crypto', { value: webcrypto });
