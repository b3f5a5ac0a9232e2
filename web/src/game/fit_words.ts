// Words that must be read are never cut: a line that is too long is written smaller, and then in two lines.

/** Text is never smaller [px]. */
const LEAST_PX = 16;
/** Size of words in two lines, relative to one: both lines together are hardly taller. */
const TWO_LINES = 0.56;

export function fitWords(line: HTMLElement): void {
  line.style.fontSize = '';
  line.classList.remove('two');
  const over = line.scrollWidth / line.clientWidth;
  if (!(over > 1)) return;
  const size_px = parseFloat(getComputedStyle(line).fontSize), small_px = 0.99 * size_px / over;
  line.classList.toggle('two', small_px < LEAST_PX);
  line.style.fontSize = `${(small_px < LEAST_PX ? Math.max(LEAST_PX, TWO_LINES * size_px) : small_px).toFixed(1)}px`;
}
