import { createReadStream, readdirSync, readFileSync } from 'node:fs';
import { join } from 'node:path';
import { defineConfig, type Plugin } from 'vite';
import { BUNDLED, licenceTexts } from './tools/licences';

// Address of the program while the pages are served by "npm run dev".
const program = `http://127.0.0.1:${process.env.WHOLEHAND_PORT ?? '8080'}`;

/** Hand tracking by webcam: its program and models, served from this origin and never from the network. */
function mediapipeHands(): Plugin {
  const folder = join(__dirname, 'node_modules', '@mediapipe', 'hands');
  const wanted = /\.(js|wasm|data|tflite|binarypb)$/;
  const type = (name: string) => name.endsWith('.js') ? 'text/javascript' : name.endsWith('.wasm') ? 'application/wasm' : 'application/octet-stream';
  return {
    name: 'wholehand-mediapipe-hands',
    configureServer(server) {
      server.middlewares.use('/mediapipe/', (request, response, next) => {
        const name = (request.url ?? '').split('?')[0].slice(1);
        if (!wanted.test(name) || !readdirSync(folder).includes(name)) return next();
        response.setHeader('Content-Type', type(name));
        createReadStream(join(folder, name)).pipe(response);
      });
    },
    generateBundle() {
      for (const name of readdirSync(folder).filter((n) => wanted.test(n)))
        this.emitFile({ type: 'asset', fileName: `mediapipe/${name}`, source: readFileSync(join(folder, name)) });
    },
  };
}

/** Serves `/console` as console.html, `/clinic` as clinic.html, `/commission` as commission.html, `/replay` as replay.html, like the program does. */
function consoleAddress(): Plugin {
  return {
    name: 'wholehand-console-address',
    configureServer(server) {
      server.middlewares.use((request, _response, next) => {
        if (request.url) request.url = request.url.replace(/^\/(console|clinic|commission|replay)(?=\?|#|$)/, '/$1.html');
        next();
      });
    },
  };
}

/** The licence texts of the bundled packages, beside the pages. */
function licences(): Plugin {
  return {
    name: 'wholehand-licences',
    generateBundle() { this.emitFile({ type: 'asset', fileName: 'licences.txt', source: licenceTexts([...BUNDLED, '@mediapipe/hands']) }); },
  };
}

export default defineConfig({
  plugins: [mediapipeHands(), consoleAddress(), licences()],
  server: {
    host: '127.0.0.1',
    port: 5173,
    proxy: {
      '/ws': { target: program, ws: true },
      '/api': program,
      '/healthz': program,
      '/metrics': program,
    },
  },
  build: {
    target: 'es2022',
    outDir: 'dist',
    emptyOutDir: true,
    assetsInlineLimit: 0,  // no data: addresses, so that the content policy can be strict
    modulePreload: { polyfill: false },
    chunkSizeWarningLimit: 900,
    reportCompressedSize: false,
    rollupOptions: { input: { game: 'index.html', console: 'console.html', clinic: 'clinic.html', commission: 'commission.html', replay: 'replay.html' } },
  },
});
