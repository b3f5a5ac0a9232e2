// A stand-in for the program's recordings, for development (/replay?fake&recording=NAME) and tests: the same bytes as
// /api/recordings/NAME/replay/... Options, all in the address beside ?fake:
//     length=60     duration [s]              gap        200 ticks are missing at a third of it
//     damaged       its last tenth cannot be read         written    it grows by a second with every request
//     nopicture     without a scene           newer      refused, as one of a newer version
//     gone=5        the program is absent for 5 s, from 5 s after the start
//     title=...     its title; a recording "unknown" does not exist
import * as flatbuffers from 'flatbuffers';
import { Message, MessageT, Payload, SCHEMA_VERSION, type GameBodiesT, type SceneT, type WorldStateT } from '../src/protocol';
import { FakeProgram } from './fake_program';

const PERIOD_S = 1e-3;
/** States are made at this rate for a limited time; then they repeat. */
const MADE_HZ = 20;
const MADE_S = 24;
const GAP_TICKS = 200;

const PER_AXIS: Readonly<Record<string, (state: WorldStateT) => readonly number[]>> = {
  q_m: (s) => s.qM, q_s: (s) => s.qS, intention: (s) => s.intention, sent: (s) => s.sent, exercise_effort: (s) => s.exerciseEffort, damping: (s) => s.damping, phi: (s) => s.phi,
};

export interface FakeChannel { readonly name: string; readonly axis: number; readonly of: (state: WorldStateT) => number }

export class FakeRecordings {
  readonly scene: SceneT;
  /** The answered addresses. */
  readonly asked: string[] = [];
  /** Bodies of a game, with the row from which each list holds. */
  bodies: readonly { readonly row: number; readonly reported: GameBodiesT }[] = [];
  private readonly made: WorldStateT[] = [];
  private ticks: number;
  private readonly began_ms = performance.now();

  constructor(private readonly options: URLSearchParams) {
    const program = new FakeProgram(new URLSearchParams({ level: options.get('level') ?? '2' }));
    this.scene = program.scene();
    const length_s = Number(options.get('length') ?? 60);
    for (let i = 0; i < MADE_HZ * Math.min(MADE_S, length_s + 2); i += 1) {
      this.made.push(program.state());
      program.advance(1 / MADE_HZ);
    }
    this.ticks = Math.round(length_s / PERIOD_S);
  }

  /** Number of rows in the file, without the missing ticks. */
  get rows(): number { return this.ticks - (this.options.has('gap') ? GAP_TICKS : 0); }

  async answer(address: string): Promise<Response> {
    this.asked.push(address);
    const url = new URL(address, 'http://fake');
    await new Promise((resolve) => setTimeout(resolve, Number(this.options.get('slow') ?? 0)));
    const away_s = Number(this.options.get('gone') ?? 0);
    const age_s = (performance.now() - this.began_ms) / 1000;
    if (age_s > 5 && age_s < 5 + away_s) throw new TypeError('not there');
    const [, , , name, , what] = url.pathname.split('/').map(decodeURIComponent);
    if (name === 'unknown') return new Response('', { status: 404 });
    if (this.options.has('newer')) return this.refused('schema is 9, of a newer program; this one reads 2 to 4');
    const number = (key: string): number => Number(url.searchParams.get(key));
    switch (what) {
      case 'about': return Response.json(this.about(name));
      case 'scene': return this.options.has('nopicture') ? this.refused('the hand file is not in the recording') : new Response(this.message(Payload.Scene, this.scene).slice());
      case 'bodies': return new Response(this.gameBodies());
      case 'states': return new Response(this.states(number('tick'), number('count'), number('step')));
      case 'series': return number('to_s') - number('from_s') > 60.0001 ? new Response('', { status: 400 }) : new Response(this.series(number('from_s'), number('to_s'), number('columns')));
      default: return new Response('', { status: 404 });
    }
  }

  private gameBodies(): Uint8Array<ArrayBuffer> {
    return joined(this.bodies.map(({ row, reported }) => {
      const message = this.message(Payload.GameBodies, reported);
      return { head: [row, message.length], message };
    }));
  }

