/** A cache of the most recently used values, up to a total size. */
export class BoundedCache<Value> {
  private readonly kept = new Map<string, { value: Value; size: number }>();
  private total = 0;

  constructor(private readonly most: number) {}

  get size(): number {
    return this.total;
  }

  has(key: string): boolean {
    return this.kept.has(key);
  }

  /** Returns a value without marking it as used. */
  peek(key: string): Value | undefined {
    return this.kept.get(key)?.value;
  }

  use(key: string): Value | undefined {
    const entry = this.kept.get(key);
    if (!entry) return undefined;
    this.kept.delete(key);
    this.kept.set(key, entry);
    return entry.value;
  }

  put(key: string, value: Value, size: number): void {
    this.drop(key);
    this.kept.set(key, { value, size });
    this.total += size;
    for (const oldest of this.kept.keys()) {
      if (this.total <= this.most || oldest === key) return;
      this.drop(oldest);
    }
  }

  entries(): IterableIterator<[string, { value: Value; size: number }]> {
    return this.kept.entries();
  }

  clear(): void {
    this.kept.clear();
    this.total = 0;
  }

  drop(key: string): void {
    const entry = this.kept.get(key);
    if (!entry) return;
    this.total -= entry.size;
    this.kept.delete(key);
  }
}
