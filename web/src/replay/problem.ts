/** Why something of a recording cannot be had. */
export type ProblemKind =
  | 'unknown'      // no recording of that name
  | 'denied'       // the program wants another token
  | 'unreadable'   // the program says why: newer, damaged, foreign
  | 'gone'         // the program does not answer
  | 'nonsense';    // it answers something else than the contract says

export class Problem extends Error {
  /** @param text of the program, in English; empty where it said nothing */
  constructor(readonly kind: ProblemKind, readonly text = '') {
    super(`${kind}: ${text}`);
  }

  /** Asking again may help. */
  get passes(): boolean {
    return this.kind === 'gone';
  }
}

export function asProblem(thrown: unknown): Problem {
  return thrown instanceof Problem ? thrown : new Problem('nonsense', thrown instanceof Error ? thrown.message : String(thrown));
}
