import type { Line } from './connection';

/** A stand-in for the program inside the page: development and tests only. */
export class FakeProgram {
  constructor(_options: URLSearchParams) {}
  line(): Line { throw new Error('comes next'); }
}
