// Pictures that materials wear: patterns of the liquids, wood, the glow. Drawn once, on a canvas.

import { CanvasTexture, RepeatWrapping, SRGBColorSpace, type Texture } from 'three';
import { liquidLook, type LiquidSymbol } from '../shared/liquids';

type Pen = CanvasRenderingContext2D;

export function picture(width: number, height: number, draw: (pen: Pen) => void): Texture {
  const canvas = document.createElement('canvas');
  canvas.width = width;
  canvas.height = height;
  const pen = canvas.getContext('2d');
  if (pen) draw(pen);
  const texture = new CanvasTexture(canvas);
  texture.colorSpace = SRGBColorSpace;
  return texture;
}

function stripes(pen: Pen, w: number, h: number, s: number): void {
  // A whole number of periods, so that the cylinder closes.
  const period = w / Math.max(1, Math.round(w / (48 * s)));
  pen.lineWidth = 13 * s;
  for (let x = -h - 2 * period; x < w + h; x += period) {
    pen.beginPath();
    pen.moveTo(x, h);
    pen.lineTo(x + h, 0);
    pen.stroke();
  }
}

function dots(pen: Pen, w: number, h: number, s: number): void {
  const period = w / Math.max(1, Math.round(w / (46 * s)));
  for (let y = period / 2, row = 0; y < h + period; y += period * 0.8, row++)
    for (let x = -(row % 2) * period / 2; x <= w + period; x += period) {
      pen.beginPath();
      pen.arc(x, y, 9.5 * s, 0, 2 * Math.PI);
      pen.fill();
    }
}

function waves(pen: Pen, w: number, h: number, s: number): void {
  const turns = Math.max(1, Math.round(w / (85 * s)));
  pen.lineWidth = 9 * s;
  for (let y = -42 * s; y < h + 42 * s; y += 42 * s) {
    pen.beginPath();
    for (let x = -8; x <= w + 8; x += 4) pen.lineTo(x, y + Math.sin(x / w * 2 * Math.PI * turns) * 9 * s);
    pen.stroke();
  }
}

function rings(pen: Pen, w: number, h: number, s: number): void {
  pen.lineWidth = 9 * s;
  for (let y = 27 * s; y < h; y += 54 * s) {
    pen.beginPath();
    pen.moveTo(0, y);
    pen.lineTo(w, y);
    pen.stroke();
  }
}

/** A liquid's pattern over the whole canvas. @param size 1: a period of about 48 pixels */
export function drawPattern(pen: Pen, width: number, height: number, liquid: string, size = 1): void {
  const look = liquidLook(liquid);
  pen.fillStyle = look.color;
  pen.fillRect(0, 0, width, height);
  pen.fillStyle = pen.strokeStyle = look.ink;
  ({ stripes, dots, waves, rings })[look.pattern](pen, width, height, size);
}

/** A liquid's symbol, filled with the pen's present colour. */
export function drawSymbol(pen: Pen, symbol: LiquidSymbol, x: number, y: number, r: number): void {
  pen.beginPath();
  if (symbol === 'circle') pen.arc(x, y, r * 0.9, 0, 2 * Math.PI);
  else {
    const corners: Record<Exclude<LiquidSymbol, 'circle'>, number[]> = {
      triangle: [0, -1, 0.98, 0.78, -0.98, 0.78],
      square: [-0.82, -0.82, 0.82, -0.82, 0.82, 0.82, -0.82, 0.82],
      diamond: [0, -1.05, 0.95, 0, 0, 1.05, -0.95, 0],
    };
    const c = corners[symbol];
    for (let i = 0; i < c.length; i += 2) pen.lineTo(x + c[i] * r, y + c[i + 1] * r);
    pen.closePath();
  }
  pen.fill();
}

export function patternTexture(liquid: string, width: number, height: number, size: number): Texture {
  const texture = picture(width, height, (pen) => drawPattern(pen, width, height, liquid, size));
  texture.wrapS = RepeatWrapping;
  return texture;
}

/** Numbers that look random and are the same every time. */
export function numbers(seed: number): () => number {
  let state = seed;
  return () => (state = (state * 16807) % 2147483647) / 2147483647;
}

export function woodTexture(): Texture {
  const random = numbers(7), w = 1024, h = 512;
  const texture = picture(w, h, (pen) => {
    pen.fillStyle = '#765443';
    pen.fillRect(0, 0, w, h);
    for (let i = 0; i < 420; i++) {
      const y = random() * h, phase = random() * 6, swing = 2 + random() * 5;
      pen.strokeStyle = random() < 0.55 ? '#432c20' : '#a07c60';
      pen.globalAlpha = 0.03 + random() * 0.09;
      pen.lineWidth = 0.6 + random() * 2.6;
      pen.beginPath();
      for (let x = 0; x <= w; x += 32) pen.lineTo(x, y + Math.sin(x / 190 + phase) * swing + Math.sin(x / 71 + phase) * 1.2);
      pen.stroke();
    }
  });
  texture.wrapS = texture.wrapT = RepeatWrapping;
  return texture;
}

/** A point of light: white core, amber halo. */
export function glowTexture(): Texture {
  return picture(128, 128, (pen) => {
    const g = pen.createRadialGradient(64, 64, 0, 64, 64, 64);
    g.addColorStop(0, 'rgba(255,255,255,1)');
    g.addColorStop(0.16, 'rgba(255,246,214,.95)');
    g.addColorStop(0.34, 'rgba(255,208,92,.55)');
    g.addColorStop(0.62, 'rgba(255,186,60,.16)');
    g.addColorStop(1, 'rgba(255,180,40,0)');
    pen.fillStyle = g;
    pen.fillRect(0, 0, 128, 128);
  });
}
