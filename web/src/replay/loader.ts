import { asProblem, type Problem } from './problem';

/** A failed request is repeated after this time [ms]. */
const AGAIN_MS = 1000;

/** Loads the wanted keys, the most important first and a few at a time. Keys that the program refused are not requested again. */
export class Loader<Value> {
  private wanted: readonly string[] = [];
  private readonly underWay = new Set<string>();
  private readonly refused = new Set<string>();
  private timer: ReturnType<typeof setTimeout> | undefined;
  private closed = false;

  /**
   * @param take receives a loaded value
   * @param report receives the reason of a failure; undefined: the program answers again
   */
  constructor(
    private readonly load: (key: string) => Promise<Value>, private readonly take: (key: string, value: Value) => void,
    private readonly report: (problem: Problem | undefined) => void, private readonly atOnce = 2,
  ) {}

  /** No request is under way or waits. */
  get idle(): boolean {
    return this.underWay.size === 0 && this.open().length === 0;
  }

  /** @param keys keys that are not loaded yet; they replace the earlier ones */
  want(keys: readonly string[]): void {
    this.wanted = keys;
    this.begin();
  }

  /** Repeats failed requests at once. */
  retry(): void {
    clearTimeout(this.timer);
    this.timer = undefined;
    this.refused.clear();
    this.begin();
  }

  close(): void {
    this.closed = true;
    clearTimeout(this.timer);
  }

  private open(): string[] {
    return this.wanted.filter((key) => !this.underWay.has(key) && !this.refused.has(key));
  }

  private begin(): void {
    if (this.closed || this.timer !== undefined) return;
    for (const key of this.open().slice(0, Math.max(0, this.atOnce - this.underWay.size))) void this.fetch(key);
  }

  private async fetch(key: string): Promise<void> {
    this.underWay.add(key);
    try {
      const value = await this.load(key);
      if (this.closed) return;
      this.wanted = this.wanted.filter((other) => other !== key);
      this.report(undefined);
      this.take(key, value);
    } catch (thrown) {
      this.failed(key, asProblem(thrown));
    } finally {
      this.underWay.delete(key);
      this.begin();
    }
  }

  private failed(key: string, problem: Problem): void {
    if (this.closed) return;
    if (!problem.passes) this.refused.add(key);
    else this.timer ??= setTimeout(() => { this.timer = undefined; this.begin(); }, AGAIN_MS);
    this.report(problem);
  }
}
