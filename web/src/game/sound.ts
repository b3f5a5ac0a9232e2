// Generated sounds: a trickle while something flows, bells for reached and finished goals, and music once a person
// turns it on.
import type { Bells, Chime, FlowSound } from '../exercises/exercise';
import { store, stored } from '../shared/i18n';
import { Music } from './music';

const STORED = 'wholehand.sound';
const STORED_MUSIC = 'wholehand.music';
const VOLUME = 0.16;

/** Volumes of the music: off, and three steps 6 dB apart. */
export const MUSIC_VOLUMES = ['off', 'soft', 'medium', 'loud'] as const;
export type MusicVolume = typeof MUSIC_VOLUMES[number];
const MUSIC_GAIN: Readonly<Record<MusicVolume, number>> = { off: 0, soft: 0.03, medium: 0.06, loud: 0.12 };

const CHIMES: Readonly<Record<Exclude<Chime, Bells>, Bells>> = {
  line: { tones_hz: [880], apart_s: 0.12 }, step: { tones_hz: [659, 880], apart_s: 0.16 }, done: { tones_hz: [523, 659, 784], apart_s: 0.18 },
};

/** For each flow sound: its pitch at the lowest and the highest level [Hz], the narrowness of its band, and its volume. */
const FLOWS: Readonly<Record<FlowSound, { readonly low_hz: number; readonly high_hz: number; readonly narrow: number; readonly loud: number }>> = {
  stream: { low_hz: 500, high_hz: 1400, narrow: 1.2, loud: 0.8 },
  air: { low_hz: 140, high_hz: 420, narrow: 0.6, loud: 1 },
  tone: { low_hz: 220, high_hz: 330, narrow: 40, loud: 6 },
  slide: { low_hz: 190, high_hz: 520, narrow: 0.9, loud: 0.9 },
};

/** A stream whose rate falls below this, 0 .. 1, ends in drops: the time of each, and its volume. */
const ENDS = 0.04;
const DROPS = [{ after_s: 0.17, loud: 0.12 }, { after_s: 0.37, loud: 0.08 }, { after_s: 0.72, loud: 0.05 }] as const;
/** The pitch of a drop rises from the first to the second value while it sounds [Hz, s]. */
const DROP_HZ = [620, 1240] as const;
const DROP_S = 0.07;
/** The sound of returning air: centre of its noise band, amplitude and frequency of its swing [Hz], and volume. */
const GURGLE = { middle_hz: 260, swing_hz: 110, often_hz: 9, loud: 0.5 } as const;

export class Sound {
  on = stored(STORED) !== 'off';
  musicVolume: MusicVolume = MUSIC_VOLUMES.find((volume) => volume === stored(STORED_MUSIC)) ?? 'off';
  private context: AudioContext | null = null;
  private master: GainNode | null = null;
  private musicGain: GainNode | null = null;
  private music: Music | null = null;
  private trickle: { gain: GainNode; filter: BiquadFilterNode } | null = null;
  private air: GainNode | null = null;
  private rate = 0;

  /** Starts the audio. Call it from a gesture of the person: browsers allow no sound before one. */
  unlock(): void {
    if (this.context || typeof AudioContext === 'undefined') return;
    try {
      this.context = new AudioContext();
      this.master = this.context.createGain();
      this.master.gain.value = this.on ? VOLUME : 0;
      this.master.connect(this.context.destination);
      const noise = makeNoise(this.context);
      this.trickle = makeBand(this.context, noise, this.master);
      this.air = makeGurgle(this.context, noise, this.master);
      this.makeMusic(this.context);
    } catch {
      this.context = null;   // without an audio device the game continues silently
    }
  }

  toggle(): boolean {
    this.on = !this.on;
    store(STORED, this.on ? 'on' : 'off');
    this.unlock();
    if (this.context && this.master) this.master.gain.setTargetAtTime(this.on ? VOLUME : 0, this.context.currentTime, 0.05);
    return this.on;
  }

  setMusic(volume: MusicVolume): void {
    this.musicVolume = volume;
    store(STORED_MUSIC, volume);
    this.unlock();
    if (!this.context || !this.musicGain || !this.music) return;
    this.musicGain.gain.setTargetAtTime(MUSIC_GAIN[volume], this.context.currentTime, 0.3);
    if (volume === 'off') this.music.stop(); else this.music.play();
  }

