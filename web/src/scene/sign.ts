// A small sign with text, highlighted when it names the current task.
import { Mesh, PlaneGeometry, type Texture } from 'three';
import { flat } from './materials';
import { picture } from './textures';

const WIDTH_PX = 944;
const HEIGHT_PX = 224;
const TEXT_PX = 132;

function draw(words: string, lit: boolean): Texture {
  return picture(WIDTH_PX, HEIGHT_PX, (pen) => {
    pen.fillStyle = lit ? '#FFF4DC' : '#33251d';
    pen.beginPath();
    pen.roundRect(4, 4, WIDTH_PX - 8, HEIGHT_PX - 8, 58);
    pen.fill();
    pen.lineWidth = lit ? 16 : 8;
    pen.strokeStyle = lit ? '#FFB938' : '#8d6a3e';
    pen.beginPath();
    pen.roundRect(10, 10, WIDTH_PX - 20, HEIGHT_PX - 20, 52);
    pen.stroke();
    const font = (px: number) => { pen.font = `700 ${px}px "Atkinson Hyperlegible Next Variable", Verdana, sans-serif`; };
    font(TEXT_PX);
    const wide = pen.measureText(words).width, most = WIDTH_PX - 110;
    if (wide > most) font(TEXT_PX * most / wide);
    pen.fillStyle = lit ? '#1c1410' : '#FBEFD9';
    pen.textAlign = 'center';
    pen.textBaseline = 'middle';
    pen.fillText(words, WIDTH_PX / 2, HEIGHT_PX / 2 + 6);
  });
}

export class Sign {
  readonly root: Mesh;
  private shown = '';

  constructor(width_m: number) {
    this.root = new Mesh(new PlaneGeometry(width_m, width_m * HEIGHT_PX / WIDTH_PX), flat('#ffffff', { transparent: true }));
  }

  /** Redraws only when something changed. @param words empty: no sign */
  show(words: string, lit: boolean): void {
    this.root.visible = words !== '';
    const key = `${words} ${lit}`;
    if (key === this.shown || words === '') return;
    this.shown = key;
    const material = this.root.material as ReturnType<typeof flat>;
    material.map?.dispose();
    material.map = draw(words, lit);
    material.needsUpdate = true;
  }
}
