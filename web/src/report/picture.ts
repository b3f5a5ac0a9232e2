import { PacedView } from '../scene/paced_view';
import { fixed } from '../shared/format';
import { fill } from '../shared/i18n';
import { h, setText } from '../shared/dom';
import { timeOfState, readState } from '../replay/messages';
import { texts } from './i18n';
import { Mover, type ReportData } from './report_data';
import { shortTime } from './sheet';

/** Drawing continues for this long after the hand is complete, while the glow of a contact fades in [ms]. */
const SETTLES_MS = 700;
/** After this time the picture is taken even if the hand is incomplete [ms]. */
const PATIENCE_MS = 60_000;

/** The state to show: that of the strongest contact, or the last one. */
function shownState({ states, therapy: { strongest } }: Pick<ReportData, 'states' | 'therapy'>): number {
  if (!(strongest.force_n > 0)) return states.length - 1;
  const off = (i: number): number => Math.abs(timeOfState(states[i]!) - strongest.time_s);
  return states.reduce((best, _, i) => (off(best) <= off(i) ? best : i), 0);
}

/** The hand at the moment of the strongest contact, as a printable picture. */
export function pictureFrame(data: ReportData): HTMLElement {
  const t = texts().picture;
  const words = h('figcaption', { role: 'status' }, t.drawing);
  const place = h('div', { class: 'place' });
  const figure = h('figure', { class: 'picture', 'data-testid': 'picture' }, place, words);
  const at = shownState(data);
  const shown = data.states[at];
  if (!data.scene || !shown) {
    setText(words, fill(t.noScene, { why: data.about.no_picture_because || texts().facts.unknown }));
    figure.classList.add('without');
    return figure;
  }
  const { strongest } = data.therapy;
  const strong = fill(t.caption, { n: fixed(strongest.force_n, 1), time: shortTime(strongest.time_s) });
  const by = strongest.by === Mover.Person ? '' : ` (${texts().whose.shown[strongest.by]})`;
  const caption = strongest.force_n > 0 ? `${strong}${by}` : fill(t.last, { time: shortTime(timeOfState(shown)) });
  pictureOf(data, at, place).then((image) => {
    image.alt = caption;
    place.replaceChildren(image);
    setText(words, caption);
  }).catch((problem: unknown) => {
    console.warn('The 3D view cannot be drawn here:', problem);
    setText(words, t.none);
    figure.classList.add('without');
  });
  return figure;
}

let made: Promise<HTMLImageElement> | undefined;

/** Makes the picture once for a page; it does not depend on the language. */
async function pictureOf(data: ReportData, at: number, place: HTMLElement): Promise<HTMLImageElement> {
  made ??= draw(data, at, place);
  return (await made).cloneNode() as HTMLImageElement;
}

async function draw(data: ReportData, at: number, place: HTMLElement): Promise<HTMLImageElement> {
  const view = await PacedView.load({ forces: true });
  const holder = h('div', { class: 'drawing' }, view.canvas);
  place.ownerDocument.body.append(holder);
  try {
    view.setScene(data.scene!);
    view.setBodies(data.bodies.at(data.rows[at]!));
    view.show('skin');
    view.resize();
    const state = readState(data.states[at]!);
    const begun_ms = performance.now();
    let whole_ms = Infinity;
    for (;;) {
      const now_ms = performance.now();
      view.draw(state, now_ms, true);
      if (view.drawnIn !== 'none') whole_ms = Math.min(whole_ms, now_ms);
      if (now_ms - whole_ms > SETTLES_MS || now_ms - begun_ms > PATIENCE_MS) break;
      await new Promise((next) => setTimeout(next, 50));
    }
    // The canvas is read in the turn in which it was drawn: later the browser may have cleared it.
    const image = h('img', { src: view.canvas.toDataURL('image/png') });
    return image;
  } finally {
    holder.remove();
    view.close();
  }
}
