// Music and local speech, with and without support by the machine.
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { barTones, BAR_S } from '../src/game/music';
import { MUSIC_VOLUMES, Sound } from '../src/game/sound';
import { Announcer, Speech, voiceOf } from '../src/game/speech';

const kept = new Map<string, string>();
beforeEach(() => {
  kept.clear();
  vi.useFakeTimers();
  vi.stubGlobal('localStorage', { getItem: (key: string) => kept.get(key) ?? null, setItem: (key: string, value: string) => kept.set(key, value) });
  vi.stubGlobal('document', { addEventListener: () => {}, hidden: false });
  vi.stubGlobal('navigator', { languages: ['de-CH', 'en-GB'] });
});
afterEach(() => { vi.useRealTimers(); vi.unstubAllGlobals(); });

/** The part of an AudioContext that the sounds use; it counts started sources. */
function audioContext() {
  const begun: number[] = [], levels: number[] = [];
  const param = () => ({ value: 0, setValueAtTime() {}, linearRampToValueAtTime() {}, exponentialRampToValueAtTime() {}, setTargetAtTime(value: number) { levels.push(value); } });
  const node = () => ({ gain: param(), frequency: param(), Q: param(), type: '', buffer: null, loop: false, connect: (to: object) => to, start: () => { begun.push(1); }, stop() {} });
  class Context {
    currentTime = 0; sampleRate = 100; destination = {};
    createGain = node; createOscillator = node; createBiquadFilter = node; createBufferSource = node;
    createBuffer = (_: number, samples: number) => ({ getChannelData: () => new Float32Array(samples) });
  }
  return { Context, begun, levels };
}

describe('music', () => {
  it('is off until the person turns it on, and its setting is kept', () => {
    const { Context, begun } = audioContext();
    vi.stubGlobal('AudioContext', Context);
    const sound = new Sound();
    sound.unlock();
    expect(begun.length).toBe(2);   // the flow noise and the gurgle, both silent
    sound.setMusic('soft');
    expect(begun.length).toBeGreaterThan(1);
    expect(new Sound().musicVolume).toBe('soft');
    sound.setMusic('off');
    const after = begun.length;
    vi.advanceTimersByTime(20_000);
    expect(begun.length).toBe(after);
  });

  it('is louder at each step and quieter than the bells', () => {
    const { Context, levels } = audioContext();
    vi.stubGlobal('AudioContext', Context);
    const sound = new Sound();
    for (const volume of MUSIC_VOLUMES) sound.setMusic(volume);
    expect(levels).toEqual([...levels].sort((a, b) => a - b));
    expect(Math.max(...levels)).toBeLessThan(0.16);
  });

  it('is in the C major scale, in a calm range', () => {
    const scale = [0, 2, 4, 5, 7, 9, 11];   // semitones over C
    for (const { tone_hz, at_s } of Array.from({ length: 8 }, (_, bar) => barTones(bar)).flat()) {
      const semitones = 12 * Math.log2(tone_hz / 261.6256);
      expect(Math.abs(semitones - Math.round(semitones))).toBeLessThan(1e-9);
      expect(scale).toContain(((Math.round(semitones) % 12) + 12) % 12);
      expect(tone_hz).toBeGreaterThan(80);
      expect(tone_hz).toBeLessThan(700);
      expect(at_s).toBeLessThan(BAR_S);
    }
  });

  it('without an audio device is a setting without effect, and throws nothing', () => {
    vi.stubGlobal('AudioContext', class { constructor() { throw new Error('no device'); } });
    const sound = new Sound();
    expect(() => { sound.setMusic('loud'); sound.chime('line'); sound.flow(0.8, 0.5); sound.toggle(); }).not.toThrow();
    expect(sound.musicVolume).toBe('loud');
  });
});

const voice = (lang: string, localService = true, isDefault = false) => ({ lang, localService, default: isDefault, name: lang, voiceURI: lang }) as SpeechSynthesisVoice;

describe('a voice', () => {
  it('is a local one of the page\'s language, preferably of the person\'s country', () => {
    const voices = [voice('en-US'), voice('de-DE', true, true), voice('de-CH'), voice('fr-FR', false)];
    expect(voiceOf(voices, 'de', ['de-CH'])?.lang).toBe('de-CH');
    expect(voiceOf(voices, 'de', ['en-GB'])?.lang).toBe('de-DE');
    expect(voiceOf(voices, 'fr', ['fr-CH'])).toBeNull();   // a server voice would send the text away
  });

  it('that is missing is detected, and nothing is thrown', () => {
    for (const synthesis of [undefined, { getVoices: () => [], cancel() {}, speak() { throw new Error('spoke'); }, addEventListener() {} }]) {
      vi.stubGlobal('speechSynthesis', synthesis);
      const speech = new Speech(() => {});
      expect(speech.on).toBe(false);
      speech.toggle();
      expect(speech.hasVoice).toBe(false);
      expect(() => { speech.onInstruction('Reach', '', 0); speech.onInstruction('Reach', '', 1000); speech.toggle(); }).not.toThrow();
    }
  });
});

describe('spoken text', () => {
  it('is text that was shown for a while, once, and only the new part of a hint', () => {
    const announcer = new Announcer();
    expect(announcer.look('Reach for the lemon', 'Move to the bright sign', 0)).toBe('');
    expect(announcer.look('Squeeze gently', '', 100)).toBe('');
    expect(announcer.look('Reach for the lemon', 'Move to the bright sign', 200)).toBe('');
    expect(announcer.look('Reach for the lemon', 'Move to the bright sign', 800)).toBe('Reach for the lemon. Move to the bright sign');
    expect(announcer.look('Reach for the lemon', 'Move to the bright sign', 5000)).toBe('');
    announcer.look('Reach for the lemon', 'Now reach forward', 6000);
    expect(announcer.look('Reach for the lemon', 'Now reach forward', 7000)).toBe('Now reach forward');
  });
});
