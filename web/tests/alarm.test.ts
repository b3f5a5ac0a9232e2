// While the robot does not answer, every page says so and says nothing that soothes.
import { beforeEach, describe, expect, it } from 'vitest';
import { en } from '../src/console/i18n/en';
import { de } from '../src/console/i18n/de';
import { fr } from '../src/console/i18n/fr';
import { deviceLines } from '../src/console/device_status';
import { figuresOf, isWriting } from '../src/console/recordings';
import { statusOf } from '../src/console/run_status';
import { stoppedWords } from '../src/game/dialogs';
import { pageState, type Situation } from '../src/game/page_state';
import { DeviceStateT, RunState, SafetyState, WorldStateT } from '../src/protocol';
import { alarmTitle, alarmWords } from '../src/shared/alarm';
import { setLanguage } from '../src/shared/i18n';
import { en as shared } from '../src/shared/i18n/en';
import { isRecorded } from '../src/shared/recorded';
import { playOfSunset } from './sunset';

const WORDS = 'The robot does not answer. Press the emergency stop on the device now.';
const RUN_STATES = Object.values(RunState).filter((value): value is RunState => typeof value === 'number');
const SAFETY_STATES = Object.values(SafetyState).filter((value): value is SafetyState => typeof value === 'number');

function robot(more: Partial<WorldStateT> = {}): WorldStateT {
  const state = new WorldStateT();
  state.device = new DeviceStateT(true, true);
  return Object.assign(state, { runState: RunState.Rendering, safetyState: SafetyState.Rendering, silent: true, qM: [0, 0, 0] }, more);
}

// setLanguage() needs a page.
beforeEach(() => { Object.assign(globalThis, { document: { documentElement: {} } }); setLanguage('en'); });

describe('the alarm', () => {
  it('has the words of the program, from before the first tick on, and none while the robot answers', () => {
    expect(alarmWords(robot())).toBe(WORDS);
    expect(alarmWords(robot({ qM: [] })), 'the device was never read').toBe(WORDS);
    expect(alarmWords(robot({ silent: false }))).toBe('');
    expect(alarmWords(null)).toBe('');
  });

  it('says that a stop is not confirmed', () => {
    expect(alarmWords(robot({ runState: RunState.Stopping, stopPending: true, stopUnconfirmed: true }))).toBe(`Stop not confirmed. ${WORDS}`);
  });

  it('asks for no emergency stop of a simulated device', () => {
    expect(alarmWords(robot({ device: null, intention: [0, 0, 0] }))).toBe('The simulation does not answer.');
  });

  it('has its own words in every language', () => {
    const said = (['en', 'de', 'fr'] as const).map((language) => { setLanguage(language); return alarmWords(robot({ stopUnconfirmed: true })); });
    expect(new Set(said).size).toBe(3);
  });
});

describe('the console, while the robot does not answer', () => {
  // Words that claim to know the effort.
  const soothing = [en, de, fr].flatMap(({ pill, safety, states }) => [pill.rendering, pill.limited, pill.stopping, pill.stopped, pill.faulted, pill.disarmed, pill.armed, safety.stopping,
    safety.stoppingWhat, safety.stoppedWhat, safety.disarmedWhat, safety.faultedWhat, safety.armedWhat, safety.lostWhat, safety.noFault, states.rendering]);

  it.each(RUN_STATES)('says only the alarm in run state %i, whatever else the state says', (runState) => {
    let said = 0;
    for (const texts of [en, de, fr]) for (const safetyState of SAFETY_STATES) for (const line of ['open', 'lost'] as const) for (const paused of [false, true]) for (const stopPending of [false, true]) {
      const status = statusOf(line, robot({ runState, safetyState, stopPending, rehearsedTicks: Number(paused), latchedFaults: Number(stopPending) }), paused, ['device read failed'], texts);
      const words = [texts.states[status.name], status.short ?? texts.pill[status.name], status.cause, status.excess, status.did, status.todo].join('\n');
      expect(status).toMatchObject({ name: 'silent', bad: true, step: undefined, cause: WORDS });
      for (const soothes of soothing) expect(words).not.toContain(soothes);
      said += 1;
    }
    expect(said).toBe(3 * SAFETY_STATES.length * 8);
  });

  it('does not say that the device is enabled, or that the session is recorded', () => {
    const { device } = robot();
    for (const texts of [en, de, fr]) expect(deviceLines(device, texts, true)?.state).toBe(texts.device.silent);
    expect(isRecorded({ recording: 'a.h5' }, { ...robot(), recordingBytes: 1n })).toBeUndefined();
  });
});

