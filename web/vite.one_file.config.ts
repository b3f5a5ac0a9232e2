// A page in one file that works without the network: vite build --config vite.one_file.config.ts --mode NAME
// makes dist/NAME.html, the template that the program writes its data into (src/files/page).
import { resolve } from 'node:path';
import { defineConfig, type Plugin } from 'vite';
import { viteSingleFile } from 'vite-plugin-singlefile';
import { BUNDLED, licenceTexts } from './tools/licences';

/** The licence texts of the bundled packages, inside the page, which is distributed alone. */
function licences(): Plugin {
  return {
    name: 'wholehand-licences-inside',
    transformIndexHtml: () => [{ tag: 'script', attrs: { type: 'text/plain', id: 'licences' }, children: licenceTexts(BUNDLED), injectTo: 'body' }],
  };
}

export default defineConfig(({ mode }) => ({
  plugins: [licences(), viteSingleFile({ removeViteModuleLoader: true })],
  publicDir: false,
  // The worker cannot be a file of its own here.
  resolve: { alias: [{ find: /^\.\/start_skin_worker$/, replacement: resolve(__dirname, 'src/hand/start_skin_worker_inline.ts') }] },
  worker: { format: 'iife' },
  build: { target: 'es2022', outDir: 'dist', emptyOutDir: false, reportCompressedSize: false, chunkSizeWarningLimit: 2000, rollupOptions: { input: `${mode}.html` } },
}));
