// The stars in the window: one is lit for each held object. When all are lit, they are joined, and the sun rises.
import { AdditiveBlending, BufferGeometry, Color, Group, Line, LineBasicMaterial, Sprite, SpriteMaterial, Vector3, type Texture } from 'three';
import { glowTexture, graded, picture } from '../../scene/textures';
import { WINDOW } from './cabin';

/** Positions in the window, relative to its half sizes: on the hand's side, over the arm. */
const PLACES = [[0.4, 0.78], [0.56, 0.36], [0.74, 0.62], [0.9, 0.2]] as const;
/** Position of the sunrise over the Earth's edge. */
const SUN = [-0.6, -0.25] as const;
const SIZE_M = { dark: 0.022, lit: 0.12, sun: 0.6 } as const;
/** Time from dark to lit, and until the sun is up [s]. */
const FADE_S = 0.6;
const SUNRISE_S = 2.5;

/** Four long rays. */
function rayTexture(): Texture {
  return picture(128, 128, (pen) => {
    for (const turn of [0, Math.PI / 2]) {
      pen.save();
      pen.translate(64, 64);
      pen.rotate(turn);
      pen.scale(1, 0.07);
      pen.fillStyle = graded(pen.createRadialGradient(0, 0, 0, 0, 0, 64), [[0, 'rgba(255,255,255,1)'], [1, 'rgba(255,255,255,0)']]);
      pen.fillRect(-64, -64, 128, 128);
      pen.restore();
    }
    pen.fillStyle = graded(pen.createRadialGradient(64, 64, 0, 64, 64, 34),
      [[0, 'rgba(255,255,255,1)'], [0.35, 'rgba(255,255,255,.85)'], [1, 'rgba(255,255,255,0)']]);
    pen.fillRect(0, 0, 128, 128);
  });
}

const light = (map: Texture, color: Color): Sprite =>
  new Sprite(new SpriteMaterial({ map, color, transparent: true, blending: AdditiveBlending, depthWrite: false, toneMapped: false }));

/** Moves a share towards another at a constant rate, from 0 to 1 within `whole_s`. */
export function towards(share: number, wanted: number, dt_s: number, whole_s: number): number {
  const step = dt_s / whole_s;
  return share + Math.min(step, Math.max(-step, wanted - share));
}

export class Stars {
  readonly root = new Group();
  private readonly stars: { readonly sprite: Sprite; lit: number }[];
  private readonly lines: Line<BufferGeometry, LineBasicMaterial>;
  private readonly sun = light(glowTexture(), new Color('#fff1cf'));
  private morning = 0;

  /** @param colors colours of the objects @param side 1: a right hand; -1: mirrored */
  constructor(colors: readonly string[], side: 1 | -1) {
    const rays = rayTexture(), x = side * WINDOW.x, at = ([a, b]: readonly [number, number]) => new Vector3(x + side * a * WINDOW.half_x, WINDOW.y + b * WINDOW.half_y, 0);
    const places = colors.map((_, i) => at(PLACES[i % PLACES.length]!));
    this.stars = colors.map((color, i) => {
      const sprite = light(rays, new Color(color).lerp(new Color('#ffffff'), 0.4));
      sprite.position.copy(places[i]!);
      return { sprite, lit: 0 };
    });
    this.lines = new Line(new BufferGeometry().setFromPoints(places), new LineBasicMaterial({ color: '#ffe9bf', transparent: true, opacity: 0, toneMapped: false }));
    this.sun.position.copy(at(SUN));
    this.root.add(this.sun, this.lines, ...this.stars.map(({ sprite }) => sprite));
  }

  update(held: readonly boolean[], still: boolean, dt_s: number): void {
    this.stars.forEach((star, i) => {
      star.lit = towards(star.lit, held[i] ? 1 : 0, dt_s, FADE_S);
      star.sprite.scale.setScalar(SIZE_M.dark + (SIZE_M.lit - SIZE_M.dark) * star.lit);
      star.sprite.material.opacity = 0.5 + 0.5 * star.lit;
    });
    const all = held.length > 0 && held.every(Boolean);
    this.morning = towards(this.morning, all ? 1 : 0, dt_s, still ? FADE_S : SUNRISE_S);
    this.lines.material.opacity = 0.8 * this.morning;
    this.sun.scale.setScalar(SIZE_M.sun * (still ? 1 : this.morning));
    this.sun.material.opacity = this.morning;
    this.sun.visible = this.lines.visible = this.morning > 0;
  }
}