describe('the list of recordings, while the robot does not answer', () => {
  const written = { name: 'a.h5', bytes: 262144, being_written: true };

  it('does not say that anything is being recorded', () => {
    expect(isWriting('a.h5', robot({ silent: false })), 'while it answers').toBe(true);
    expect(isWriting('a.h5', robot())).toBe(false);
    expect(figuresOf(written, false)).toContain(en.recordings.beingWritten);
    expect(figuresOf(written, true)).not.toContain(en.recordings.beingWritten);
    expect(figuresOf(written, true), 'its size is of a file that is there').toBe(figuresOf({ ...written, being_written: false }));
  });
});

describe('a stop on the console', () => {
  const stopping = (more: Partial<WorldStateT>) => statusOf('open', robot({ silent: false, runState: RunState.Stopping, ...more }), false, [], en);

  it('is only heard until the loop reports that it obeys', () => {
    expect(stopping({ stopPending: true })).toMatchObject({ name: 'stopping', cause: 'Stop heard', short: 'Stop heard' });
    expect(stopping({ stopPending: true }).did).not.toContain('falls');
  });

  it('is on its way to neutral when the loop obeys, and at neutral when the loop says so', () => {
    expect(stopping({})).toMatchObject({ cause: en.safety.stopping, did: en.safety.stoppingWhat });
    expect(stopping({}).short).toBeUndefined();
    expect(stopping({ safetyState: SafetyState.Disarmed })).toMatchObject({ short: en.pill.stopped });
  });

  it('that the loop does not obey in time is the alarm', () => {
    const status = statusOf('open', robot({ runState: RunState.Stopping, stopPending: true, stopUnconfirmed: true }), false, [], en);
    expect(status.cause).toBe(`Stop not confirmed. ${WORDS}`);
  });
});

it('the console keeps no limits before the first tick', () => {
  const status = statusOf('open', robot({ silent: false, safetyState: SafetyState.Disarmed }), false, [], en);
  expect(status).toMatchObject({ cause: en.safety.enabling, short: en.pill.enabling });
});

describe('the game', () => {
  const play = playOfSunset();
  const playing: Situation = { status: 'open', problem: null, everOpen: true, attempts: 0, wish: 'play', loading: false, resting: 'no', framing: false, unseen: 'no', loss: '', held: { heldByYou: true, held: true } };

  it.each(RUN_STATES)('shows no card beside the alarm in run state %i', (runState) => {
    const situations: Partial<Situation>[] = [{}, { status: 'lost' }, { loading: true }, { resting: 'off' }, { resting: 'between' }, { wish: 'watch' }, { wish: 'undecided' }, { framing: true }, { loss: 'left' }, { unseen: 'lost' }];
    for (const more of situations) expect(pageState({ ...playing, ...more }, play, robot({ runState, rested: true }))).toBe('silent');
  });

  it.each(['en', 'de', 'fr'] as const)('fills its bar with the words of the alarm in %s, so that it does not stand empty', (language) => {
    setLanguage(language);
    for (const state of [robot(), robot({ stopUnconfirmed: true })]) {
      const [title, more] = alarmTitle(state);
      expect(title).not.toBe('');
      expect(`${title} ${more}`).toBe(alarmWords(state));
    }
    expect(alarmTitle(robot({ device: null, intention: [0, 0, 0] }))[0]).toBe(alarmWords(robot({ device: null, intention: [0, 0, 0] })));
  });

  it('says that the robot no longer pushes only after the loop has ended', () => {
    expect((['heard', 'letting', 'let'] as const).map((letting) => shared[stoppedWords(letting)])).toEqual(['The stop was heard …', 'The robot lets go gently …', 'The robot no longer pushes. It only carries your arm.']);
  });
});
