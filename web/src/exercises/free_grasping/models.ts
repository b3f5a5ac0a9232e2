// Models of the objects: each has its collision shape, a colour and a pattern of its own. In the body's frame, z up.
import { BoxGeometry, Color, CylinderGeometry, Group, Mesh, SphereGeometry, type BufferGeometry, type Material, type Texture } from 'three';
import { surface } from '../../scene/materials';
import type { Quality } from '../../scene/quality';
import { brass } from '../../scene/stage';
import { picture, type Pen } from '../../scene/textures';
import type { Thing } from './things';

const PALE = '#FFF4DC';
const INK = '#1c1410';

function painted(width: number, height: number, color: string, draw: (pen: Pen) => void): Texture {
  return picture(width, height, (pen) => {
    pen.fillStyle = color;
    pen.fillRect(0, 0, width, height);
    draw(pen);
  });
}

/** A side of the cube: a frame, and a star in a pale square. */
function cubeSide(color: string): Texture {
  return painted(256, 256, color, (pen) => {
    pen.strokeStyle = 'rgba(10,20,60,.35)';
    pen.lineWidth = 8;
    pen.strokeRect(4, 4, 248, 248);
    pen.fillStyle = PALE;
    pen.beginPath();
    pen.roundRect(44, 44, 168, 168, 26);
    pen.fill();
    pen.fillStyle = color;
    pen.beginPath();
    for (let i = 0; i < 8; i++) {
      const turn = i * Math.PI / 4, r = i % 2 ? 26 : 70;
      pen.lineTo(128 + r * Math.sin(turn), 128 - r * Math.cos(turn));
    }
    pen.fill();
  });
}

/** The side of the tube: climbing stripes. */
function tubeSide(color: string): Texture {
  return painted(512, 384, color, (pen) => {
    pen.strokeStyle = '#8A6100';
    pen.lineWidth = 24;
    for (let x = -384; x < 900; x += 128) {
      pen.beginPath();
      pen.moveTo(x, 394);
      pen.lineTo(x + 404, -10);
      pen.stroke();
    }
  });
}

/** The ball: two pale bands and dots between them. */
function ballSide(color: string): Texture {
  return painted(1024, 512, color, (pen) => {
    pen.fillStyle = PALE;
    pen.fillRect(0, 168, 1024, 26);
    pen.fillRect(0, 318, 1024, 26);
    for (let i = 0; i < 12; i++) {
      pen.beginPath();
      pen.ellipse((i + 0.5) * 1024 / 12, 256, 20, 26, 0, 0, 2 * Math.PI);
      pen.fill();
    }
    pen.fillRect(0, 0, 1024, 40);
    pen.fillRect(0, 472, 1024, 40);
  });
}

/** A face of the disc: rings. */
function discFace(color: string): Texture {
  return painted(256, 256, color, (pen) => {
    for (const [r, tone, wide] of [[112, PALE, 9], [78, '#7FC9B4', 14], [44, PALE, 9]] as const) {
      pen.strokeStyle = tone;
      pen.lineWidth = wide;
      pen.beginPath();
      pen.arc(128, 128, r, 0, 2 * Math.PI);
      pen.stroke();
    }
    pen.fillStyle = PALE;
    pen.beginPath();
    pen.arc(128, 128, 18, 0, 2 * Math.PI);
    pen.fill();
  });
}

function mesh(geometry: BufferGeometry, material: Material | Material[]): Mesh {
  const made = new Mesh(geometry, material);
  made.castShadow = made.receiveShadow = true;
  return made;
}

export function makeThing({ kind, shape, color }: Thing, quality: Quality): Group {
  const root = new Group(), { radiusM: r, lengthM: l } = shape, fine = quality === 'high';
  const glossy = (map: Texture) => surface(quality, { map, roughness: 0.38, clearcoat: 0.5, clearcoatRoughness: 0.25 });
  const plain = (tone: string) => surface(quality, { color: new Color(tone), roughness: 0.45, clearcoat: 0.3 });
  const upright = (geometry: BufferGeometry) => geometry.rotateX(Math.PI / 2);
  if (kind === 'cube') {
    const h = shape.halfExtentsM ?? { x: 0, y: 0, z: 0 };
    root.add(mesh(new BoxGeometry(2 * h.x, 2 * h.y, 2 * h.z), glossy(cubeSide(color))));
  } else if (kind === 'sphere') root.add(mesh(upright(new SphereGeometry(r, fine ? 64 : 32, fine ? 48 : 24)), glossy(ballSide(color))));
  else if (kind === 'disk') {
    const face = glossy(discFace(color));
    root.add(mesh(upright(new CylinderGeometry(r, r, l, fine ? 96 : 40)), [plain(color), face, face]));
    root.add(mesh(upright(new CylinderGeometry(1.004 * r, 1.004 * r, 0.22 * l, fine ? 96 : 40, 1, true)), plain(PALE)));
  } else {
    const end = 0.009, metal = brass(quality), around = fine ? 72 : 32;
    root.add(mesh(upright(new CylinderGeometry(r, r, l - 2 * end, around, 1, true)), glossy(tubeSide(color))));
    for (const side of [-1, 1]) {
      const cap = mesh(upright(new CylinderGeometry(r, r, end, around)), metal), lid = mesh(upright(new CylinderGeometry(0.72 * r, 0.72 * r, 0.0006, around)), plain(INK));
      cap.position.z = side * (l - end) / 2;
      lid.position.z = side * l / 2;
      root.add(cap, lid);
    }
  }
  return root;
}
