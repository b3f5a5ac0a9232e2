/** Why something of a recording is unavailable. */
export type ProblemKind =
  | 'unknown'      // no recording has that name
  | 'denied'       // the program requires another token
  | 'unreadable'   // the program gives the reason: newer, damaged, foreign
  | 'gone'         // the program does not answer
  | 'nonsense';    // the answer violates the contract

export class Problem extends Error {
  /** @param text the program's reason, in English; empty where it gave none */
  constructor(readonly kind: ProblemKind, readonly text = '') {
    super(`${kind}: ${text}`);
  }

  /** Whether a later attempt may succeed. */
  get passes(): boolean {
    return this.kind === 'gone';
  }
}

export function asProblem(thrown: unknown): Problem {
  return thrown instanceof Problem ? thrown : new Problem('nonsense', thrown instanceof Error ? thrown.message : String(thrown));
}
