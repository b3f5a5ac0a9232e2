// The guests at the bar, drawn flat: who waits, drinks and thanks. Coordinates of a square of 320.

import type { Pose } from './serving';

type Pen = CanvasRenderingContext2D;
type Hair = 'short' | 'bun' | 'curls' | 'bald' | 'long' | 'bob';

interface Look { readonly skin: string; readonly hair: Hair; readonly hairColor: string; readonly shirt: string; readonly glasses: boolean; readonly moustache: boolean }

/** One for every drink, in turn. */
const GUESTS: readonly Look[] = [
  { skin: '#E0AE8A', hair: 'bun', hairColor: '#B9B2A8', shirt: '#A8503C', glasses: true, moustache: false },
  { skin: '#8A5638', hair: 'short', hairColor: '#2B211C', shirt: '#C9A25A', glasses: false, moustache: false },
  { skin: '#EBC3A6', hair: 'bald', hairColor: '#CFC8BD', shirt: '#54708C', glasses: false, moustache: true },
  { skin: '#6E4430', hair: 'curls', hairColor: '#241913', shirt: '#8A5A86', glasses: false, moustache: false },
  { skin: '#CF9F80', hair: 'bob', hairColor: '#4A2A1A', shirt: '#4F7F6C', glasses: false, moustache: false },
  { skin: '#DDB08C', hair: 'long', hairColor: '#8A4B22', shirt: '#D8C5A0', glasses: true, moustache: false },
];

const INK = '#2A1C14';
const SIDE = 320;
const POSES: readonly Pose[] = ['waits', 'drinks', 'thanks'];

/** Size of the picture that drawGuest() fills: the poses side by side [px]. */
export const SHEET_PX = { width: SIDE * POSES.length, height: SIDE } as const;
/** Where a pose begins in it, as a part of its width. */
export const poseOffset = (pose: Pose): number => POSES.indexOf(pose) / POSES.length;

function shape(pen: Pen, path: string, fill: string, line = 5): void {
  const outline = new Path2D(path);
  pen.fillStyle = fill;
  pen.fill(outline);
  if (line > 0) { pen.lineWidth = line; pen.strokeStyle = INK; pen.stroke(outline); }
}

/** A limb: a wide line in ink under a narrower one. */
function limb(pen: Pen, path: string, color: string, width: number): void {
  const line = new Path2D(path);
  for (const [style, wide] of [[INK, width + 9], [color, width]] as const) { pen.strokeStyle = style; pen.lineWidth = wide; pen.stroke(line); }
}

function backHair(pen: Pen, { hair, hairColor }: Look): void {
  if (hair === 'long') shape(pen, 'M104 112Q98 40 160 38T216 112L226 206Q160 232 94 206Z', hairColor);
  if (hair === 'bob') shape(pen, 'M102 112Q98 38 160 38T218 112L222 160Q160 182 98 160Z', hairColor);
  if (hair === 'bun') shape(pen, 'M160 12a24 22 0 1 0 .1 0Z', hairColor);
  if (hair === 'curls') for (const [x, y] of [[110, 96], [112, 66], [134, 44], [160, 36], [186, 44], [208, 66], [210, 96]]) shape(pen, `M${x} ${y - 21}a21 21 0 1 0 .1 0Z`, hairColor, 5);
}

function frontHair(pen: Pen, { hair, hairColor }: Look): void {
  if (hair === 'bald') {
    shape(pen, 'M113 118Q106 102 116 88L122 110Z', hairColor, 4);
    shape(pen, 'M207 118Q214 102 204 88L198 110Z', hairColor, 4);
  } else if (hair === 'curls') shape(pen, 'M114 92Q118 52 160 52T206 92Q184 66 160 70T114 92Z', hairColor, 0);
  else if (hair === 'short') shape(pen, 'M112 98Q108 46 160 46T208 98Q200 74 180 72T140 76 112 98Z', hairColor);
  else shape(pen, 'M111 102Q108 46 160 46T209 102Q204 76 166 68 150 92 111 102Z', hairColor);
}

