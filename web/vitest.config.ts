import { defineConfig } from 'vitest/config';

// Loading three.js again for every file took longer than the tests. WHOLEHAND_FULL=1 isolates files, and so finds a file that depends on another.
const isolate = process.env.WHOLEHAND_FULL === '1';

export default defineConfig({
  test: {
    include: ['tests/**/*.test.ts'],
    setupFiles: ['tests/as_in_a_browser.ts'],
    environment: 'node',
    testTimeout: 60_000,
    pool: 'threads',
    isolate,
  },
});