  /** The state of a row, as the program would have sent it. */
  state(row: number): WorldStateT {
    const tick = this.tickOf(row);
    const state = this.made[Math.floor(tick * PERIOD_S * MADE_HZ) % this.made.length];
    return Object.assign(Object.create(Object.getPrototypeOf(state) as object) as WorldStateT, state, { tick: BigInt(tick), timeS: tick * PERIOD_S, statistics: null });
  }

  channels(): FakeChannel[] {
    const axes = this.scene.axes.map((_, i) => i);
    const force = (s: WorldStateT): number => s.contacts.reduce((sum, { forceN: f }) => sum + (f ? Math.hypot(f.x, f.y, f.z) : 0), 0);
    return [
      ...Object.entries(PER_AXIS).flatMap(([name, read]) => axes.map((axis) => ({ name, axis, of: (s: WorldStateT) => read(s)[axis] ?? NaN }))),
      { name: 'alpha', axis: 0, of: (s) => s.alpha }, { name: 'palm_target_distance_m', axis: 0, of: (s) => (s.palmBody < 0 ? NaN : s.palmTargetDistanceM) },
      { name: 'contact_force_n', axis: 0, of: force }, { name: 'contact_count', axis: 0, of: (s) => s.contacts.length },
      { name: 'duration_s', axis: 0, of: (s) => 1e-6 * (150 + Number(s.tick % 37n)) },
      ...this.scene.valueNames.map((_, i) => ({ name: 'value', axis: i, of: (s: WorldStateT) => s.values[i] ?? NaN })),
    ];
  }

  private get gapAt(): number { return Math.floor(this.ticks / 3); }

  private tickOf(row: number): number {
    return this.options.has('gap') && row >= this.gapAt ? row + GAP_TICKS : row;
  }

  private about(name: string): object {
    const written = this.options.has('written');
    if (written) this.ticks += 1000;
    const damaged = this.options.has('damaged');
    return {
      name, title: this.options.get('title') ?? 'Cocktail bar', created_utc: '2026-11-20T09:38:00Z', program_version: '0.3.0 (stand-in)', period_s: PERIOD_S,
      ticks: this.rows, ticks_missing: this.ticks - this.rows, from_s: 0, to_s: this.ticks * PERIOD_S, simulated_device: true, patient: 'relaxed-adult', device: 'lambda-pride', hand: 'adult-median-right',
      exercise: this.options.has('noexercise') ? '' : String(this.scene.exerciseName), level: 2, still_written: written, whole: !damaged,
      ...(damaged ? { unreadable_from_s: 0.9 * this.ticks * PERIOD_S } : {}), run_again: true, picture: !this.options.has('nopicture'), no_picture_because: '',
      axes: this.scene.axes.map(({ name, unit, effortLimit, leverArmM }) => ({ name, unit, effort_limit: effortLimit, lever_arm_m: leverArmM })),
      value_names: this.scene.valueNames, event_names: this.scene.eventNames,
      result: [{ label: 'Score', unit: '', value: 87, decimals: 0 }, { label: 'Spilt', unit: 'ml', value: 3.2, decimals: 1 }],
    };
  }

  private refused(error: string): Response {
    return Response.json({ error }, { status: 422 });
  }

  private states(first: number, count: number, step: number): Uint8Array<ArrayBuffer> {
    const messages: Uint8Array[] = [];
    for (let row = first; messages.length < Math.min(256, count) && row < this.rows; row += step) messages.push(this.message(Payload.WorldState, this.state(row)));
    return joined(messages.map((message) => ({ head: [message.length], message })));
  }

