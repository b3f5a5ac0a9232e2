// Sound is optional: without a device, or if the browser refuses it, nothing throws and the game continues.
import { afterEach, describe, expect, it, vi } from 'vitest';
import { Sound } from '../src/game/sound';

afterEach(() => { vi.unstubAllGlobals(); });

/** All calls of a game. */
function playAll(): void {
  const sound = new Sound();
  sound.unlock();
  sound.flow(0.8, 0.5);
  sound.flow(0, 0.5);
  sound.gurgle(0.5);
  for (const chime of ['line', 'step', 'done'] as const) sound.chime(chime);
  const on = sound.on;
  expect(sound.toggle()).toBe(!on);
  expect(sound.toggle()).toBe(on);
  sound.unlock();
}

const param = (): object => ({ value: 0, setTargetAtTime: () => {}, setValueAtTime: () => {}, linearRampToValueAtTime: () => {}, exponentialRampToValueAtTime: () => {} });
const node = (): object => {
  const made = { gain: param(), frequency: param(), Q: param(), connect: (to: unknown) => to, start: () => {}, stop: () => {} };
  return made;
};

describe('sound', () => {
  it('is silent if the browser has no audio', () => {
    vi.stubGlobal('AudioContext', undefined);
    expect(playAll).not.toThrow();
  });

  it('is silent without an audio device', () => {
    vi.stubGlobal('AudioContext', class { constructor() { throw new DOMException('no output device', 'NotSupportedError'); } });
    expect(playAll).not.toThrow();
  });

  it('is silent after the device is lost', () => {
    vi.stubGlobal('AudioContext', class { currentTime = 0; sampleRate = 48_000; destination = {}; createGain = node; createBuffer(): never { throw new Error('device lost'); } close = () => Promise.resolve(); });
    expect(playAll).not.toThrow();
  });

  it('continues if the browser refuses to resume it', async () => {
    const unhandled: unknown[] = [];
    const heard = (reason: unknown): void => { unhandled.push(reason); };
    process.on('unhandledRejection', heard);
    class RefusingAudioContext {
      state = 'suspended';
      currentTime = 0;
      sampleRate = 8;
      destination = {};
      createGain = node;
      createOscillator = node;
      createBiquadFilter = node;
      createBufferSource = node;
      createBuffer(): object { return { getChannelData: () => new Float32Array(16) }; }
      resume(): Promise<void> { return Promise.reject(new DOMException('not allowed', 'NotAllowedError')); }
    }
    vi.stubGlobal('AudioContext', RefusingAudioContext);
    expect(playAll).not.toThrow();
    await new Promise((done) => setTimeout(done, 10));
    process.off('unhandledRejection', heard);
    expect(unhandled).toEqual([]);
  });

  /** Plays on a fake device; returns the last volume of the gurgle, and the number of drops. */
  function heard(play: (sound: Sound) => void): { gurgle: number; drops: number } {
    let gains: { value: number }[] = [], begun = 0;
    const gain = (): object => { const value = { ...param(), value: 0, setTargetAtTime(to: number) { value.value = to; } }; gains.push(value); return { ...node(), gain: value }; };
    class Device {
      currentTime = 0; sampleRate = 8; destination = {};
      createGain = gain; createBiquadFilter = node; createBufferSource = node;
      createOscillator = (): object => ({ ...node(), start: () => { begun += 1; } });
      createBuffer(): object { return { getChannelData: () => new Float32Array(16) }; }
    }
    vi.stubGlobal('AudioContext', Device);
    vi.stubGlobal('document', { addEventListener: () => {} });
    const sound = new Sound();
    sound.unlock();
    const silent = begun;
    gains = gains.slice(2, 3);   // after the master and the stream: the gurgle
    play(sound);
    return { gurgle: gains[0]!.value, drops: begun - silent };
  }

  it('gurgles while air returns, and not after it', () => {
    expect(heard((sound) => sound.gurgle(0.5)).gurgle).toBeGreaterThan(0);
    expect(heard((sound) => { sound.gurgle(0.5); sound.gurgle(0); }).gurgle).toBe(0);
  });

  it('ends a stream in drops, once; warm air has none, and sounds that are off are silent', () => {
    const ends = (sound: Sound): void => { for (const rate of [0, 0.5, 0.5, 0.01, 0, 0]) sound.flow(rate, 0.5); };
    expect(heard(ends).drops).toBe(3);
    expect(heard((sound) => { for (const rate of [0, 0.5, 0]) sound.flow(rate, 0.5, 'air'); }).drops).toBe(0);
    expect(heard((sound) => { sound.on = false; ends(sound); }).drops).toBe(0);
  });
});
