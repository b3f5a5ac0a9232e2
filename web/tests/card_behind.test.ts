// A graphics card that is behind delays pictures, not the page: a page that waits for it is not heard by the program.
// @vitest-environment happy-dom
import type { WebGLRenderer } from 'three';
import { afterEach, beforeEach, expect, it, vi } from 'vitest';
import { SceneView } from '../src/scene/scene_view';

/** Commands up to a fence are carried out when the test says so. */
class Card {
  sent = 0;
  done = 0;
  drawn = 0;
  waited = 0;
  readonly gl = {
    SIGNALED: 1, fenceSync: () => ({ at: this.sent += 1 }), getSyncParameter: (fence: { at: number }) => Number(fence.at <= this.done),
    flush: () => {}, deleteSync: () => {}, isContextLost: () => false,
  };
  /** A call whose answer waits for everything before. */
  private readonly ask = (): void => { if (this.done < this.sent) this.waited += 1; };
  readonly renderer = {
    setClearColor: () => {}, setPixelRatio: () => {}, setSize: () => {}, clear: () => {}, dispose: () => {}, copyFramebufferToTexture: () => {}, setRenderTarget: () => {},
    render: () => { this.drawn += 1; }, initTexture: () => { this.sent += 1; }, getContext: () => this.gl, getDrawingBufferSize: (size: { set(x: number, y: number): unknown }) => size.set(4, 4),
    compileAsync: async () => { this.sent += 1; }, extensions: { has: () => true }, shadowMap: {},
    info: { programs: Array.from({ length: 5 }, () => ({ program: {}, getUniforms: this.ask, getAttributes: () => {} })), memory: {}, render: {} },
  } as unknown as WebGLRenderer;
}

let card: Card, view: SceneView;
const frames = async (count: number): Promise<void> => {
  for (let i = 0; i < count; i += 1) {
    await vi.advanceTimersByTimeAsync(50);
    view.render(performance.now());
  }
};

beforeEach(() => {
  vi.useFakeTimers();
  card = new Card();
  view = new SceneView(document.createElement('canvas'), { quality: 'low', tone: 'honey', view: 'game', renderer: card.renderer });
});
afterEach(() => { vi.useRealTimers(); });

it('no program is read back, and nothing is drawn, before the card has carried out what came before', async () => {
  await frames(20);
  expect([card.drawn, view.whole]).toEqual([0, false]);
  for (let i = 0; i < 200; i += 1) {
    card.done = card.sent;
    await frames(1);
  }
  expect(view.whole).toBe(true);
  expect(card.drawn).toBeGreaterThan(10);
  expect(card.waited).toBe(0);
});

it('a card that stands still gets two more pictures; when it goes on, so do they', async () => {
  for (let i = 0; i < 200; i += 1) {
    card.done = card.sent;
    await frames(1);
  }
  const before = card.drawn;
  await frames(100);
  expect(card.drawn - before).toBeLessThanOrEqual(2);
  card.done = card.sent;
  await frames(1);
  expect(card.drawn - before).toBeLessThanOrEqual(3);
  expect(card.drawn).toBeGreaterThan(before);
});
