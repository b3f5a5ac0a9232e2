import '../shared/tokens.css';
import './game.css';
import { FIRST } from '../exercises';
import { Controls } from '../input/controls';
import { openConnection } from '../net/open_connection';
import type { WorldStateT } from '../protocol';
import { h } from '../shared/dom';
import { markInputMethod } from '../shared/a11y';
import { showAlarm } from '../shared/alarm';
import { onLanguage, startLanguage } from '../shared/i18n';
import { growWithZoom } from '../scene/zoomed_text';
import { noPictureCard } from './dialogs';
import { ClockOffset, FrameStats, type WholehandStats } from './frame_stats';
import { Game } from './game';
import { loadPicture, type Picture, type QualityWatch } from './picture';

declare global {
  interface Window { wholehandStats: WholehandStats }
}

/** Period of the picture behind the camera's card: starting the hand tracking needs the machine [ms]. */
const STILL_MS = 1000;

const stats = new FrameStats();
const clock = new ClockOffset();

startLanguage();
markInputMethod(document);
const followZoom = (): void => growWithZoom(document.documentElement);
followZoom();
addEventListener('resize', followZoom);
document.title = FIRST.pageTitle();

const canvas = document.querySelector<HTMLCanvasElement>('#picture')!;
const page = document.querySelector<HTMLElement>('#page')!;
const play = h('div', { id: 'play', tabindex: 0, role: 'img', 'aria-label': FIRST.pictureLabel() });
page.append(play);

const connection = await openConnection('player');
showAlarm(connection);
const controls = new Controls(connection, play);
const game = new Game(page, play, connection, controls);
onLanguage(() => {
  document.title = FIRST.pageTitle();
  play.setAttribute('aria-label', FIRST.pictureLabel());
});
connection.on('state', (state) => clock.addSample(Number(state.sentMonotonicNs) / 1e6, connection.latestStateAt_ms));

let picture: Picture | null = null;
let quality: QualityWatch | null = null;
let framed_ms = 0;
let rendered_ms = 0;
let drawn: WorldStateT | null = null;

Object.defineProperty(window, 'wholehandStats', { get: () => stats.report(picture?.whole && quality ? quality.now : 'none', picture?.memory) });

function frame(now_ms: number): void {
  requestAnimationFrame(frame);
  const began_ms = performance.now();
  const state = connection.latestState;
  framed_ms = began_ms;
  game.frame();
  if (!game.framing || began_ms - rendered_ms > STILL_MS) {
    picture?.render(now_ms);
    rendered_ms = began_ms;
  }
  const ended_ms = performance.now();
  stats.add(now_ms, ended_ms - began_ms + connection.takeReading_ms(), state && state !== drawn ? clock.age_ms(Number(state.sentMonotonicNs) / 1e6, ended_ms) : NaN);
  drawn = state;
  if (picture) quality?.look(picture, ended_ms, connection.controls.heldByYou);
  if (quality && document.body.dataset.quality !== quality.now) document.body.dataset.quality = quality.now;
}
requestAnimationFrame(frame);
// If frames are slow, or the page is hidden, a timer processes the program's messages.
setInterval(() => { if (performance.now() - framed_ms > 150) game.frame(); }, 100);

// The texts are shown at once; the picture follows when it is built.
try {
  const made = await loadPicture(canvas, game.tone);
  quality = made.quality;
  picture = made.picture;
  game.setPicture(picture);
  addEventListener('resize', () => picture?.resize());
  let note: HTMLElement | null = null;
  const lost = (isLost: boolean): void => {
    note?.remove();
    canvas.style.visibility = isLost ? 'hidden' : '';   // browsers draw a lost canvas white
    if (isLost) page.append(note = noPictureCard('lost'));
    game.pictureLost(isLost);
  };
  canvas.addEventListener('webglcontextlost', () => lost(true));
  canvas.addEventListener('webglcontextrestored', () => lost(false));
} catch (problem) {
  console.warn('The picture cannot be drawn here:', problem);
  document.body.classList.add('blind');
  canvas.hidden = true;
  game.setPicture(null);
  page.append(noPictureCard());
}
stats.reset();
