// Setup before every test file: Node 18, which Debian ships, has WebCrypto, but not under the browser's name.
import { webcrypto } from 'node:crypto';

if (!('crypto' in globalThis)) Object.defineProperty(globalThis, 'crypto', { value: webcrypto });
