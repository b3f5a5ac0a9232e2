// Reads the program's bytes as a message. FlatBuffers has no verifier in this language: a WebSocket delivers complete
// messages, and the program verifies its own. For any bytes, reading ends and throws nothing.
import {
  Commissioning, Controls, Events, GameBodies, Message, Payload, Reply, Scene, SCHEMA_VERSION, Welcome, WorldState,
  type CommissioningT, type ControlsT, type EventT, type GameBodiesT, type ReplyT, type SceneT, type WelcomeT, type WorldStateT,
} from '../protocol';
import { BoundedBuffer } from './bounded_buffer';

export type ReceivedMessage =
  | { readonly is: 'state'; readonly value: WorldStateT } | { readonly is: 'scene'; readonly value: SceneT }
  | { readonly is: 'events'; readonly value: readonly EventT[] } | { readonly is: 'welcome'; readonly value: WelcomeT }
  | { readonly is: 'controls'; readonly value: ControlsT } | { readonly is: 'commissioning'; readonly value: CommissioningT }
  | { readonly is: 'reply'; readonly value: ReplyT } | { readonly is: 'bodies'; readonly value: GameBodiesT }
  /** A message of another version of the schema. */
  | { readonly is: 'foreign'; readonly version: number }
  | { readonly is: 'unreadable' };

export function readMessage(data: unknown): ReceivedMessage {
  try {
    const buffer = new BoundedBuffer(new Uint8Array(data as ArrayBuffer));
    if (!Message.bufferHasIdentifier(buffer)) return { is: 'unreadable' };
    const message = Message.getRootAsMessage(buffer);
    return message.schemaVersion() === SCHEMA_VERSION ? unpacked(message) : { is: 'foreign', version: message.schemaVersion() };
  } catch {
    return { is: 'unreadable' };
  }
}

function unpacked(message: Message): ReceivedMessage {
  const unpack = <Table extends { unpack(): unknown }>(table: Table): ReturnType<Table['unpack']> =>
    (message.payload(table as never) as Table).unpack() as ReturnType<Table['unpack']>;
  switch (message.payloadType()) {
    case Payload.WorldState: return { is: 'state', value: unpack(new WorldState()) };
    case Payload.Scene: return { is: 'scene', value: unpack(new Scene()) };
    case Payload.Events: return { is: 'events', value: unpack(new Events()).events };
    case Payload.Welcome: return { is: 'welcome', value: unpack(new Welcome()) };
    case Payload.Controls: return { is: 'controls', value: unpack(new Controls()) };
    case Payload.Commissioning: return { is: 'commissioning', value: unpack(new Commissioning()) };
    case Payload.GameBodies: return { is: 'bodies', value: unpack(new GameBodies()) };
    case Payload.Reply: return { is: 'reply', value: unpack(new Reply()) };
    default: return { is: 'unreadable' };
  }
}
