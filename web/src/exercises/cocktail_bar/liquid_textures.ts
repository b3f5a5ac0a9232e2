// The patterns and symbols of the liquids, drawn on a canvas.

import { RepeatWrapping, type Texture } from 'three';
import { picture, type Pen } from '../../scene/textures';
import { liquidLook, type LiquidSymbol } from './liquids';

function stripes(pen: Pen, w: number, h: number, s: number): void {
  // A whole number of periods, so that the texture wraps around the cylinder.
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

/** Draws a liquid's pattern over the whole canvas. @param size 1: a period of about 48 pixels */
function drawPattern(pen: Pen, width: number, height: number, liquid: string, size = 1): void {
  const look = liquidLook(liquid);
  pen.fillStyle = look.color;
  pen.fillRect(0, 0, width, height);
  pen.fillStyle = pen.strokeStyle = look.ink;
  ({ stripes, dots, waves, rings })[look.pattern](pen, width, height, size);
}

/** Draws a liquid's symbol, filled with the pen's present colour. */
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
