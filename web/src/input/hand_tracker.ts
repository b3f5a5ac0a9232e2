import type { Landmark } from './landmarks';

/** Messages from the page to tracker_worker.ts, and back. */
export type ToTracker = { readonly is: 'load'; readonly folder: string } | { readonly is: 'look'; readonly picture: ImageBitmap };
export type FromTracker =
  | { readonly is: 'ready' }
  | { readonly is: 'looked'; readonly image: Landmark[]; readonly world: Landmark[] }
  | { readonly is: 'failed'; readonly why: string };

/** The landmarks of the hand in a picture; empty where no hand is seen. */
export interface TrackedHand { readonly image: readonly Landmark[]; readonly world: readonly Landmark[] }

/** The tracker and its models are served with the page: no other server is asked. */
const FOLDER = '/mediapipe/';
/** Time limit for loading and the first picture [ms]: a slow machine needs half a minute, and a second per picture. */
const LOADS_MS = 120_000;
const LOOKS_MS = 20_000;

/** Finds a hand in pictures, in a worker: it is loaded with the first camera, and ended by close(). */
export class HandTracker {
  private readonly worker = new Worker(new URL('./tracker_worker.ts', import.meta.url));
  private settle: ((message: FromTracker) => void) | undefined;

  constructor() {
    this.worker.onmessage = ({ data }: MessageEvent<FromTracker>) => this.settle?.(data);
    this.worker.onerror = ({ message }) => this.settle?.({ is: 'failed', why: message });
  }

  /** Rejects if the tracker cannot be loaded, or without WebGL. Afterwards the first picture is as fast as any. */
  async load(): Promise<void> {
    await this.ask({ is: 'load', folder: FOLDER }, LOADS_MS);
  }

  /** Processes one picture at a time, and takes ownership of it. Rejects after close(). */
  async look(picture: ImageBitmap): Promise<TrackedHand> {
    const answer = await this.ask({ is: 'look', picture }, LOOKS_MS, [picture]);
    return answer.is === 'looked' ? answer : { image: [], world: [] };
  }

  close(): void {
    this.worker.terminate();
    this.settle?.({ is: 'failed', why: 'closed' });
  }

  private ask(order: ToTracker, within_ms: number, transfer: Transferable[] = []): Promise<FromTracker> {
    return new Promise((done, fail) => {
      const late = setTimeout(() => this.settle?.({ is: 'failed', why: 'no answer' }), within_ms);
      this.settle = (message) => {
        clearTimeout(late);
        this.settle = undefined;
        if (message.is === 'failed') fail(new Error(`hand tracking: ${message.why}`));
        else done(message);
      };
      this.worker.postMessage(order, transfer);
    });
  }
}
