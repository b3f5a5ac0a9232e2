import type { Hands, Results } from '@mediapipe/hands';
import type { HandReading } from './landmarks';
import { curl, place, readHand, thumbCurl } from './landmarks';
import { OneEuroFilter } from './one_euro';
import type { InputWay, Wish } from './wish';
import { now_s, restingWish } from './wish';

/** Why there is no hand tracking, as a key of the texts; empty: there is. */
export type WebcamProblem = '' | 'insecure' | 'refused' | 'absent' | 'busy' | 'model';

export interface WebcamView {
  /** The picture, mirrored, for the person to see. */
  video: HTMLVideoElement;
  /** true while a hand is seen. */
  seen: boolean;
}

/** After this long without a hand the person is told [s]. */
const LOST_S = 0.7;
/** The program and its models come with the page: nothing is asked of any other server. */
const FOLDER = '/mediapipe/';

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

/** The person's own hand before a camera. The picture never leaves this page. */
export class Webcam implements InputWay {
  readonly way = 'webcam';
  claimed_s = -Infinity;
  private readonly follower = new HandFollower();
  private readonly pictures = new PictureWatch();
  private latest: Wish | undefined;
  private lastSeen_s = -Infinity;
  private hands: Hands | undefined;
  private stream: MediaStream | undefined;
  private video: HTMLVideoElement | undefined;
  private running = false;
  private enabled = false;

  constructor(private readonly onView: (view: WebcamView | undefined) => void) {}

  // The camera is only ever opened by start() and closed by stop(): a pause does neither.
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
    return now - this.lastSeen_s < LOST_S && this.latest ? this.latest : restingWish();
  }

  /** Opens the camera and loads the tracker; says in a word why not. */
  async start(): Promise<WebcamProblem> {
    if (this.running) return '';
    if (!navigator.mediaDevices?.getUserMedia) return 'insecure';
    try {
      const wanted = { video: { width: 640, height: 480, facingMode: 'user' }, audio: false };
      this.stream = await navigator.mediaDevices.getUserMedia(wanted);
    } catch (error) {
      return problemOf(error);
    }
    try {
      this.hands = await loadHands();
      this.hands.onResults((results) => this.onResults(results));
      await this.hands.initialize();
    } catch {
      this.stop();
      return 'model';
    }
    await this.show();
    // Unplugged, or taken away: nobody is seen any more.
    for (const track of this.stream.getTracks()) track.addEventListener('ended', () => this.stop());
    this.running = true;
    void this.run();
    return '';
  }

  stop(): void {
    this.running = false;
    this.claimed_s = -Infinity;
    this.latest = undefined;
    this.stream?.getTracks().forEach((track) => track.stop());
    this.stream = undefined;
    void this.hands?.close();
    this.hands = undefined;
    this.video = undefined;
    this.follower.recentre();
    this.onView(undefined);
  }

  private async show(): Promise<void> {
    this.video = document.createElement('video');
    this.video.muted = true;
    this.video.playsInline = true;
    this.video.style.transform = 'scaleX(-1)';
    this.video.srcObject = this.stream ?? null;
    await this.video.play();
    this.onView({ video: this.video, seen: false });
  }

  // One picture after another. The tracker works on the page's own thread: it gets half of it at most.
  private async run(): Promise<void> {
    while (this.running && this.video && this.hands) {
      const began_ms = performance.now();
      try {
        // The last picture of a camera that stands still says nothing of the hand now.
        if (this.pictures.isNew(this.video)) await this.hands.send({ image: this.video });
      } catch {
        this.stop();
        return;
      }
      const took_ms = performance.now() - began_ms;
      await new Promise((resume) => setTimeout(resume, Math.max(16, took_ms)));
    }
  }

  private onResults(results: Results): void {
    if (!this.running || !this.video) return;
    const time_s = now_s();
    const aspect = this.video.videoWidth / Math.max(1, this.video.videoHeight);
    const image = results.multiHandLandmarks?.[0] ?? [];
    const world = results.multiHandWorldLandmarks?.[0] ?? image;
    const reading = readHand(image, world, aspect);
    if (reading) {
      this.latest = this.follower.follow(reading, time_s);
      this.lastSeen_s = time_s;
      if (this.enabled) this.claimed_s = time_s;
    }
    this.onView({ video: this.video, seen: time_s - this.lastSeen_s < LOST_S });
  }
}

/** The tracker is a classic script that leaves its class at the window. */
async function loadHands(): Promise<Hands> {
  const there = window as unknown as { Hands?: typeof Hands };
  if (!there.Hands) {
    await new Promise<void>((done, fail) => {
      const script = document.createElement('script');
      script.src = `${FOLDER}hands.js`;
      script.onload = () => done();
      script.onerror = () => fail(new Error('hand tracking could not be loaded'));
      document.head.append(script);
    });
  }
  if (!there.Hands) throw new Error('hand tracking could not be loaded');
  const hands = new there.Hands({ locateFile: (file) => FOLDER + file });
  hands.setOptions({ maxNumHands: 1, modelComplexity: 0, minDetectionConfidence: 0.6, minTrackingConfidence: 0.5 });
  return hands;
}
