// The line to the program in a worker: neither a hidden page's slow timers nor a long picture silence it.
import type { Line } from './line';

/** Messages from the page to line_worker.ts, and back. */
export type ToLine =
  | { readonly is: 'open'; readonly url: string }
  | { readonly is: 'send'; readonly bytes: Uint8Array<ArrayBuffer> }
  | { readonly is: 'hold'; readonly beat: Uint8Array<ArrayBuffer> | null }
  | { readonly is: 'answer' } | { readonly is: 'close' };
export type FromLine =
  | { readonly is: 'open' } | { readonly is: 'message'; readonly data: unknown }
  /** Asks whether the page is alive. It answers from its message loop, which no browser slows down. */
  | { readonly is: 'ask' }
  /** @param reason of the program, where it closed because it could not read a message; empty: none */
  | { readonly is: 'closed'; readonly reason: string };

export class WorkerLine implements Line {
  binaryType = 'arraybuffer';
  onopen: Line['onopen'] = null;
  onmessage: Line['onmessage'] = null;
  onclose: Line['onclose'] = null;
  private readonly worker = new Worker(new URL('./line_worker.ts', import.meta.url), { type: 'module' });

  constructor(url: string) {
    this.worker.onmessage = ({ data }: MessageEvent<FromLine>) => this.heard(data);
    this.worker.onerror = () => this.heard({ is: 'closed', reason: '' });
    this.tell({ is: 'open', url });
  }

  send(bytes: Uint8Array<ArrayBuffer>): void { this.tell({ is: 'send', bytes }); }
  hold(beat: Uint8Array<ArrayBuffer> | null): void { this.tell({ is: 'hold', beat }); }
  /** Closes the line after what was sent before has gone out. */
  close(): void { this.tell({ is: 'close' }); }

  private tell(order: ToLine): void { this.worker.postMessage(order); }

  private heard(message: FromLine): void {
    switch (message.is) {
      case 'open': this.onopen?.(new Event('open')); return;
      case 'message': this.onmessage?.(new MessageEvent('message', { data: message.data })); return;
      case 'ask': this.tell({ is: 'answer' }); return;
      case 'closed': this.onclose?.(new CloseEvent('close', { reason: message.reason }));
    }
  }
}
