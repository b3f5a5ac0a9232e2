import type { Span } from '../console/plot_source';

export const SPEEDS = [0.1, 0.5, 1, 2] as const;

/** The time in the recording, and whether it plays. */
export class Player {
  time_s: number;
  playing = false;
  speed = 1;

  /** @param span from the first to the last tick */
  constructor(private span: Span) {
    this.time_s = span.from_s;
  }

  get atEnd(): boolean {
    return this.time_s >= this.span.to_s - 1e-9;
  }

  setSpan(span: Span): void {
    this.span = span;
    this.seek(this.time_s);
  }

  seek(time_s: number): void {
    if (Number.isFinite(time_s)) this.time_s = Math.min(this.span.to_s, Math.max(this.span.from_s, time_s));
  }

  /** Starts or pauses; at the end, playback starts from the beginning. */
  toggle(): void {
    if (!this.playing && this.atEnd) this.seek(this.span.from_s);
    this.playing = !this.playing;
  }

  /** @param dt_s elapsed real time; it is limited, so that a suspended page does not jump */
  advance(dt_s: number): void {
    if (!this.playing) return;
    this.seek(this.time_s + Math.min(Math.max(0, dt_s), 0.25) * this.speed);
    if (!this.atEnd) return;
    this.seek(this.span.to_s);
    this.playing = false;
  }
}
