// Beside the page's thread: finds the hand in pictures of the camera. See hand_tracker.ts. A classic worker, as the
// tracker is a classic script that loads others by importScripts.
import type { Hands, Results } from '@mediapipe/hands';
import type { FromTracker, ToTracker } from './hand_tracker';

declare function importScripts(...urls: string[]): void;
const tell = (message: FromTracker): void => { postMessage(message); };

interface Scripted { src: string; loaded: () => void }

/**
 * The tracker asks a page for scripts and canvases, and its own way in a worker ends without a context for drawing
 * (0.4.1675469240). So it gets as much of a page as it asks for.
 */
function standInForAPage(): void {
  const script = (): object => {
    const made: Scripted = { src: '', loaded: () => {} };
    return Object.assign(made, {
      setAttribute: (name: string, value: string) => { if (name === 'src') made.src = value; },
      addEventListener: (type: string, heard: () => void) => { if (type === 'load') made.loaded = heard; },
    });
  };
  const body = { appendChild: ({ src, loaded }: Scripted) => { importScripts(src); loaded(); } };
  const createElement = (name: string): object => (name === 'script' ? script() : new OffscreenCanvas(1, 1));
  Object.assign(self, { window: self, document: { createElement, body, addEventListener: () => {} } });
}

// The tracker prints its notes as warnings and errors.
for (const kind of ['warn', 'error'] as const) {
  const say = console[kind];
  console[kind] = (...said: unknown[]): void => { if (!/^[IW]\d{4} /.test(String(said[0]))) say(...said); };
}

let hands: Hands | undefined;
let latest: Results | undefined;

async function load(folder: string): Promise<void> {
  standInForAPage();
  importScripts(`${folder}hands.js`);
  const { Hands: Made } = self as unknown as { Hands: typeof Hands };
  hands = new Made({ locateFile: (file) => folder + file });
  // On the processor: the graphics card draws the picture, and where there is none it would take seconds for each look.
  const onProcessor = { useCpuInference: true };   // known to hands.js, not to its types
  hands.setOptions({ maxNumHands: 1, modelComplexity: 0, minDetectionConfidence: 0.6, minTrackingConfidence: 0.5, ...onProcessor });
  hands.onResults((results) => { latest = results; });
  await hands.initialize();
  // The first picture takes far longer than those that follow: better now than in the play.
  await hands.send({ image: new OffscreenCanvas(64, 48) as unknown as HTMLCanvasElement });
}

async function look(picture: ImageBitmap): Promise<void> {
  latest = undefined;
  await hands?.send({ image: picture as unknown as HTMLCanvasElement });
  picture.close();
  const { multiHandLandmarks, multiHandWorldLandmarks, image } = (latest ?? {}) as Partial<Results>;
  // A copy of the picture, which nobody looks at.
  (image as Partial<ImageBitmap> | undefined)?.close?.();
  const plain = (points: typeof multiHandLandmarks): { x: number; y: number; z: number }[] => (points?.[0] ?? []).map(({ x, y, z }) => ({ x, y, z }));
  tell({ is: 'looked', image: plain(multiHandLandmarks), world: plain(multiHandWorldLandmarks) });
}

addEventListener('message', ({ data: order }: MessageEvent<ToTracker>) => {
  const failed = (error: unknown): void => tell({ is: 'failed', why: String(error) });
  if (order.is === 'load') load(order.folder).then(() => tell({ is: 'ready' }), failed);
  else look(order.picture).catch(failed);
});
