/** The part of a WebSocket that is used; net/fake_program.ts makes another one. */
export interface Line {
  binaryType: string;
  onopen: ((event: Event) => void) | null;
  onmessage: ((event: MessageEvent) => void) | null;
  onclose: ((event: CloseEvent) => void) | null;
  send(data: Uint8Array<ArrayBuffer>): void;
  /** Sends a beat by itself, for as long as the page answers; null ends it. Where a line has no `hold`, the page sends the beats. */
  hold?(beat: Uint8Array<ArrayBuffer> | null): void;
  close(): void;
}
