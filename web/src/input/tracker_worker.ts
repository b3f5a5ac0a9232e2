// Finds the hand in the camera's pictures, in a worker. See hand_tracker.ts. It is a classic worker, because the
// tracker is a classic script that loads others by importScripts.
import type { Hands, Results } from '@mediapipe/hands';
import type { FromTracker, ToTracker } from './hand_tracker';

declare function importScripts(...urls: string[]): void;
const post = (message: FromTracker): void => { postMessage(message); };

interface ScriptElement { src: string; loaded: () => void }

/**
 * The tracker expects a page with scripts and canvases; its own support for workers fails without a drawing context
 * (0.4.1675469240). So this provides the parts of a page that it uses.
 */
function standInForAPage(): void {
  const script = (): object => {
    const made: ScriptElement = { src: '', loaded: () => {} };
    return Object.assign(made, {
      setAttribute: (name: string, value: string) => { if (name === 'src') made.src = value; },
      addEventListener: (type: string, listener: () => void) => { if (type === 'load') made.loaded = listener; },
    });
  };
  const body = { appendChild: ({ src, loaded }: ScriptElement) => { importScripts(src); loaded(); } };
  const createElement = (name: string): object => (name === 'script' ? script() : new OffscreenCanvas(1, 1));
  Object.assign(self, { window: self, document: { createElement, body, addEventListener: () => {} } });
}

// The tracker prints its log as warnings and errors.
for (const kind of ['warn', 'error'] as const) {
  const print = console[kind];
  console[kind] = (...parts: unknown[]): void => { if (!/^[IW]\d{4} /.test(String(parts[0]))) print(...parts); };
}

let hands: Hands | undefined;
let latest: Results | undefined;

async function load(folder: string): Promise<void> {
  standInForAPage();
  importScripts(`${folder}hands.js`);
  const { Hands: Made } = self as unknown as { Hands: typeof Hands };
  hands = new Made({ locateFile: (file) => folder + file });
  // Inference on the processor: the graphics card draws the picture, and without one each picture would take seconds.
  const onProcessor = { useCpuInference: true };   // known to hands.js, not to its types
  hands.setOptions({ maxNumHands: 1, modelComplexity: 0, minDetectionConfidence: 0.6, minTrackingConfidence: 0.5, ...onProcessor });
  hands.onResults((results) => { latest = results; });
  await hands.initialize();
  // The first picture takes far longer than later ones, so it is processed before play.
  await hands.send({ image: new OffscreenCanvas(64, 48) as unknown as HTMLCanvasElement });
}

async function look(picture: ImageBitmap): Promise<void> {
  latest = undefined;
  await hands?.send({ image: picture as unknown as HTMLCanvasElement });
  picture.close();
  const { multiHandLandmarks, multiHandWorldLandmarks, image } = (latest ?? {}) as Partial<Results>;
  // The tracker's copy of the picture is not used.
  (image as Partial<ImageBitmap> | undefined)?.close?.();
  const plain = (points: typeof multiHandLandmarks): { x: number; y: number; z: number }[] => (points?.[0] ?? []).map(({ x, y, z }) => ({ x, y, z }));
  post({ is: 'looked', image: plain(multiHandLandmarks), world: plain(multiHandWorldLandmarks) });
}

addEventListener('message', ({ data: order }: MessageEvent<ToTracker>) => {
  const failed = (error: unknown): void => post({ is: 'failed', why: String(error) });
  if (order.is === 'load') load(order.folder).then(() => post({ is: 'ready' }), failed);
  else look(order.picture).catch(failed);
});
