import { HandTracker, type Looked } from './hand_tracker';
import type { HandReading } from './landmarks';
import { curl, place, readHand, thumbCurl } from './landmarks';
import { OneEuroFilter } from './one_euro';
import type { InputWay, Wish } from './wish';
import { now_s, restingWish } from './wish';

/** Why there is no hand tracking, as a key of the texts; empty: there is. `cancelled`: the person wants it no more. */
export type WebcamProblem = '' | 'insecure' | 'refused' | 'absent' | 'busy' | 'model' | 'ended' | 'cancelled';

/** The steps from the browser's question to the play. Nothing steers before `play`. */
export type WebcamStep = 'ask' | 'load' | 'frame' | 'play';

export interface WebcamView {
  /** The picture, mirrored, for the person to see; undefined while the browser asks for the camera. */
  video: HTMLVideoElement | undefined;
  step: WebcamStep;
  /** true while a hand is seen. */
  seen: boolean;
  /** How much longer the hand has to be kept in the frame before it steers [s]. */
  left_s: number;
}

/** After this long without a hand the person is informed, and the hand opens [s]; a slow tracker gets so many pictures' time. */
const LOST_S = 0.7;
const LOST_LOOKS = 3;
const SLOWEST_LOOK_S = 0.7;
/** A hand is seen for this long before it steers [s]. */
export const FRAME_S = 10;
/** Longest time that one look counts for [s]: between two looks nothing was seen. */
const LONGEST_LOOK_S = 1;

const SMOOTHING = { minCutoff_hz: 1.2, beta: 2.5, speedCutoff_hz: 1 };

/** What a browser's refusal of the camera means. */
export function problemOf(error: unknown): WebcamProblem {
  const name = error instanceof Error ? error.name : '';
  if (name === 'NotAllowedError' || name === 'SecurityError') return 'refused';
  if (name === 'NotFoundError' || name === 'OverconstrainedError') return 'absent';
  return 'busy';
}

/** Whether a camera goes on giving pictures. */
export class PictureWatch {
  private shown_s = -1;

  isNew({ currentTime, srcObject }: Pick<HTMLVideoElement, 'currentTime' | 'srcObject'>): boolean {
    const live = srcObject instanceof MediaStream && srcObject.getVideoTracks().some((track) => track.readyState === 'live' && !track.muted);
    if (!live || currentTime === this.shown_s) return false;
    this.shown_s = currentTime;
    return true;
  }
}

/** Places and curls of a tracked hand, smoothed. Knows neither camera nor tracker. */
export class HandFollower {
  private restSize = 0;
  private readonly filters = new Map<string, OneEuroFilter>();

  /** The hand's distance now becomes the middle of the depth. */
  recentre(): void {
    this.restSize = 0;
    this.filters.clear();
  }

  follow(reading: HandReading, time_s: number): Wish {
    if (!(this.restSize > 0)) this.restSize = reading.palmSize;
    const at = place(reading, this.restSize);
    const smooth = (name: string, value: number): number => {
      let filter = this.filters.get(name);
      if (!filter) this.filters.set(name, (filter = new OneEuroFilter(SMOOTHING)));
      return filter.filter(value, time_s);
    };
    return {
      ...restingWish(),
      place: { x: smooth('x', at.x), y: smooth('y', at.y), z: smooth('z', at.z) },
      squeeze: smooth('squeeze', curl(reading)),
      thumb: smooth('thumb', thumbCurl(reading)),
    };
  }
}

/** "Keep your hand in the frame": counts while a hand is seen, and stands still while none is. */
export class FrameStep {
  private seen_s = 0;

  look(seen: boolean, dt_s: number): void {
    if (seen) this.seen_s += Math.min(dt_s, LONGEST_LOOK_S);
  }

  get left_s(): number {
    return Math.max(0, FRAME_S - this.seen_s);
  }
}

/** What finds a hand in pictures: HandTracker, but for tests. */
export type Tracker = Pick<HandTracker, 'load' | 'look' | 'close'>;

/** The person's own hand before a camera. The picture never leaves this page. */
export class Webcam implements InputWay {
  readonly way = 'webcam';
  claimed_s = -Infinity;
  private readonly follower = new HandFollower();
  private readonly pictures = new PictureWatch();
  private latest: Wish | undefined;
  private lastSeen_s = -Infinity;
  private look_s = 0;
  private tracker: Tracker | undefined;
  private stream: MediaStream | undefined;
  private video: HTMLVideoElement | undefined;
  private step: WebcamStep | 'off' = 'off';
  private frame = new FrameStep();
  private starting: Promise<WebcamProblem> | undefined;
  private settle: ((problem: WebcamProblem) => void) | undefined;
  private enabled = false;
  private round = 0;           // counts start() and stop(): what an earlier one was waiting for is dropped

  /** `onView`: what there is to see, often; undefined: the camera is off, for that reason. */
  constructor(
    private readonly onView: (view: WebcamView | undefined, problem: WebcamProblem) => void,
    private readonly makeTracker: () => Tracker = () => new HandTracker(),
  ) {}

