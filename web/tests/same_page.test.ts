// @vitest-environment happy-dom
// A page that was open before shows the same as a page that was loaded after: the picture's tree of objects, and the texts.
// WHOLEHAND_FULL=1: every change of exercise.
import type { Material, Mesh, Object3D, PerspectiveCamera, WebGLRenderer } from 'three';
import { afterEach, beforeEach, expect, it, vi } from 'vitest';
import { Game } from '../src/game/game';
import { Controls } from '../src/input/controls';
import { Connection } from '../src/net/connection';
import { Payload, SceneT, type WorldStateT } from '../src/protocol';
import { SceneView } from '../src/scene/scene_view';
import { setLanguage } from '../src/shared/i18n';
import { TestConnection } from './test_connection';
import { toldExercises, type ToldExercise } from './told_exercises';

const ALL = toldExercises();
const FULL = process.env.WHOLEHAND_FULL === '1';
const FRAME_MS = 200;
/** Frames after the last state: every animation has ended after them. */
const FRAMES = 40;
/** The program repeats its state after this number of frames. */
const EVERY = 5;

const DESK = [1280, 720] as const;
const PHONE = [390, 844] as const;

/** Draws nothing. */
function noRenderer(): WebGLRenderer {
  const nothing = (): void => {};
  return {
    setClearColor: nothing, setPixelRatio: nothing, setSize: nothing, render: nothing, clear: nothing, dispose: nothing, compile: nothing, copyFramebufferToTexture: nothing,
    getDrawingBufferSize: <Size extends { set(x: number, y: number): Size }>(size: Size) => size.set(4, 4),
    compileAsync: () => Promise.resolve(), extensions: { has: () => true }, shadowMap: {}, info: { programs: [], memory: {}, render: {} },
  } as unknown as WebGLRenderer;
}

class OpenPage {
  private readonly socket = new TestConnection();
  private readonly connection: Connection;
  private readonly game: Game;
  private readonly picture: SceneView;
  private last: WorldStateT | undefined;
  private readonly root = document.createElement('div');

  constructor([width_px, height_px]: readonly [number, number] = DESK) {
    document.body.replaceChildren(this.root);
    const play = document.createElement('div'), canvas = document.createElement('canvas');
    this.root.append(canvas, play);
    Object.assign(globalThis, { innerWidth: width_px, innerHeight: height_px });
    for (const [name, value] of [['clientWidth', width_px], ['clientHeight', height_px]] as const) Object.defineProperty(canvas, name, { value });
    this.connection = new Connection({ url: 'ws://test', open: () => this.socket });
    this.game = new Game(this.root, play, this.connection, new Controls(this.connection, play));
    this.picture = new SceneView(canvas, { quality: 'low', tone: 'honey', view: 'game', renderer: noRenderer() });
    this.game.setPicture(this.picture);
    this.socket.onopen?.({} as Event);
    this.socket.welcome();
  }

  /** Receives messages, and draws what follows from each. */
  async take(messages: readonly ArrayBuffer[]): Promise<this> {
    for (const message of messages) {
      this.socket.deliver(message);
      await this.draw(3);
      this.last = this.connection.latestState ?? undefined;
    }
    return this;
  }

  async draw(frames = FRAMES): Promise<this> {
    for (let i = 1; i <= frames; i++) {
      if (i % EVERY === 0 && this.last) this.repeat(this.last);
      await vi.advanceTimersByTimeAsync(FRAME_MS);
      this.game.frame();
      this.picture.render(performance.now());
    }
    return this;
  }

  /** The program reports the same state again, later. */
  private repeat(state: WorldStateT): void {
    state.sentMonotonicNs += BigInt(1e6 * EVERY * FRAME_MS);
    this.socket.sendMessage(Payload.WorldState, state);
  }

  tell(kind: Payload, message: SceneT): void { this.socket.sendMessage(kind, message); }

  /** Reconnects to a program that was started again. */
  restart(): this {
    this.socket.disconnect();
    vi.advanceTimersByTime(5000);
    this.socket.onopen?.({} as Event);
    this.socket.welcome();
    return this;
  }

  tree(): string[] {
    const { camera } = this.picture as unknown as { camera: PerspectiveCamera };
    return [`camera ${numbers([...camera.position, ...camera.quaternion, ...camera.projectionMatrix.elements])}`, ...treeOf(this.picture.drawnTree, '')];
  }
  words(): string[] { return wordsOf(this.root); }
  close(): void { this.connection.close(); }
}

const numbers = (all: readonly number[]): string => all.map((x) => Math.round(x * 1e6) / 1e6 + 0).join(' ');

/** Every drawn object in one line each, with its place in the world to 1e-6. */
function treeOf(object: Object3D, path: string): string[] {
  if (!object.visible) return [];
  object.updateWorldMatrix(false, false);
  const { geometry, material } = object as Mesh;
  const at = geometry?.attributes.position, materials = [material ?? []].flat() as (Material & { color?: { getHexString(): string } })[];
  const line = [
    `${path}/${object.type}`, numbers(object.matrixWorld.elements), at ? `${at.count} ${numbers([...at.array.slice(0, 12)])}` : '',
    ...materials.map((one) => `${one.type} ${one.color?.getHexString() ?? ''} ${one.opacity.toFixed(4)}`),
  ].join(' | ');
  return [line, ...object.children.flatMap((child, i) => treeOf(child, `${path}/${i}`))];
}

