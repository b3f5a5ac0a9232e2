import '../shared/tokens.css';
import './game.css';
import { Controls } from '../input/controls';
import { openConnection } from '../net/open_connection';
import { h } from '../shared/dom';
import { onLanguage, startLanguage, text } from '../shared/i18n';
import { ClockOffset, FrameStats, type WholehandStats } from './frame_stats';
import { Game, noPictureCard } from './game';
import { loadPicture, type Picture, type QualityWatch } from './picture';

declare global {
  interface Window { wholehandStats: WholehandStats }
}

const stats = new FrameStats();
const clock = new ClockOffset();

startLanguage();
document.title = text('game.title');

const canvas = document.querySelector<HTMLCanvasElement>('#picture')!;
const page = document.querySelector<HTMLElement>('#page')!;
const play = h('div', { id: 'play', tabindex: 0, role: 'img', 'aria-label': text('game.picture') });
page.append(play);

const connection = await openConnection();
const controls = new Controls(connection, play);
const game = new Game(page, connection, controls, null, play);
onLanguage(() => {
  document.title = text('game.title');
  play.setAttribute('aria-label', text('game.picture'));
});
connection.on('state', (state) => clock.heard(Number(state.sentMonotonicNs) / 1e6, connection.latestStateAt_ms));

let picture: Picture | null = null;
let quality: QualityWatch | null = null;
let drawn: unknown = null;

Object.defineProperty(window, 'wholehandStats', { get: () => stats.report(quality?.now ?? 'none') });

function frame(now_ms: number): void {
  requestAnimationFrame(frame);
  const began_ms = performance.now();
  const state = connection.latestState;
  game.frame(state !== drawn);
  picture?.render(now_ms);
  drawn = state;
  const ended_ms = performance.now();
  stats.add(now_ms, ended_ms - began_ms + connection.takeReading_ms(), state && connection.status === 'open' ? clock.age_ms(Number(state.sentMonotonicNs) / 1e6, ended_ms) : NaN);
  if (picture) quality?.look(picture, ended_ms);
}
requestAnimationFrame(frame);

// The words are there at once; the picture follows when it is built.
try {
  const made = await loadPicture(canvas, game.tone);
  quality = made.quality;
  picture = made.picture;
  game.setPicture(picture);
  addEventListener('resize', () => picture?.resize());
} catch (problem) {
  console.warn('The bar cannot be drawn here:', problem);
  document.body.classList.add('blind');
  canvas.hidden = true;
  game.setPicture(null);
  page.append(noPictureCard());
}
stats.reset();
