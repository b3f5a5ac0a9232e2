// Textures of materials: wood and the glow. Each is drawn once, on a canvas.

import { CanvasTexture, RepeatWrapping, SRGBColorSpace, type Texture } from 'three';

export type Pen = CanvasRenderingContext2D;

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

/** A picture that repeats in both directions. */
export function tiling(width: number, height: number, draw: (pen: Pen) => void): Texture {
  const texture = picture(width, height, draw);
  texture.wrapS = texture.wrapT = RepeatWrapping;
  return texture;
}

/** Adds colour stops to a gradient. */
export function graded(gradient: CanvasGradient, stops: readonly (readonly [at: number, color: string])[]): CanvasGradient {
  for (const [at, color] of stops) gradient.addColorStop(at, color);
  return gradient;
}

/** A deterministic pseudo-random generator. */
export function numbers(seed: number): () => number {
  let state = seed;
  return () => (state = (state * 16807) % 2147483647) / 2147483647;
}

export function woodTexture(): Texture {
  const random = numbers(7), w = 1024, h = 512;
  return tiling(w, h, (pen) => {
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
}

/** A point of light: white core, amber halo. */
export function glowTexture(): Texture {
  return picture(128, 128, (pen) => {
    pen.fillStyle = graded(pen.createRadialGradient(64, 64, 0, 64, 64, 64),
      [[0, 'rgba(255,255,255,1)'], [0.16, 'rgba(255,246,214,.95)'], [0.34, 'rgba(255,208,92,.55)'], [0.62, 'rgba(255,186,60,.16)'], [1, 'rgba(255,180,40,0)']]);
    pen.fillRect(0, 0, 128, 128);
  });
}
