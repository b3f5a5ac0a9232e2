import * as flatbuffers from 'flatbuffers';
import { Message, Payload, Scene, SCHEMA_VERSION, WorldState, type SceneT, type WorldStateT } from '../protocol';
import { Problem } from './problem';

function open(bytes: Uint8Array, wanted: Payload): Message {
  const buffer = new flatbuffers.ByteBuffer(bytes);
  if (bytes.length < 12 || !Message.bufferHasIdentifier(buffer)) throw new Problem('nonsense', 'not a Wholehand message');
  const message = Message.getRootAsMessage(buffer);
  if (message.schemaVersion() !== SCHEMA_VERSION || message.payloadType() !== wanted) {
    throw new Problem('nonsense', `message of version ${message.schemaVersion()}, kind ${message.payloadType()}`);
  }
  return message;
}

/** Runs what reads a message; bytes that are none make a Problem and nothing else. */
function reading<T>(read: () => T): T {
  try {
    return read();
  } catch (thrown) {
    throw thrown instanceof Problem ? thrown : new Problem('nonsense', 'a message cannot be read');
  }
}

export function readScene(bytes: Uint8Array): SceneT {
  return reading(() => (open(bytes, Payload.Scene).payload(new Scene()) as Scene).unpack());
}

export function readState(bytes: Uint8Array): WorldStateT {
  return reading(() => (open(bytes, Payload.WorldState).payload(new WorldState()) as WorldState).unpack());
}

/** Only its time, without reading all of it. */
export function timeOfState(bytes: Uint8Array): number {
  return reading(() => (open(bytes, Payload.WorldState).payload(new WorldState()) as WorldState).timeS());
}

/** Cuts the answer of .../replay/states into its messages; they are read when they are shown. */
export function splitStates(buffer: ArrayBuffer): Uint8Array[] {
  const view = new DataView(buffer);
  const messages: Uint8Array[] = [];
  for (let at = 0; at < buffer.byteLength;) {
    const length = at + 4 <= buffer.byteLength ? view.getUint32(at, true) : NaN;
    if (!(at + 4 + length <= buffer.byteLength)) throw new Problem('nonsense', `states: a message is cut at byte ${at} of ${buffer.byteLength}`);
    messages.push(new Uint8Array(buffer, at + 4, length));
    at += 4 + length;
  }
  return messages;
}
