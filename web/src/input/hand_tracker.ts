import type { Landmark } from './landmarks';

/** What the page sends to tracker_worker.ts, and what that sends to the page. */
export type ToTracker = { readonly is: 'load'; readonly folder: string } | { readonly is: 'look'; readonly picture: ImageBitmap };
export type FromTracker =
  | { readonly is: 'ready' }
  | { readonly is: 'looked'; readonly image: Landmark[]; readonly world: Landmark[] }
  | { readonly is: 'failed'; readonly why: string };

/** The landmarks of the hand in a picture; none where no hand is seen. */
export interface Looked { readonly image: readonly Landmark[]; readonly world: readonly Landmark[] }

/** The program and its models come with the page: nothing is asked of any other server. */
const FOLDER = '/mediapipe/';
/** A slow machine loads and warms up for half a minute; a picture takes it a second [ms]. */
const LOADS_MS = 120_000;
const LOOKS_MS = 20_000;

/** Finds a hand in pictures, in a thread of its own: loaded with the first camera, gone with close(). */
export class HandTracker {
  private readonly worker = new Worker(new URL('./tracker_worker.ts', import.meta.url));
  private settle: ((message: FromTracker) => void) | undefined;

  constructor() {
    this.worker.onmessage = ({ data }: MessageEvent<FromTracker>) => this.settle?.(data);
    this.worker.onerror = ({ message }) => this.settle?.({ is: 'failed', why: message });
  }

  /** Rejects where it cannot be loaded, or the machine has no WebGL. Afterwards the first picture is as fast as any. */
  async load(): Promise<void> {
    await this.ask({ is: 'load', folder: FOLDER }, LOADS_MS);
  }

  /** One at a time. Takes the picture away. Rejects where the tracker is gone. */
  async look(picture: ImageBitmap): Promise<Looked> {
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