  /** The values of each column come from a few of its rows. */
  private series(from_s: number, to_s: number, columns: number): ArrayBuffer {
    const channels = this.channels();
    const values = new Float32Array(2 * columns * channels.length).fill(NaN);
    const width_s = (to_s - from_s) / columns;
    const rowFrom = (time_s: number): number => { const tick = Math.ceil(time_s / PERIOD_S - 1e-6); return this.options.has('gap') && tick >= this.gapAt ? Math.max(this.gapAt, tick - GAP_TICKS) : tick; };
    for (let column = 0; column < columns; column += 1) {
      const [first, after] = [Math.max(0, rowFrom(from_s + column * width_s)), Math.min(this.rows, rowFrom(from_s + (column + 1) * width_s))];
      for (let row = first; row < after; row += Math.max(1, Math.floor((after - first) / 3))) {
        const state = this.state(row);
        channels.forEach(({ of }, i) => {
          const value = of(state), [low, high] = [2 * i * columns + column, (2 * i + 1) * columns + column];
          if (!(values[low] <= value)) values[low] = value;
          if (!(values[high] >= value)) values[high] = value;
        });
      }
    }
    return framed({ from_s, to_s, columns, first_tick: Math.max(0, rowFrom(from_s)), unreadable: [], channels: channels.map(({ name, axis }) => ({ name, axis })), ...this.happened(from_s, to_s), truncated: false }, values);
  }

  private happened(from_s: number, to_s: number): object {
    const within = ({ time_s }: { time_s: number }): boolean => time_s >= from_s && time_s < to_s;
    const end_s = this.ticks * PERIOD_S;
    const type = (name: string): number => this.scene.eventNames.indexOf(name);
    const events = [];
    for (let k = 0; MADE_S * k < end_s; k += 1) {
      for (const [after_s, name] of [[3, 'touched'], [4, 'engaged'], [5, 'pour_began'], [9, 'pour_ended']] as const) events.push({ time_s: MADE_S * k + after_s, type: type(name), index: 0, value: 0 });
    }
    const gap_s = this.gapAt * PERIOD_S;
    return {
      events: events.filter((e) => within(e) && e.time_s < end_s),
      gaps: this.options.has('gap') && gap_s < to_s && gap_s + GAP_TICKS * PERIOD_S > from_s ? [{ from_s: gap_s, to_s: gap_s + GAP_TICKS * PERIOD_S, ticks: GAP_TICKS }] : [],
      marks: [
        { time_s: 0, kind: 'armed', text: '', axis: '' }, { time_s: 0.6 * end_s, kind: 'controls_lost', text: 'owner silent', axis: '' },
        { time_s: 0.9 * end_s, kind: 'fault', text: 'speed limit exceeded', axis: 'x' },
      ].filter(within),
    };
  }

  private message(kind: Payload, payload: MessageT['payload']): Uint8Array<ArrayBuffer> {
    const builder = new flatbuffers.Builder(4096);
    Message.finishMessageBuffer(builder, new MessageT(SCHEMA_VERSION, kind, payload).pack(builder));
    return builder.asUint8Array() as Uint8Array<ArrayBuffer>;
  }
}

/** Concatenates messages, each after a header of numbers with four bytes each. */
function joined(parts: readonly { readonly head: readonly number[]; readonly message: Uint8Array }[]): Uint8Array<ArrayBuffer> {
  const bytes = new Uint8Array(parts.reduce((sum, { head, message }) => sum + 4 * head.length + message.length, 0));
  let at = 0;
  for (const { head, message } of parts) {
    for (const number of head) {
      new DataView(bytes.buffer).setUint32(at, number, true);
      at += 4;
    }
    bytes.set(message, at);
    at += message.length;
  }
  return bytes;
}

/** Length, header padded to four bytes, then the values. */
export function framed(header: object, values: Float32Array): ArrayBuffer {
  const text = new TextEncoder().encode(JSON.stringify(header));
  const length = Math.ceil(text.length / 4) * 4;
  const bytes = new Uint8Array(4 + length + values.byteLength).fill(0x20);
  new DataView(bytes.buffer).setUint32(0, length, true);
  bytes.set(text, 4);
  bytes.set(new Uint8Array(values.buffer, values.byteOffset, values.byteLength), 4 + length);
  return bytes.buffer;
}
