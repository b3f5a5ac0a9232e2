// Quiet generated music: slow chords, each broken into soft tones of a C major scale, repeated.

export interface Tone { readonly tone_hz: number; readonly at_s: number; readonly long_s: number; readonly loud: number }

/** Duration of a bar of four tones [s]. */
export const BAR_S = 4;
const C4_HZ = 261.6256;
/** Semitones over C4, four to a chord: C, A minor, F, G. */
const CHORDS = [[-12, 0, 4, 7], [-15, -3, 0, 4], [-19, -7, 0, 5], [-17, -5, -1, 2]] as const;
/** Tones of a melody, of the pentatonic scale, so that the repetitions differ; null: none in that bar. */
const MELODY = [12, 16, null, 14, null, 9, 7, null] as const;

const frequency = (semitones: number): number => C4_HZ * 2 ** (semitones / 12);

/** The tones of a bar, counted from 0. Equal temperament over C4 = 261.63 Hz. */
export function barTones(bar: number): Tone[] {
  const chord = CHORDS[bar % CHORDS.length], apart_s = BAR_S / chord.length;
  const tones: Tone[] = chord.map((semitones, i) => ({ tone_hz: frequency(semitones), at_s: i * apart_s, long_s: 3.2, loud: i === 0 ? 0.5 : 0.34 }));
  const melody = MELODY[bar % MELODY.length];
  if (melody !== null) tones.push({ tone_hz: frequency(melody), at_s: 1.5 * apart_s, long_s: 2.4, loud: 0.22 });
  return tones;
}

/** Tones are scheduled this far ahead [s], this often [ms]. */
const AHEAD_S = 1.5;
const LOOK_MS = 500;

/** Plays into `out` while it is on. */
export class Music {
  private timer: ReturnType<typeof setInterval> | null = null;
  private bar = 0;
  private next_s = 0;

  constructor(private readonly context: AudioContext, private readonly out: AudioNode) {}

  play(): void {
    if (this.timer !== null) return;
    this.next_s = this.context.currentTime + 0.1;
    this.timer = setInterval(() => this.look(), LOOK_MS);
    this.look();
  }

  stop(): void {
    if (this.timer !== null) clearInterval(this.timer);
    this.timer = null;
  }

  private look(): void {
    // Tones that a paused page has missed are skipped.
    this.next_s = Math.max(this.next_s, this.context.currentTime);
    while (this.next_s < this.context.currentTime + AHEAD_S) {
      for (const tone of barTones(this.bar)) this.sound(tone);
      this.bar += 1;
      this.next_s += BAR_S;
    }
  }

  private sound({ tone_hz, at_s, long_s, loud }: Tone): void {
    const { context, out } = this, from_s = this.next_s + at_s;
    const tone = context.createOscillator(), gain = context.createGain();
    tone.type = 'triangle';
    tone.frequency.value = tone_hz;
    gain.gain.setValueAtTime(0, from_s);
    gain.gain.linearRampToValueAtTime(loud, from_s + 0.12);
    gain.gain.exponentialRampToValueAtTime(0.001, from_s + long_s);
    tone.connect(gain).connect(out);
    tone.start(from_s);
    tone.stop(from_s + long_s);
  }
}
