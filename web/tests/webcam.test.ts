// A camera from the browser's permission to play, with a fake tracker.
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import type { TrackedHand } from '../src/input/hand_tracker';
import type { Landmark } from '../src/input/landmarks';
import { FRAME_S, Webcam, type Tracker, type WebcamProblem, type WebcamView } from '../src/input/webcam';
import { now_s, restingWish } from '../src/input/wish';

/** A flat hand: wrist below, four straight fingers above it, relative to the picture. */
function openHand(): Landmark[] {
  const points: Landmark[] = [{ x: 0.5, y: 0.8, z: 0 }];
  for (let i = 1; i < 21; i += 1) {
    const [finger, joint] = [Math.floor((i - 1) / 4), (i - 1) % 4];
    points.push({ x: 0.4 + 0.05 * finger, y: 0.5 - 0.05 * joint, z: 0 });
  }
  return points;
}
const HAND: TrackedHand = { image: openHand(), world: openHand() };
const NOBODY: TrackedHand = { image: [], world: [] };

class Track extends EventTarget {
  readyState = 'live';
  muted = false;
  stop(): void { this.readyState = 'ended'; }
}

/** A browser with a camera; the test sets the tracker's results and their times. */
class Desk {
  readonly track = new Track();
  opened = 0;
  inPicture: TrackedHand = HAND;
  tracker = { loaded: () => {}, closed: 0 };
  asks: () => Promise<MediaStream>;
  load: () => Promise<void> = () => Promise.resolve();
  views: (WebcamView | undefined)[] = [];
  problems: WebcamProblem[] = [];
  readonly webcam: Webcam;

  constructor() {
    const { track } = this;
    class Stream { getVideoTracks(): Track[] { return [track]; } getTracks(): Track[] { return [track]; } }
    const videos = (): object => {
      const begun_ms = performance.now();
      return { style: {}, play: () => Promise.resolve(), videoWidth: 640, videoHeight: 480, get currentTime() { return performance.now() - begun_ms; } };
    };
    vi.stubGlobal('MediaStream', Stream);
    vi.stubGlobal('document', { createElement: videos });
    vi.stubGlobal('createImageBitmap', () => Promise.resolve({}));
    this.asks = () => Promise.resolve(new Stream() as unknown as MediaStream);
    vi.stubGlobal('navigator', { mediaDevices: { getUserMedia: () => { this.opened += 1; return this.asks(); } } });
    const tracker = (): Tracker => ({ load: () => this.load(), look: () => Promise.resolve(this.inPicture), close: () => { this.tracker.closed += 1; } });
    this.webcam = new Webcam((view, problem) => { this.views.push(view); this.problems.push(problem); }, tracker);
    this.webcam.enable();
  }

  get step(): string { return this.views.at(-1)?.step ?? 'off'; }
  pass(seconds: number): Promise<unknown> { return vi.advanceTimersByTimeAsync(1000 * seconds); }
  /** Chooses the camera and keeps a hand in its frame. */
  async plays(): Promise<void> {
    const started = this.webcam.start();
    await this.pass(FRAME_S + 1);
    expect(await started).toBe('');
    expect(this.step).toBe('play');
  }
}

beforeEach(() => { vi.useFakeTimers(); });
afterEach(() => { vi.unstubAllGlobals(); vi.useRealTimers(); });

