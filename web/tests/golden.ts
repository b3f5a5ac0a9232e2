// Reads and writes golden messages with the pages' code (tests/golden/run.py): node golden.js JOB.json ANSWER.json.
import { readFileSync, writeFileSync } from 'node:fs';
import * as flatbuffers from 'flatbuffers';
import { encodeCommand, type AnyOrder } from '../src/net/orders';
import { readMessage } from '../src/net/read_message';
import * as protocol from '../src/protocol';

interface Field { readonly name: string; readonly kind: string; readonly element?: string; readonly of?: string; readonly default?: unknown }
type Layout = Record<string, { readonly struct: boolean; readonly fields: readonly Field[] }>;
type Form = Record<string, unknown>;
interface Job {
  readonly layout: { readonly objects: Layout };
  readonly read: readonly { readonly name: string; readonly bytes: string }[];
  readonly write: readonly { readonly name: string; readonly id: number; readonly order: string; readonly fields: Form }[];
}

const job = JSON.parse(readFileSync(process.argv[2], 'utf8')) as Job;
const layout = job.layout.objects;
const PAYLOADS = { state: 'WorldState', scene: 'Scene', events: 'Events', welcome: 'Welcome', controls: 'Controls', commissioning: 'Commissioning', reply: 'Reply', bodies: 'GameBodies' } as const;

/** The name that flatc generates for a field. */
const camel = (name: string): string => name.replace(/_(\w)/g, (_, letter: string) => letter.toUpperCase());

function bits(kind: string, value: number | bigint): string {
  const view = new DataView(new ArrayBuffer(8));
  if (kind === 'f32') view.setFloat32(4, value as number);
  else if (kind === 'f64') view.setFloat64(0, value as number);
  else view.setBigInt64(0, BigInt.asIntN(64, value as bigint));
  return view.getBigUint64(0).toString(16).padStart(kind === 'f32' ? 8 : 16, '0');
}

function element(kind: string, of: string | undefined, value: unknown): unknown {
  if (kind === 'table' || kind === 'struct') return form(of as string, value as object);
  return ['f32', 'f64', 'i64', 'u64'].includes(kind) ? bits(kind, value as number | bigint) : value;
}

/** An unpacked table of the pages in canonical form. */
function form(name: string, table: object): Form {
  const result: Form = {};
  for (const field of layout[name].fields) {
    if (field.kind === 'utype' || field.kind === 'union') continue;  // unions occur only in commands, which a page only writes
    const value = (table as Form)[camel(field.name)];
    if (value === undefined) throw new Error(`${name}.${field.name} is not unpacked`);
    if (value === null || value === '' || (Array.isArray(value) && value.length === 0)) continue;
    const entry = Array.isArray(value)
      ? value.map((item: unknown) => element(field.element as string, field.of, item)) : element(field.kind, field.of, value);
    if (layout[name].struct || entry !== field.default) result[field.name] = entry;
  }
  return result;
}

function read(bytes: Uint8Array): Form {
  // A buffer of exactly the message's size, like a frame of a WebSocket.
  const message = readMessage(Uint8Array.from(bytes).buffer);
  if (message.is === 'foreign') return { refused: 'version' };
  if (message.is === 'unreadable') return { refused: '' };
  const value = message.is === 'events' ? { events: message.value } : message.value;
  return { payload: { [PAYLOADS[message.is]]: form(PAYLOADS[message.is], value) } };
}

function given(kind: string, value: unknown): unknown {
  if (kind !== 'f32' && kind !== 'f64') return value;
  const view = new DataView(new ArrayBuffer(8));
  view.setBigUint64(0, BigInt(`0x${value as string}`));
  return kind === 'f32' ? view.getFloat32(4) : view.getFloat64(0);
}

function orderOf(bytes: Uint8Array): protocol.Order {
  return (protocol.Message.getRootAsMessage(new flatbuffers.ByteBuffer(bytes)).payload(new protocol.Command()) as protocol.Command).orderType();
}

/** Null for an order that the pages do not have. */
function write(entry: Job['write'][number]): string | null {
  const make = (protocol as unknown as Record<string, new () => AnyOrder>)[`${entry.order}T`];
  const order = new make();
  if (orderOf(encodeCommand(entry.id, order)) === protocol.Order.NONE) return null;
  for (const field of layout[entry.order].fields) {
    const value = entry.fields[field.name];
    if (value === undefined) continue;
    (order as unknown as Form)[camel(field.name)] = Array.isArray(value)
      ? value.map((item: unknown) => given(field.element as string, item)) : given(field.kind, value);
  }
  return Buffer.from(encodeCommand(entry.id, order)).toString('base64');
}

let longest_ms = 0;

function timedRead(bytes: Uint8Array): Form {
  const began = process.cpuUsage();
  try {
    return read(bytes);
  } catch (error) {
    return { escaped: String(error) };  // the runner counts it
  } finally {
    const { user, system } = process.cpuUsage(began);  // [us], without the time of other processes
    longest_ms = Math.max(longest_ms, 1e-3 * (user + system));
  }
}

writeFileSync(process.argv[3], JSON.stringify({
  read: Object.fromEntries(job.read.map((entry) => [entry.name, timedRead(Buffer.from(entry.bytes, 'base64'))])),
  write: Object.fromEntries(job.write.map((entry) => [entry.name, write(entry)])),
  longest_s: 1e-3 * longest_ms,
}));
