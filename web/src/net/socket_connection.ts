/** The used part of a WebSocket; fake/fake_program.ts makes another implementation. */
export interface SocketConnection {
  binaryType: string;
  onopen: ((event: Event) => void) | null;
  onmessage: ((event: MessageEvent) => void) | null;
  onclose: ((event: CloseEvent) => void) | null;
  send(data: Uint8Array<ArrayBuffer>): void;
  /** Sends a heartbeat by itself while the page answers; null ends it. Without `keepAlive`, the page sends the heartbeats. */
  keepAlive?(heartbeat: Uint8Array<ArrayBuffer> | null): void;
  close(): void;
}