describe('a chosen camera', () => {
  it('steers only after a hand was in its frame for ten seconds', async () => {
    const desk = new Desk();
    const started = desk.webcam.start();
    await desk.pass(FRAME_S - 0.5);
    expect(desk.step).toBe('frame');
    expect(desk.webcam.claimed_s).toBe(-Infinity);
    expect(Math.ceil(desk.views.at(-1)!.left_s)).toBe(1);
    await desk.pass(2);
    expect(await started).toBe('');
    expect(desk.step).toBe('play');
    expect(desk.webcam.claimed_s).toBeGreaterThan(0);
  });

  it('does not count time without a hand, and continues the count afterwards', async () => {
    const desk = new Desk();
    void desk.webcam.start();
    await desk.pass(4);
    desk.inPicture = NOBODY;
    await desk.pass(2);
    const left_s = desk.views.at(-1)!.left_s;
    await desk.pass(30);
    expect(desk.views.at(-1)).toMatchObject({ step: 'frame', seen: false, left_s });
    desk.inPicture = HAND;
    await desk.pass(left_s + 0.5);
    expect(desk.step).toBe('play');
  });

  it('waits for a tracker that loads for a minute: the first start works', async () => {
    const desk = new Desk();
    desk.load = () => new Promise((done) => { setTimeout(done, 60_000); });
    const started = desk.webcam.start();
    await desk.pass(59);
    expect(desk.step).toBe('load');
    await desk.pass(2 + FRAME_S);
    expect(await started).toBe('');
  });

  it('is opened once by two presses', async () => {
    const desk = new Desk();
    const both = [desk.webcam.start(), desk.webcam.start()];
    await desk.pass(FRAME_S + 1);
    expect(await Promise.all(both)).toEqual(['', '']);
    expect(desk.opened).toBe(1);
  });

  it('is closed when the person cancels it, even while the browser still asks', async () => {
    const desk = new Desk();
    let allow = (): void => {};
    const asks = desk.asks;
    desk.asks = () => new Promise((done) => { allow = () => { void asks().then(done); }; });
    const started = desk.webcam.start();
    await desk.pass(1);
    desk.webcam.stop();
    expect(await started).toBe('cancelled');
    allow();
    await desk.pass(1);
    expect(desk.track.readyState).toBe('ended');
    expect(desk.views.at(-1)).toBeUndefined();
  });

  it('with a tracker that cannot be loaded reports it, and can be tried again', async () => {
    const desk = new Desk();
    const works = desk.load;
    desk.load = () => Promise.reject(new Error('no WebGL'));
    const started = desk.webcam.start();
    await desk.pass(0.1);
    expect(await started).toBe('model');
    expect(desk.track.readyState).toBe('ended');
    desk.load = works;
    desk.track.readyState = 'live';
    await desk.plays();
  });

  it('reports a browser that does not answer', async () => {
    const desk = new Desk();
    vi.stubGlobal('navigator', {});
    expect(await desk.webcam.start()).toBe('insecure');
    expect(await desk.webcam.start()).toBe('insecure');
  });
});

describe('a camera in play', () => {
  it('that is unplugged or withdrawn reports it, sends no more wishes, and can be used again', async () => {
    const desk = new Desk();
    await desk.plays();
    desk.track.stop();
    desk.track.dispatchEvent(new Event('ended'));
    expect(desk.problems.at(-1)).toBe('ended');
    expect(desk.webcam.claimed_s).toBe(-Infinity);
    expect(desk.webcam.wish(now_s())).toEqual(restingWish());
    expect(desk.tracker.closed).toBe(1);
    desk.track.readyState = 'live';
    await desk.plays();
  });

  it.each([['the hand is out of its frame', (desk: Desk) => { desk.inPicture = NOBODY; }], ['its picture stands still', (desk: Desk) => { desk.track.muted = true; }]])('reports that %s, and opens the hand', async (_, happens) => {
    const desk = new Desk();
    await desk.plays();
    expect(desk.webcam.wish(now_s()).place.y).toBeDefined();
    happens(desk);
    await desk.pass(1.5);
    expect(desk.views.at(-1)).toMatchObject({ step: 'play', seen: false });
    expect(desk.webcam.wish(now_s())).toEqual(restingWish());
    desk.inPicture = HAND;
    desk.track.muted = false;
    await desk.pass(0.5);
    expect(desk.views.at(-1)).toMatchObject({ step: 'play', seen: true });
    expect(desk.webcam.wish(now_s()).place.y).toBeDefined();
  });

  it('reports a failed tracker', async () => {
    const desk = new Desk();
    await desk.plays();
    Object.defineProperty(desk, 'inPicture', { get: () => { throw new Error('gone'); } });
    await desk.pass(1);
    expect(desk.problems.at(-1)).toBe('model');
    expect(desk.webcam.claimed_s).toBe(-Infinity);
  });
});
