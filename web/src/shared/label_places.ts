// Places of labels in a row above a chart, beside the lines that they name. Pixels of one canvas.

interface Span { readonly left: number; readonly right: number }

export class LabelPlaces {
  private readonly taken: Span[] = [];

  /** @param right end of the row @param gap distance of a label from its line, and of two labels */
  constructor(private readonly right: number, private readonly gap: number) {}

  /** A part of the row that something else covers. */
  cover(left: number, right: number): void { this.taken.push({ left, right }); }

  /** Left end of a label right of its line, or left of it at the end of the row; undefined: it has no room. */
  place(x: number, width: number): number | undefined {
    const left = x + this.gap + width > this.right ? x - this.gap - width : x + this.gap;
    if (this.taken.some((other) => left < other.right + this.gap && left + width > other.left - this.gap)) return undefined;
    this.cover(left, left + width);
    return left;
  }
}
