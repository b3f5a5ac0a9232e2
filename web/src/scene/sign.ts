// A small sign with text, highlighted when it names the current task.
import { Mesh, PlaneGeometry, type Texture } from 'three';
import { flat } from './materials';
import { picture, type Pen } from './textures';

/** Size and lettering of a sign in pixels of its picture. Words wider than `most_px` are written smaller. */
export interface Board {
  readonly width_px: number;
  readonly height_px: number;
  readonly corner_px: number;
  readonly text_px: number;
  readonly most_px: number;
  write(pen: Pen, words: string, lit: boolean): void;
}

const WORDS: Board = {
  width_px: 944, height_px: 224, corner_px: 58, text_px: 132, most_px: 944 - 110,
  write(pen, words) {
    pen.textAlign = 'center';
    pen.fillText(words, this.width_px / 2, this.height_px / 2 + 6);
  },
};

export const inkOf = (lit: boolean): string => (lit ? '#1c1410' : '#FBEFD9');

function draw(board: Board, words: string, lit: boolean): Texture {
  const { width_px: w, height_px: h, corner_px, text_px, most_px } = board;
  return picture(w, h, (pen) => {
    pen.fillStyle = lit ? '#FFF4DC' : '#33251d';
    pen.beginPath();
    pen.roundRect(4, 4, w - 8, h - 8, corner_px);
    pen.fill();
    pen.lineWidth = lit ? 16 : 8;
    pen.strokeStyle = lit ? '#FFB938' : '#8d6a3e';
    pen.beginPath();
    pen.roundRect(10, 10, w - 20, h - 20, corner_px - 6);
    pen.stroke();
    const font = (px: number) => { pen.font = `700 ${px}px "Atkinson Hyperlegible Next Variable", Verdana, sans-serif`; };
    font(text_px);
    const wide = pen.measureText(words).width;
    if (wide > most_px) font(text_px * most_px / wide);
    pen.fillStyle = inkOf(lit);
    pen.textBaseline = 'middle';
    board.write(pen, words, lit);
  });
}

export class Sign {
  readonly root: Mesh;
  private shown = '';

  constructor(width_m: number, private readonly board = WORDS, height_m = width_m * board.height_px / board.width_px) {
    this.root = new Mesh(new PlaneGeometry(width_m, height_m), flat('#ffffff', { transparent: true }));
  }

  /** Redraws only when something changed. @param words empty: no sign */
  show(words: string, lit: boolean): void {
    this.root.visible = words !== '';
    const key = `${words} ${lit}`;
    if (key === this.shown || words === '') return;
    this.shown = key;
    const material = this.root.material as ReturnType<typeof flat>;
    material.map?.dispose();
    material.map = draw(this.board, words, lit);
    material.needsUpdate = true;
  }
}
