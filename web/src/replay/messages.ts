import * as flatbuffers from 'flatbuffers';
import { GameBodies, Message, Payload, Scene, SCHEMA_VERSION, WorldState, type GameBodiesT, type SceneT, type WorldStateT } from '../protocol';
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

/** Runs a reader; unreadable bytes throw a Problem and nothing else. */
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

export function readGameBodies(bytes: Uint8Array): GameBodiesT {
  return reading(() => (open(bytes, Payload.GameBodies).payload(new GameBodies()) as GameBodies).unpack());
}

/** The time of a state, without reading the whole message. */
export function timeOfState(bytes: Uint8Array): number {
  return reading(() => (open(bytes, Payload.WorldState).payload(new WorldState()) as WorldState).timeS());
}

/** Splits an answer into its messages. Each follows a header whose last four bytes are the message's length. */
export function cutMessages(buffer: ArrayBuffer, headBytes: number): { at: number; message: Uint8Array }[] {
  const view = new DataView(buffer);
  const messages: { at: number; message: Uint8Array }[] = [];
  for (let at = 0; at < buffer.byteLength;) {
    const begin = at + headBytes;
    const length = begin <= buffer.byteLength ? view.getUint32(begin - 4, true) : NaN;
    if (!(begin + length <= buffer.byteLength)) throw new Problem('nonsense', `a message is cut at byte ${at} of ${buffer.byteLength}`);
    messages.push({ at, message: new Uint8Array(buffer, begin, length) });
    at = begin + length;
  }
  return messages;
}

/** Messages of the answer of .../replay/states; they are parsed when they are shown. */
export function splitStates(buffer: ArrayBuffer): Uint8Array[] {
  return cutMessages(buffer, 4).map(({ message }) => message);
}
