import { HandTracker, type TrackedHand } from './hand_tracker';
import type { HandReading } from './landmarks';
import { curl, place, readHand, thumbCurl } from './landmarks';
import { OneEuroFilter } from './one_euro';
import type { InputWay, Wish } from './wish';
import { now_s, restingWish } from './wish';

/** Why hand tracking is unavailable, as a key of the texts; empty: it works. `cancelled`: the person cancelled it. */
export type WebcamProblem = '' | 'insecure' | 'refused' | 'absent' | 'busy' | 'model' | 'ended' | 'cancelled';

/** The steps from the browser's permission to play. Nothing steers before `play`. */
export type WebcamStep = 'ask' | 'load' | 'frame' | 'play';

export interface WebcamView {
  /** The mirrored picture for the person; undefined while the browser asks for permission. */
  video: HTMLVideoElement | undefined;
  step: WebcamStep;
  /** true while a hand is seen. */
  seen: boolean;
  /** Remaining time for which the hand must be kept in the frame before it steers [s]. */
  left_s: number;
}

/** After this time without a hand the person is informed, and the hand opens [s]; for a slow tracker, the time of this many pictures. */
const LOST_S = 0.7;
const LOST_LOOKS = 3;
const SLOWEST_LOOK_S = 0.7;
/** A hand must be seen for this long before it steers [s]. */
export const FRAME_S = 10;
/** Longest time that one picture counts for [s]: between two pictures nothing was seen. */
const LONGEST_LOOK_S = 1;

const SMOOTHING = { minCutoff_hz: 1.2, beta: 2.5, speedCutoff_hz: 1 };

/** The reason of a browser's error for the camera. */
export function problemOf(error: unknown): WebcamProblem {
  const name = error instanceof Error ? error.name : '';
  if (name === 'NotAllowedError' || name === 'SecurityError') return 'refused';
  if (name === 'NotFoundError' || name === 'OverconstrainedError') return 'absent';
  return 'busy';
}

/** Detects whether a camera still delivers pictures. */
export class PictureWatch {
  private shown_s = -1;

  isNew({ currentTime, srcObject }: Pick<HTMLVideoElement, 'currentTime' | 'srcObject'>): boolean {
    const live = srcObject instanceof MediaStream && srcObject.getVideoTracks().some((track) => track.readyState === 'live' && !track.muted);
    if (!live || currentTime === this.shown_s) return false;
    this.shown_s = currentTime;
    return true;
  }
}

/** Smoothed position and flexion of a tracked hand. It is independent of camera and tracker. */
export class HandFollower {
  private restSize = 0;
  private readonly filters = new Map<string, OneEuroFilter>();

  /** Sets the hand's present distance as the middle of the depth. */
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

/** The step "Keep your hand in the frame": its time advances while a hand is seen. */
export class FrameStep {
  private seen_s = 0;

  look(seen: boolean, dt_s: number): void {
    if (seen) this.seen_s += Math.min(dt_s, LONGEST_LOOK_S);
  }

  get left_s(): number {
    return Math.max(0, FRAME_S - this.seen_s);
  }
}

/** A hand tracker: HandTracker, or a substitute in tests. */
export type Tracker = Pick<HandTracker, 'load' | 'look' | 'close'>;

/** The person's own hand in front of a camera. The picture never leaves this page. */
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
  private round = 0;           // counts start() and stop(); results of an earlier start are dropped

  /** @param onView called often with the picture; undefined: the camera is off, with the reason */
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
    return this.seesHand(now) && this.latest ? this.latest : restingWish();
  }

  /**
   * Opens the camera, loads the tracker, and waits until a hand was in the frame for FRAME_S; returns the reason of a failure.
   * Two presses count as one start.
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

  /** Closes the camera, in any step. */
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
      // The camera was unplugged or taken away.
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
    this.onView({ video: this.video, step, seen: this.seesHand(now_s()), left_s: this.frame.left_s }, '');
  }

  private seesHand(now: number): boolean {
    return now - this.lastSeen_s < Math.max(LOST_S, LOST_LOOKS * Math.min(this.look_s, SLOWEST_LOOK_S));
  }

  // Processes one picture after another, with pauses: the tracker has its own thread, but few machines have many cores.
  private async run(tracker: Tracker, round: number): Promise<void> {
    let before_s = now_s();
    while (round === this.round && this.video) {
      const began_s = now_s();
      try {
        // The last picture of a stopped camera does not show the present hand.
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

  private take({ image, world }: TrackedHand, time_s: number): void {
    const aspect = (this.video?.videoWidth ?? 4) / Math.max(1, this.video?.videoHeight ?? 3);
    const reading = readHand(image, world.length > 0 ? world : image, aspect);
    if (!reading) return;
    this.lastSeen_s = time_s;
    // The hand's distance at the end of the step becomes the middle of the depth.
    if (this.step === 'frame') this.follower.recentre();
    this.latest = this.follower.follow(reading, time_s);
    if (this.enabled && this.step === 'play') this.claimed_s = time_s;
  }

  private count(): void {
    if (this.step === 'frame') {
      this.frame.look(this.seesHand(now_s()), this.look_s);
      if (this.frame.left_s === 0) {
        this.step = 'play';
        this.finish('');
      }
    }
    this.show(this.step as WebcamStep);
  }
}

/** The camera's picture, mirrored. */
async function mirrorOf(stream: MediaStream): Promise<HTMLVideoElement> {
  const video = document.createElement('video');
  video.muted = true;
  video.playsInline = true;
  video.style.transform = 'scaleX(-1)';
  video.srcObject = stream;
  await video.play();
  return video;
}