function face(pen: Pen, look: Look, pose: Pose): void {
  pen.strokeStyle = pen.fillStyle = INK;
  pen.lineWidth = 5;
  const stroke = (path: string) => pen.stroke(new Path2D(path));
  if (pose === 'waits') for (const x of [142, 178]) { pen.beginPath(); pen.ellipse(x, 112, 4.6, 6, 0, 0, 2 * Math.PI); pen.fill(); }
  else stroke('M133 114Q142 104 151 114M169 114Q178 104 187 114');
  pen.lineWidth = 4;
  stroke('M133 96Q142 91 151 95M169 95Q178 91 187 96M160 116Q156 128 162 130');
  if (look.glasses) stroke('M142 96a16 16 0 1 0 .1 0ZM178 96a16 16 0 1 0 .1 0ZM158 110Q160 108 162 110');
  if (look.moustache) shape(pen, 'M160 136Q138 132 130 146 150 152 160 142 170 152 190 146 182 132 160 136Z', look.hairColor, 3);
  pen.lineWidth = 5;
  pen.strokeStyle = INK;
  if (pose === 'waits') stroke('M146 147Q160 156 174 147');
  if (pose === 'thanks') shape(pen, 'M140 144Q160 150 180 144 176 166 160 166T140 144Z', '#FFF6E6', 4);
}

function body(pen: Pen, { skin, shirt }: Look): void {
  shape(pen, 'M38 330Q40 232 92 212 128 200 138 190H182Q192 200 228 212 280 232 282 330Z', shirt);
  shape(pen, 'M140 160V192Q160 216 180 192V160Z', skin);
  shape(pen, 'M138 190L160 216 146 230 124 198ZM182 190L160 216 174 230 196 198Z', '#FFF6E6', 4);
}

function head(pen: Pen, { skin }: Look): void {
  shape(pen, 'M110 112a10 13 0 1 0 2 24ZM210 112a10 13 0 1 1-2 24Z', skin, 4);
  shape(pen, 'M110 108Q108 48 160 48T210 108Q210 180 160 180T110 108Z', skin);
}

/** The glass in the hand, tipped to the mouth. */
function glass(pen: Pen): void {
  pen.save();
  pen.translate(186, 166);
  pen.rotate(-0.95);
  shape(pen, 'M-20-30H20L16 34H-16Z', 'rgba(234,246,245,.82)', 4);
  shape(pen, 'M-16-2L16-14 13 31H-13Z', '#E8A13C', 0);
  pen.restore();
}

function arms(pen: Pen, { skin, shirt }: Look, pose: Pose): void {
  if (pose === 'waits') {
    limb(pen, 'M66 300Q110 312 150 304', shirt, 34);
    limb(pen, 'M254 304Q210 316 170 308', shirt, 34);
    limb(pen, 'M150 304H166', skin, 24);
    limb(pen, 'M174 308H156', skin, 24);
    return;
  }
  limb(pen, 'M66 302Q104 314 138 308', shirt, 34);
  limb(pen, 'M140 308H154', skin, 24);
  if (pose === 'drinks') {
    glass(pen);
    limb(pen, 'M258 300Q276 268 240 226', shirt, 34);
    limb(pen, 'M226 206L212 184', skin, 24);
    return;
  }
  limb(pen, 'M252 306Q296 270 278 206', shirt, 34);
  limb(pen, 'M274 182L272 168', skin, 30);
  for (const finger of ['M258 160L250 132', 'M268 154L266 122', 'M279 155L284 124', 'M288 164L299 140', 'M256 176L238 166']) limb(pen, finger, skin, 11);
  pen.strokeStyle = skin;
  pen.lineWidth = 28;
  pen.stroke(new Path2D('M272 178V164'));
}

/** All poses of one guest. Draws nothing where the browser has no Path2D. */
export function drawGuest(pen: Pen, guest: number): void {
  const look = GUESTS[((guest % GUESTS.length) + GUESTS.length) % GUESTS.length];
  pen.lineCap = pen.lineJoin = 'round';
  POSES.forEach((pose, i) => {
    pen.save();
    pen.beginPath();
    pen.rect(i * SIDE, 0, SIDE, SIDE);
    pen.clip();
    pen.translate(i * SIDE, 0);
    backHair(pen, look);
    body(pen, look);
    head(pen, look);
    frontHair(pen, look);
    face(pen, look, pose);
    arms(pen, look, pose);
    pen.restore();
  });
}
