// Sound is an extra: without a device, or where the browser refuses it, nothing throws and the game goes on.
import { afterEach, describe, expect, it, vi } from 'vitest';
import { Sound } from '../src/game/sound';

afterEach(() => { vi.unstubAllGlobals(); });

/** Everything that a game asks of it. */
function playAll(): void {
  const sound = new Sound();
  sound.unlock();
  sound.flow(0.8, 0.5);
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
  it('is silent where the browser has none', () => {
    vi.stubGlobal('AudioContext', undefined);
    expect(playAll).not.toThrow();
  });

  it('is silent where there is no device', () => {
    vi.stubGlobal('AudioContext', class { constructor() { throw new DOMException('no output device', 'NotSupportedError'); } });
    expect(playAll).not.toThrow();
  });

  it('is silent where the device is gone in the middle', () => {
    vi.stubGlobal('AudioContext', class { currentTime = 0; sampleRate = 48_000; destination = {}; createGain = node; createBuffer(): never { throw new Error('device lost'); } close = () => Promise.resolve(); });
    expect(playAll).not.toThrow();
  });

  it('goes on where the browser refuses to resume it', async () => {
    const unhandled: unknown[] = [];
    const heard = (reason: unknown): void => { unhandled.push(reason); };
    process.on('unhandledRejection', heard);
    class Refusing {
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
    vi.stubGlobal('AudioContext', Refusing);
    expect(playAll).not.toThrow();
    await new Promise((done) => setTimeout(done, 10));
    process.off('unhandledRejection', heard);
    expect(unhandled).toEqual([]);
  });
});