  // Only start() opens the camera, and only stop() closes it.
  enable(): void {
    this.enabled = true;
  }

  disable(): void {
    this.enabled = false;
    this.claimed_s = -Infinity;
  }

  yield(): void {
    this.latest = undefined;
  }

  wish(now: number): Wish {
    return this.sees(now) && this.latest ? this.latest : restingWish();
  }

  /**
   * Opens the camera, loads the tracker, and waits until a hand was in the frame for FRAME_S; says in a word why not.
   * Two presses are one start.
   */
  start(): Promise<WebcamProblem> {
    if (this.step === 'play') return Promise.resolve('');
    if (this.starting) return this.starting;
    const starting = this.starting = new Promise<WebcamProblem>((done) => { this.settle = done; });
    void this.open(this.round);
    return starting;
  }

  stop(): void {
    this.end('cancelled');
  }

  /** Closes the camera, in whatever step it is. */
  private end(problem: WebcamProblem): void {
    this.round += 1;
    this.step = 'off';
    this.claimed_s = this.lastSeen_s = -Infinity;
    this.latest = undefined;
    this.stream?.getTracks().forEach((track) => track.stop());
    this.tracker?.close();
    this.stream = this.tracker = this.video = undefined;
    this.finish(problem);
    this.onView(undefined, problem);
  }

  private finish(problem: WebcamProblem): void {
    this.settle?.(problem);
    this.starting = this.settle = undefined;
  }

  private async open(round: number): Promise<void> {
    const devices = navigator.mediaDevices as MediaDevices | undefined;
    if (!devices?.getUserMedia) { this.finish('insecure'); return; }
    this.frame = new FrameStep();
    this.show('ask');
    let doing: (error: unknown) => WebcamProblem = problemOf;
    try {
      const stream = await devices.getUserMedia({ video: { width: 640, height: 480, facingMode: 'user' }, audio: false });
      if (round !== this.round) { stream.getTracks().forEach((track) => track.stop()); return; }
      this.stream = stream;
      // The camera is unplugged or taken away.
      for (const track of stream.getTracks()) track.addEventListener('ended', () => { if (round === this.round) this.end('ended'); });
      const video = await mirrorOf(stream);
      if (round !== this.round) return;
      this.video = video;
      this.show('load');
      doing = () => 'model';
      const tracker = this.tracker = this.makeTracker();
      await tracker.load();
      if (round !== this.round) return;
      this.show('frame');
      void this.run(tracker, round);
    } catch (error) {
      if (round === this.round) this.end(doing(error));
    }
  }

  private show(step: WebcamStep): void {
    this.step = step;
    this.onView({ video: this.video, step, seen: this.sees(now_s()), left_s: this.frame.left_s }, '');
  }

  private sees(now: number): boolean {
    return now - this.lastSeen_s < Math.max(LOST_S, LOST_LOOKS * Math.min(this.look_s, SLOWEST_LOOK_S));
  }

  // One picture after another. The tracker has a thread of its own, but few machines have many: it rests between.
  private async run(tracker: Tracker, round: number): Promise<void> {
    let before_s = now_s();
    while (round === this.round && this.video) {
      const began_s = now_s();
      try {
        // The last picture of a camera that has stopped says nothing of the hand now.
        if (this.pictures.isNew(this.video)) {
          const looked = await tracker.look(await createImageBitmap(this.video));
          if (round !== this.round) return;
          this.take(looked, now_s());
        }
      } catch {
        if (round === this.round) this.end('model');
        return;
      }
      await new Promise((resume) => setTimeout(resume, 1000 * Math.max(0.016, 0.5 * (now_s() - began_s))));
      if (round !== this.round) return;
      this.look_s = now_s() - before_s;
      before_s = now_s();
      this.count();
    }
  }

  private take({ image, world }: Looked, time_s: number): void {
    const aspect = (this.video?.videoWidth ?? 4) / Math.max(1, this.video?.videoHeight ?? 3);
    const reading = readHand(image, world.length > 0 ? world : image, aspect);
    if (!reading) return;
    this.lastSeen_s = time_s;
    // Where the hand is at the end of the step is the middle of the depth.
    if (this.step === 'frame') this.follower.recentre();
    this.latest = this.follower.follow(reading, time_s);
    if (this.enabled && this.step === 'play') this.claimed_s = time_s;
  }

  private count(): void {
    if (this.step === 'frame') {
      this.frame.look(this.sees(now_s()), this.look_s);
      if (this.frame.left_s === 0) {
        this.step = 'play';
        this.finish('');
      }
    }
    this.show(this.step as WebcamStep);
  }
}

/** The camera's picture as in a mirror. */
async function mirrorOf(stream: MediaStream): Promise<HTMLVideoElement> {
  const video = document.createElement('video');
  video.muted = true;
  video.playsInline = true;
  video.style.transform = 'scaleX(-1)';
  video.srcObject = stream;
  await video.play();
  return video;
}
