import * as flatbuffers from 'flatbuffers';
import { expect } from 'vitest';
import type { Line } from '../src/net/line';
import { Command, Message, MessageT, Order, Payload, SCHEMA_VERSION, WelcomeT } from '../src/protocol';

/** A line whose other end is the test. */
export class TestLine implements Line {
  binaryType = '';
  onopen: Line['onopen'] = null;
  onmessage: Line['onmessage'] = null;
  onclose: Line['onclose'] = null;
  closed = false;
  readonly sent: { id: number; order: Order; table: Command }[] = [];

  send(data: Uint8Array<ArrayBuffer>): void {
    const message = Message.getRootAsMessage(new flatbuffers.ByteBuffer(data));
    expect(message.schemaVersion()).toBe(SCHEMA_VERSION);
    const table = message.payload(new Command()) as Command;
    this.sent.push({ id: table.id(), order: table.orderType(), table });
  }
  close(): void { this.closed = true; }
  say(kind: Payload, payload: MessageT['payload'], version = SCHEMA_VERSION): void {
    const builder = new flatbuffers.Builder(256);
    Message.finishMessageBuffer(builder, new MessageT(version, kind, payload).pack(builder));
    this.deliver(builder.asUint8Array().slice().buffer);
  }
  deliver(data: unknown): void { this.onmessage?.({ data } as MessageEvent); }
  welcome(): void { this.say(Payload.Welcome, new WelcomeT(SCHEMA_VERSION, 7, true, '0.3.0')); }
  breaks(reason = ''): void { this.onclose?.({ reason } as CloseEvent); }
}
