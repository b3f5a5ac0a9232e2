/** Messages to the program: the page is alive, or busy with drawing. */
export interface Heartbeats { readonly alive: Uint8Array<ArrayBuffer>; readonly busy: Uint8Array<ArrayBuffer> }

/** The used part of a WebSocket; fake/fake_program.ts makes another implementation. */
export interface SocketConnection {
  binaryType: string;
  onopen: ((event: Event) => void) | null;
  onmessage: ((event: MessageEvent) => void) | null;
  onclose: ((event: CloseEvent) => void) | null;
  send(data: Uint8Array<ArrayBuffer>): void;
  /** Sends heartbeats by itself, which say whether the page answers; null ends them. Without `keepAlive`, the page sends them. */
  keepAlive?(heartbeats: Heartbeats | null): void;
  close(): void;
}