/** Every shown element with its own text and what a screen reader reads of it. */
function wordsOf(element: Element): string[] {
  if ((element as HTMLElement).hidden) return [];
  const own = [...element.childNodes].filter(({ nodeType }) => nodeType === 3).map(({ textContent }) => textContent).join('');
  const told = ['class', 'style', 'aria-label', 'aria-valuenow', 'aria-valuetext', 'data-zone', 'aria-pressed', 'disabled'].map((name) => element.getAttribute(name) ?? '');
  return [`${element.tagName} ${told.join(';')} ${own}`, ...[...element.children].flatMap(wordsOf)];
}

beforeEach(() => {
  vi.useFakeTimers();
  vi.stubGlobal('matchMedia', () => ({ matches: false, addEventListener: () => {} }));
  localStorage.clear();
  sessionStorage.clear();
  history.replaceState(null, '', '/?watch');
  setLanguage('en');
});
afterEach(() => { vi.useRealTimers(); vi.unstubAllGlobals(); });

interface Seen { readonly tree: string[]; readonly words: string[] }
async function seen(page: OpenPage): Promise<Seen> { return { tree: page.tree(), words: page.words() }; }

/** What a page shows that is loaded when the exercise plays already. */
async function loadedAfter({ messages: [scene, , ...playing] }: ToldExercise, size: readonly [number, number]): Promise<Seen> {
  const page = new OpenPage(size);
  await page.take([scene!, playing.at(-1)!]);
  const all = await seen(await page.draw());
  page.close();
  return all;
}

/** Numbers of a line, and the rest of it. */
const parted = (line: string): { text: string; numbers: number[] } => {
  const found: number[] = [];
  return { text: line.replace(/-?\d+(\.\d+)?(e-\d+)?/g, (each) => { found.push(Number(each)); return '#'; }), numbers: found };
};

/** Whether two lines agree, in their numbers to 1e-6. */
function agree(one: string | undefined, other: string | undefined): boolean {
  if (one === other) return true;
  const [a, b] = [parted(one ?? ''), parted(other ?? '')];
  return a.text === b.text && a.numbers.every((x, i) => Math.abs(x - b.numbers[i]!) <= 1.5e-6);
}

/** The first lines in which two pages differ. */
function differences(open: Seen, fresh: Seen): string[] {
  return (['tree', 'words'] as const).flatMap((part) => {
    const longer = open[part].length > fresh[part].length ? open[part] : fresh[part];
    return longer.flatMap((_, i) => (agree(open[part][i], fresh[part][i]) ? [] : [`open: ${open[part][i]}\nfresh: ${fresh[part][i]}`]));
  }).slice(0, 4);
}

/** A walk over the exercises; with `every`, it makes each change of one to another. */
function walk(exercises: readonly ToldExercise[], every: boolean): ToldExercise[] {
  if (!every) return [...exercises, exercises[0]!];
  return exercises.flatMap((one, i) => exercises.slice(i + 1).flatMap((other) => [one, other])).concat(exercises[0]!, [...exercises].reverse());
}

it.each(([['right', true, DESK], ['left', false, PHONE]] as const).slice(0, FULL ? 2 : 1))('changes of exercise, %s hand', async (_, right, size) => {
  const exercises = ALL.filter((one) => one.right === right), fresh = new Map<string, Seen>();
  for (const one of exercises) fresh.set(one.name, await loadedAfter(one, size));
  const page = new OpenPage(size);
  for (const one of walk(exercises, FULL)) {
    await page.take(one.messages);
    await page.draw();
    expect.soft(differences(await seen(page), fresh.get(one.name)!), one.name).toEqual([]);
  }
  page.close();
}, 600_000);

const [FIRST, SECOND] = [ALL.find(({ name, right }) => name === 'drawer' && right)!, ALL.find(({ name, right }) => name === 'cocktail-bar' && !right)!];

/** An open page that has shown an exercise, and then something happens to it. */
async function after(event: (page: OpenPage) => Promise<unknown>): Promise<Seen> {
  const page = new OpenPage();
  await page.take(FIRST.messages);
  await event(page);
  const all = await seen(await page.draw());
  page.close();
  return all;
}

it('another hand and exercise', async () => {
  expect(differences(await after((page) => page.take(SECOND.messages)), await loadedAfter(SECOND, DESK))).toEqual([]);
});

it('a restart of the program, and a lost connection', async () => {
  expect(differences(await after((page) => page.restart().take(FIRST.messages)), await loadedAfter(FIRST, DESK))).toEqual([]);
  expect(differences(await after((page) => page.restart().take(SECOND.messages)), await loadedAfter(SECOND, DESK))).toEqual([]);
});

it.each(['de', 'fr'] as const)('another language, %s', async (language) => {
  const open = await after((page) => { setLanguage(language); return page.draw(3); });
  expect(differences(open, await loadedAfter(FIRST, DESK))).toEqual([]);
});

it('another person, without a profile and in a visit', async () => {
  for (const [profile, visit] of [['ben', 0n], ['', 12n]] as const) {
    const scene = { ...FIRST.scene, profile, visit };
    const page = new OpenPage();
    page.tell(Payload.Scene, Object.assign(new SceneT(), scene));
    await page.take(FIRST.messages.slice(2));
    const fresh = await seen(await page.draw());
    page.close();
    const open = await after(async (opened) => {
      opened.tell(Payload.Scene, Object.assign(new SceneT(), scene));
      return opened.take(FIRST.messages.slice(2));
    });
    expect(differences(open, fresh)).toEqual([]);
  }
});
