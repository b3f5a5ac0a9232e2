import { describe, expect, it, vi } from 'vitest';
import { ConsoleModel } from '../src/console/model';
import type { Connection } from '../src/net/connection';

/** A connection that remembers what was asked of it. */
function connectionWith(controls: { heldByYou: boolean; held: boolean }, takes = true) {
  const asked: string[] = [];
  const connection = {
    controls, scene: null, status: 'open', on: () => () => {},
    takeControls: async () => {
      asked.push('take');
      if (takes) Object.assign(controls, { heldByYou: true, held: true });
      return takes ? { accepted: true, reason: '' } : { accepted: false, reason: 'another client holds the controls' };
    },
    releaseControls: async () => {
      asked.push('give back');
      Object.assign(controls, { heldByYou: false, held: false });
      return { accepted: true, reason: '' };
    },
  };
  return { asked, model: new ConsoleModel(connection as unknown as Connection) };
}

const order = (asked: string[], name: string, accepted = true) => async () => {
  await Promise.resolve();
  asked.push(name);
  return { accepted, reason: accepted ? '' : 'out of range' };
};

describe('an order of the therapist', () => {
  it('takes free controls for itself and gives them back', async () => {
    const { asked, model } = connectionWith({ heldByYou: false, held: false });
    await model.command('a', order(asked, 'a'));
    expect(asked).toEqual(['take', 'a', 'give back']);
  });

  it('two at once give them back once, after both', async () => {
    const { asked, model } = connectionWith({ heldByYou: false, held: false });
    await Promise.all([model.command('a', order(asked, 'a')), (async () => {
      await Promise.resolve();
      await model.command('b', order(asked, 'b'));
    })()]);
    expect(asked.filter((what) => what === 'give back')).toEqual(['give back']);
    expect(asked.at(-1)).toBe('give back');
  });

  it('keeps controls that the therapist took', async () => {
    const { asked, model } = connectionWith({ heldByYou: true, held: true });
    await model.command('a', order(asked, 'a'));
    expect(asked).toEqual(['a']);
  });

  it('steering keeps them', async () => {
    const { asked, model } = connectionWith({ heldByYou: false, held: false });
    await model.command('a', order(asked, 'a'), { keep: true });
    expect(asked).toEqual(['take', 'a']);
  });

  it('a refused one is said with its reason, and gives the controls back', async () => {
    const { asked, model } = connectionWith({ heldByYou: false, held: false });
    model.onRefused = vi.fn();
    await model.command('Fingers', order(asked, 'a', false));
    expect(model.onRefused).toHaveBeenCalledWith('Fingers', 'out of range');
    expect(asked.at(-1)).toBe('give back');
  });

  it('where another client holds them it is sent all the same, and that one is not disturbed', async () => {
    const { asked, model } = connectionWith({ heldByYou: false, held: true });
    await model.command('a', order(asked, 'a', false), { quietly: true });
    expect(asked).toEqual(['a']);
  });
});
