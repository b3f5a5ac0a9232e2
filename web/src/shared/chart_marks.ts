// Moments in a chart: vertical lines, and their labels over all lines. Pixels of one canvas.
import { LabelPlaces } from './label_places';

export interface ChartMoment { readonly x: number; readonly label: string; readonly bad: boolean }

export interface MomentLook {
  readonly dots: number;      // pixels of the canvas for one of the page
  readonly text_px: number;
  readonly line: string;
  readonly words: string;
  readonly bad: string;
  readonly paper: string;
}

export const FONT = '"Atkinson Hyperlegible Next Variable", Verdana, sans-serif';
const SIGNS = '"DejaVu Sans", "Segoe UI Symbol", "Apple Symbols", sans-serif';
/** Hundreds of lines would hide the data: lines closer than this are one [px of the page]. */
const APART_PX = 4;

/** Text on a background that keeps it readable over lines. */
export function writeOver(pen: CanvasRenderingContext2D, words: string, x: number, y: number, { dots, paper }: Pick<MomentLook, 'dots' | 'paper'>): void {
  pen.setLineDash([]);
  pen.lineJoin = 'round';
  pen.lineWidth = 4 * dots;
  pen.strokeStyle = paper;
  pen.strokeText(words, x, y);
  pen.fillText(words, x, y);
}

/** Lines first, then labels over all of them. Faults have the first choice of a place; a label without room is left out. */
export function drawMoments(pen: CanvasRenderingContext2D, { top, height }: { readonly top: number; readonly height: number }, moments: readonly ChartMoment[], look: MomentLook, places: LabelPlaces): void {
  const { dots, text_px, line, words, bad: red } = look, sorted = [...moments.filter(({ bad }) => bad), ...moments.filter(({ bad }) => !bad)];
  let last = -Infinity;
  for (const { x, bad } of sorted) {
    if (Math.abs(x - last) < APART_PX * dots) continue;
    last = x;
    pen.strokeStyle = bad ? red : line;
    pen.lineWidth = (bad ? 2 : 1) * dots;
    pen.setLineDash(bad ? [] : [2 * dots, 3 * dots]);
    pen.beginPath();
    pen.moveTo(x, top);
    pen.lineTo(x, top + height);
    pen.stroke();
  }
  for (const { x, label, bad } of sorted) {
    if (label === '') continue;
    // Signs such as circled numbers need a larger size to be readable.
    pen.font = label.length === 1 ? `${(text_px + 2) * dots}px ${SIGNS}` : `${bad ? 700 : 400} ${text_px * dots}px ${FONT}`;
    const left = places.place(x, pen.measureText(label).width);
    if (left === undefined) continue;
    pen.fillStyle = bad ? red : words;
    writeOver(pen, label, left, top + text_px * dots, look);
  }
}
