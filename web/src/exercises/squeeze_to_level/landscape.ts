// The valley in the morning, painted once: sky, mountain ranges in haze, a lake.
import { MirroredRepeatWrapping, type Texture } from 'three';
import { graded, numbers, picture, type Pen } from '../../scene/textures';

const WIDTH = 2048;
const HEIGHT = 1024;
/** Ranges from far to near: foot and height relative to the picture, roughness, colours of crest and foot. */
const RANGES = [
  { foot: 0.66, rise: 0.34, rough: 1, seed: 11, crest: '#8fa9c4', base: '#d9cfc6', snow: true },
  { foot: 0.72, rise: 0.25, rough: 0.8, seed: 23, crest: '#6d8fa6', base: '#c3c6bd', snow: true },
  { foot: 0.77, rise: 0.16, rough: 0.6, seed: 5, crest: '#51788a', base: '#9fb3a8', snow: false },
  { foot: 0.8, rise: 0.09, rough: 0.45, seed: 41, crest: '#3c6561', base: '#6f9382', snow: false },
] as const;

/** A crest by midpoint displacement, 0 .. 1. */
function crest(seed: number, rough: number): number[] {
  const random = numbers(seed * 7919);
  let line = [0.35, 0.8, 0.45, 0.95, 0.4];
  for (let size = 0.34 * rough; line.length < WIDTH / 4; size *= 0.52)
    line = line.flatMap((y, i) => i + 1 < line.length ? [y, (y + line[i + 1]!) / 2 + (random() - 0.5) * size] : [y]);
  return line;
}

function ridge(pen: Pen, line: readonly number[], foot: number, rise: number): void {
  pen.beginPath();
  pen.moveTo(0, foot * HEIGHT);
  line.forEach((y, i) => pen.lineTo(i / (line.length - 1) * WIDTH, (foot - rise * y) * HEIGHT));
  pen.lineTo(WIDTH, foot * HEIGHT);
  pen.closePath();
}

function mountains(pen: Pen): void {
  for (const { foot, rise, rough, seed, crest: high, base, snow } of RANGES) {
    const line = crest(seed, rough);
    ridge(pen, line, foot, rise);
    pen.fillStyle = graded(pen.createLinearGradient(0, (foot - rise) * HEIGHT, 0, foot * HEIGHT), [[0, high], [1, base]]);
    pen.fill();
    if (!snow) continue;
    // Snow covers the high parts.
    pen.save();
    pen.clip();
    pen.fillStyle = 'rgba(255,246,234,.78)';
    pen.beginPath();
    pen.moveTo(0, 0);
    line.forEach((y, i) => {
      const deep = Math.max(0, y - 0.6) * (0.6 + 0.22 * Math.sin(0.21 * i) + 0.14 * Math.sin(0.57 * i));
      pen.lineTo(i / (line.length - 1) * WIDTH, (foot - rise * (y - deep)) * HEIGHT);
    });
    pen.lineTo(WIDTH, 0);
    pen.fill();
    pen.restore();
  }
}

function sky(pen: Pen): void {
  pen.fillStyle = graded(pen.createLinearGradient(0, 0, 0, 0.7 * HEIGHT),
    [[0, '#5d93bd'], [0.45, '#a7cbdc'], [0.75, '#f3dfbd'], [1, '#fbd3a0']]);
  pen.fillRect(0, 0, WIDTH, HEIGHT);
  pen.fillStyle = graded(pen.createRadialGradient(0.7 * WIDTH, 0.48 * HEIGHT, 0, 0.7 * WIDTH, 0.48 * HEIGHT, 0.5 * HEIGHT),
    [[0, 'rgba(255,250,228,.95)'], [0.12, 'rgba(255,236,190,.6)'], [1, 'rgba(255,220,160,0)']]);
  pen.fillRect(0, 0, WIDTH, HEIGHT);
  const random = numbers(77);
  for (let i = 0; i < 26; i++) {
    const x = random() * WIDTH, y = (0.08 + 0.3 * random()) * HEIGHT, wide = 70 + 200 * random();
    pen.fillStyle = `rgba(255,250,240,${(0.08 + 0.14 * random()).toFixed(2)})`;
    pen.beginPath();
    pen.ellipse(x, y, wide, 5 + 9 * random(), 0, 0, 2 * Math.PI);
    pen.fill();
  }
}

/** Lake and near shore. */
function water(pen: Pen): void {
  const top = 0.8 * HEIGHT;
  pen.fillStyle = graded(pen.createLinearGradient(0, top, 0, HEIGHT), [[0, '#cfd9d2'], [0.35, '#8fb4bd'], [1, '#3f7482']]);
  pen.fillRect(0, top, WIDTH, HEIGHT - top);
  const random = numbers(3);
  for (let i = 0; i < 260; i++) {
    const share = random(), y = top + share * share * (HEIGHT - top), wide = 12 + 120 * share * random();
    pen.fillStyle = random() < 0.5 ? 'rgba(255,240,210,.16)' : 'rgba(30,70,84,.12)';
    pen.fillRect(random() * WIDTH, y, wide, 1 + 2.5 * share);
  }
  // Firs on the near shore.
  for (let i = 0; i < 150; i++) {
    const x = random() * WIDTH, foot = (0.8 + 0.012 * random()) * HEIGHT, high = 12 + 22 * random();
    pen.fillStyle = random() < 0.5 ? '#2f5650' : '#3a655a';
    pen.beginPath();
    pen.moveTo(x, foot - high);
    pen.lineTo(x + 0.26 * high, foot);
    pen.lineTo(x - 0.26 * high, foot);
    pen.fill();
  }
}

/** Wide enough for the middle of the window; it is mirrored to both sides. */
export function valleyTexture(): Texture {
  const texture = picture(WIDTH, HEIGHT, (pen) => {
    sky(pen);
    mountains(pen);
    water(pen);
  });
  texture.wrapS = MirroredRepeatWrapping;
  return texture;
}
