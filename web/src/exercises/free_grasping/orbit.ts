// The view through the cabin's window, painted once: stars, and the Earth in the morning.
import type { Texture } from 'three';
import { graded, numbers, picture, type Pen } from '../../scene/textures';

const WIDTH = 1024;
const HEIGHT = 704;
/** The Earth's disc: middle and radius [px]. */
const EARTH = { x: 0.44 * WIDTH, y: 2.3 * HEIGHT, r: 1.72 * HEIGHT } as const;

function space(pen: Pen): void {
  pen.fillStyle = graded(pen.createLinearGradient(0, 0, WIDTH, HEIGHT), [[0, '#060b1c'], [0.6, '#0b1a38'], [1, '#163258']]);
  pen.fillRect(0, 0, WIDTH, HEIGHT);
  const random = numbers(101);
  for (let i = 0; i < 420; i++) {
    const bright = random() ** 4;
    pen.fillStyle = `rgba(${random() < 0.3 ? '255,226,190' : '220,234,255'},${(0.25 + 0.7 * bright).toFixed(2)})`;
    pen.beginPath();
    pen.arc(random() * WIDTH, random() * 0.62 * HEIGHT, 0.5 + 1.5 * bright, 0, 2 * Math.PI);
    pen.fill();
  }
}

/** Clouds: long soft streaks that follow the disc. */
function clouds(pen: Pen): void {
  const random = numbers(13);
  for (let i = 0; i < 520; i++) {
    const turn = (random() - 0.5) * 0.9, depth = random() ** 1.6, r = EARTH.r - 8 - 260 * depth;
    pen.strokeStyle = `rgba(255,255,255,${(0.04 + 0.16 * random()).toFixed(2)})`;
    pen.lineWidth = (1 + 9 * random()) * (0.3 + depth);
    pen.beginPath();
    pen.arc(EARTH.x, EARTH.y, r, turn - Math.PI / 2, turn - Math.PI / 2 + 0.01 + 0.09 * random());
    pen.stroke();
  }
}

function land(pen: Pen): void {
  const random = numbers(57);
  for (let i = 0; i < 34; i++) {
    const turn = -0.36 + 0.3 * random() + (i % 2) * 0.42, depth = random(), r = EARTH.r - 26 - 220 * depth;
    pen.fillStyle = i % 3 ? 'rgba(92,128,84,.5)' : 'rgba(176,150,98,.42)';
    pen.beginPath();
    pen.ellipse(EARTH.x + r * Math.sin(turn), EARTH.y - r * Math.cos(turn), 26 + 60 * random(), (5 + 16 * random()) * (0.35 + depth), turn, 0, 2 * Math.PI);
    pen.fill();
  }
}

function earth(pen: Pen): void {
  const { x, y, r } = EARTH;
  pen.fillStyle = graded(pen.createRadialGradient(x, y, r - 6, x, y, r + 74),
    [[0, 'rgba(190,232,255,.95)'], [0.12, 'rgba(112,188,255,.6)'], [0.4, 'rgba(64,130,230,.2)'], [1, 'rgba(40,90,200,0)']]);
  pen.fillRect(0, 0, WIDTH, HEIGHT);
  pen.save();
  pen.beginPath();
  pen.arc(x, y, r, 0, 2 * Math.PI);
  pen.clip();
  pen.fillStyle = graded(pen.createRadialGradient(x, y, r - 300, x, y, r),
    [[0, '#153f78'], [0.7, '#2a6cab'], [0.96, '#7dbbe6'], [1, '#d7f0ff']]);
  pen.fillRect(0, 0, WIDTH, HEIGHT);
  land(pen);
  clouds(pen);
  // The night side on the left.
  pen.fillStyle = graded(pen.createLinearGradient(0, 0, WIDTH, 0), [[0, 'rgba(4,10,30,.72)'], [0.42, 'rgba(4,10,30,0)']]);
  pen.fillRect(0, 0, WIDTH, HEIGHT);
  pen.restore();
}

export function orbitTexture(): Texture {
  return picture(WIDTH, HEIGHT, (pen) => {
    space(pen);
    earth(pen);
  });
}
