// The connection to the program in a worker: slow timers of a hidden page and long drawing do not interrupt its heartbeats.
import type { Heartbeats, SocketConnection } from './socket_connection';

/** Messages from the page to connection_worker.ts, and back. */
export type WorkerRequest =
  | { readonly is: 'open'; readonly url: string }
  | { readonly is: 'send'; readonly bytes: Uint8Array<ArrayBuffer> }
  | { readonly is: 'hold'; readonly heartbeats: Heartbeats | null }
  | { readonly is: 'answer' } | { readonly is: 'close' };
export type WorkerMessage =
  | { readonly is: 'open' } | { readonly is: 'message'; readonly data: unknown }
  /** Asks whether the page is alive. The page answers from its message loop, which no browser slows down. */
  | { readonly is: 'ask' }
  /** @param reason the program's reason if it closed because it could not read a message; empty: none */
  | { readonly is: 'closed'; readonly reason: string };

export class WorkerConnection implements SocketConnection {
  binaryType = 'arraybuffer';
  onopen: SocketConnection['onopen'] = null;
  onmessage: SocketConnection['onmessage'] = null;
  onclose: SocketConnection['onclose'] = null;
  private readonly worker = new Worker(new URL('./connection_worker.ts', import.meta.url), { type: 'module' });

  constructor(url: string) {
    this.worker.onmessage = ({ data }: MessageEvent<WorkerMessage>) => this.onMessage(data);
    this.worker.onerror = () => this.onMessage({ is: 'closed', reason: '' });
    this.post({ is: 'open', url });
  }

  send(bytes: Uint8Array<ArrayBuffer>): void { this.post({ is: 'send', bytes }); }
  keepAlive(heartbeats: Heartbeats | null): void { this.post({ is: 'hold', heartbeats }); }
  /** Closes the connection after sending what was queued before. */
  close(): void { this.post({ is: 'close' }); }

  private post(order: WorkerRequest): void { this.worker.postMessage(order); }

  private onMessage(message: WorkerMessage): void {
    switch (message.is) {
      case 'open': this.onopen?.(new Event('open')); return;
      case 'message': this.onmessage?.(new MessageEvent('message', { data: message.data })); return;
      case 'ask': this.post({ is: 'answer' }); return;
      case 'closed': this.onclose?.(new CloseEvent('close', { reason: message.reason }));
    }
  }
}
