import { afterEach, beforeEach, expect, it, vi } from 'vitest';
import { ClinicApi, NoAnswerError } from '../src/clinic/api';

beforeEach(() => { vi.useFakeTimers(); });
afterEach(() => { vi.useRealTimers(); });

/** Records that answer after some time, unless the page has given up. */
const slow = (after_ms: number): ClinicApi => new ClinicApi(() => 'http://records', (_, { signal }) => new Promise((answer, refuse) => {
  setTimeout(() => answer(new Response('{"recovery_code":"1234"}')), after_ms);
  signal!.addEventListener('abort', () => refuse(new Error('aborted')));
}));

it.each(['init', 'unlock', 'phrase', 'recovery_code', 'sign_in', 'show', 'pin', 'accounts'])('a slow machine may derive a key for 15 s: %s', async (what) => {
  const answer = slow(15_000).send<{ recovery_code: string }>('POST', `/api/${what}`, {});
  await vi.advanceTimersByTimeAsync(15_000);
  expect((await answer).recovery_code).toBe('1234');
});

it('records that do not answer anything else are said after 6 s', async () => {
  const answer = slow(15_000).send('POST', '/api/visits/7/notes', {}), problem = answer.catch((why: unknown) => why);
  await vi.advanceTimersByTimeAsync(6000);
  expect(await problem).toBeInstanceOf(NoAnswerError);
});