  /** The sound of a flow of this rate, 0 .. 1; the pitch rises with the fill level, 0 .. 1. */
  flow(rate: number, level: number, sound: FlowSound = 'stream'): void {
    if (!this.context || !this.trickle) return;
    const now = this.context.currentTime, { low_hz, high_hz, narrow, loud } = FLOWS[sound];
    this.trickle.gain.gain.setTargetAtTime(Math.min(1, rate) * loud, now, 0.08);
    this.trickle.filter.frequency.setTargetAtTime(low_hz + (high_hz - low_hz) * Math.min(1, Math.max(0, level)), now, 0.1);
    this.trickle.filter.Q.value = narrow;
    if (sound === 'stream' && this.rate >= ENDS && rate < ENDS) this.drops(this.context);
    this.rate = rate;
  }

  /** The sound of air that returns into the squeezed container, 0 .. 1. */
  gurgle(rate: number): void {
    if (this.context && this.air) this.air.gain.setTargetAtTime(Math.min(1, rate) * GURGLE.loud, this.context.currentTime, 0.06);
  }

  chime(chime: Chime): void {
    const { context, master } = this, { tones_hz, apart_s } = typeof chime === 'string' ? CHIMES[chime] : chime;
    if (!context || !master || !this.on) return;
    tones_hz.forEach((tone_hz, i) => {
      const at = context.currentTime + i * apart_s;
      const gain = context.createGain();
      const tone = context.createOscillator();
      tone.frequency.value = tone_hz;
      gain.gain.setValueAtTime(0, at);
      gain.gain.linearRampToValueAtTime(0.7, at + 0.02);
      gain.gain.exponentialRampToValueAtTime(0.001, at + 0.9);
      tone.connect(gain).connect(master);
      tone.start(at);
      tone.stop(at + 1);
    });
  }

  /** The music has its own volume and a low-pass filter, so that speech and bells stand out. */
  private makeMusic(context: AudioContext): void {
    const dull = context.createBiquadFilter();
    dull.type = 'lowpass';
    dull.frequency.value = 1200;
    this.musicGain = context.createGain();
    this.musicGain.gain.value = MUSIC_GAIN[this.musicVolume];
    dull.connect(this.musicGain).connect(context.destination);
    this.music = new Music(context, dull);
    if (this.musicVolume !== 'off') this.music.play();
    // A hidden page is silent.
    document.addEventListener('visibilitychange', () => { void (document.hidden ? context.suspend() : context.resume()); });
  }

  private drops(context: AudioContext): void {
    if (!this.master || !this.on) return;
    for (const { after_s, loud } of DROPS) {
      const at = context.currentTime + after_s, gain = context.createGain(), tone = context.createOscillator();
      tone.frequency.setValueAtTime(DROP_HZ[0], at);
      tone.frequency.exponentialRampToValueAtTime(DROP_HZ[1], at + DROP_S);
      gain.gain.setValueAtTime(loud, at);
      gain.gain.exponentialRampToValueAtTime(0.001, at + DROP_S);
      tone.connect(gain).connect(this.master);
      tone.start(at);
      tone.stop(at + DROP_S);
    }
  }
}

/** Two seconds of noise in a loop. */
function makeNoise(context: AudioContext): AudioBufferSourceNode {
  const noise = context.createBuffer(1, 2 * context.sampleRate, context.sampleRate);
  const samples = noise.getChannelData(0);
  for (let i = 0, drop = 0; i < samples.length; i++) {
    if (Math.random() < 0.004) drop = 1;
    drop *= 0.996;
    samples[i] = (Math.random() * 2 - 1) * (0.25 + 0.75 * drop);
  }
  const source = context.createBufferSource();
  source.buffer = noise;
  source.loop = true;
  source.start();
  return source;
}

/** A band-pass of the noise for a stream, air or a tone; silent at first. */
function makeBand(context: AudioContext, noise: AudioNode, to: AudioNode): { gain: GainNode; filter: BiquadFilterNode } {
  const filter = context.createBiquadFilter();
  filter.type = 'bandpass';
  filter.frequency.value = 600;
  filter.Q.value = 1.2;
  const gain = context.createGain();
  gain.gain.value = 0;
  noise.connect(filter).connect(gain).connect(to);
  return { gain, filter };
}

/** A band-pass that swings: bubbles. */
function makeGurgle(context: AudioContext, noise: AudioNode, to: AudioNode): GainNode {
  const { gain, filter } = makeBand(context, noise, to), swing = context.createOscillator(), far = context.createGain();
  filter.frequency.value = GURGLE.middle_hz;
  filter.Q.value = 5;
  swing.frequency.value = GURGLE.often_hz;
  far.gain.value = GURGLE.swing_hz;
  swing.connect(far).connect(filter.frequency);
  swing.start();
  return gain;
}
