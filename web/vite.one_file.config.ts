// A page that stands in one file, without the network: vite build --config vite.one_file.config.ts --mode NAME
// makes dist/NAME.html, the template that the program writes its data into (src/page).
import { resolve } from 'node:path';
import { defineConfig } from 'vite';
import { viteSingleFile } from 'vite-plugin-singlefile';

export default defineConfig(({ mode }) => ({
  plugins: [viteSingleFile({ removeViteModuleLoader: true })],
  publicDir: false,
  // A worker has no file of its own here.
  resolve: { alias: [{ find: /^\.\/start_skin_worker$/, replacement: resolve(__dirname, 'src/hand/start_skin_worker_inline.ts') }] },
  worker: { format: 'iife' },
  build: { target: 'es2022', outDir: 'dist', emptyOutDir: false, chunkSizeWarningLimit: 2000, rollupOptions: { input: `${mode}.html` } },
}));
