import * as flatbuffers from 'flatbuffers';
import { expect } from 'vitest';
import type { SocketConnection } from '../src/net/socket_connection';
import { Command, Message, MessageT, Order, Payload, SCHEMA_VERSION, WelcomeT } from '../src/protocol';

/** A connection whose other end is the test. */
export class TestConnection implements SocketConnection {
  binaryType = '';
  onopen: SocketConnection['onopen'] = null;
  onmessage: SocketConnection['onmessage'] = null;
  onclose: SocketConnection['onclose'] = null;
  closed = false;
  readonly sent: { id: number; order: Order; table: Command }[] = [];

  send(data: Uint8Array<ArrayBuffer>): void {
    const message = Message.getRootAsMessage(new flatbuffers.ByteBuffer(data));
    expect(message.schemaVersion()).toBe(SCHEMA_VERSION);
    const table = message.payload(new Command()) as Command;
    this.sent.push({ id: table.id(), order: table.orderType(), table });
  }
  close(): void { this.closed = true; }
  sendMessage(kind: Payload, payload: MessageT['payload'], version = SCHEMA_VERSION): void {
    const builder = new flatbuffers.Builder(256);
    Message.finishMessageBuffer(builder, new MessageT(version, kind, payload).pack(builder));
    this.deliver(builder.asUint8Array().slice().buffer);
  }
  deliver(data: unknown): void { this.onmessage?.({ data } as MessageEvent); }
  welcome(): void { this.sendMessage(Payload.Welcome, new WelcomeT(SCHEMA_VERSION, 7, true, '0.3.0')); }
  disconnect(reason = ''): void { this.onclose?.({ reason } as CloseEvent); }
}
