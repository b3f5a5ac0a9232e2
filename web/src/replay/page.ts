import { PacedView, type HandLook } from '../scene/paced_view';
import { h, setAttribute } from '../console/dom';
import { grouped } from '../shared/format';
import type { Span } from '../console/plot_source';
import { fill } from '../shared/i18n';
import { clockTime } from './clock';
import { arranged, Column } from './column';
import { Header } from './header';
import { texts } from './i18n';
import { ReplayNotices } from './notices';
import type { OpenFailure } from './open_recordings';
import { PlotMaker, type PlotChoice } from './plots';
import { Player } from './player';
import { asProblem } from './problem';
import type { ReplaySide } from './side';
import { TimeLine } from './time_line';
import { answerKey, Transport, type TransportHands } from './transport';
import { Zoom } from './zoom';

/** Texts and numbers change this often during playback: a faster rate is unreadable [ms]. */
const REFRESH_MS = 150;
/** A window has at least this many ticks. */
const LEAST_TICKS = 20;
const TENTH_S = 0.1;

/** The state of the page, for tests and debugging. */
export interface ReplayNow {
  time_s: number; playing: boolean; window: Span;
  rows: (number | undefined)[]; wanted: number[]; exact: boolean;
  /** The latest seeks whose exact states were loaded: time from the order to the picture [ms]. */
  scrub_ms: number[];
  loaded: number; quality: string;
  /** Number of a game's bodies, in each recording at this time. */
  bodies: number[];
}

/** One recording, or two side by side, at a common time. */
export class ReplayPage implements TransportHands {
  private readonly player: Player;
  private readonly zoom: Zoom;
  private readonly chosen: PlotChoice = { axis: 'finger_flexion', value: '' };
  private columns: Column[] = [];
  private header: Header | undefined;
  private notices: ReplayNotices | undefined;
  private line: TimeLine | undefined;
  private transport: Transport | undefined;
  private views: (PacedView | undefined)[] = [];
  private viewsTried = false;
  private look: HandLook = 'skin';
  private stale = true;         // the window, or the known data in it, has changed
  private last_ms: number | undefined;
  private refreshed_ms = -Infinity;
  private ordered_ms: number | undefined;
  private readonly scrub_ms: number[] = [];

  /** @param failed recordings that were requested and cannot be shown */
  constructor(private readonly root: HTMLElement, private readonly sides: readonly ReplaySide[], private readonly failed: readonly OpenFailure[]) {
    const [first, second] = sides;
    // The second recording is shifted so that it begins when the first one does.
    if (second) second.shift_s = first.about.from_s - second.about.from_s;
    this.player = new Player(this.span());
    this.zoom = new Zoom(this.span(), LEAST_TICKS * first.about.period_s);
    // A report's file may show its sheets instead of this page; then keys are ignored.
    addEventListener('keydown', (event) => { if (root.getClientRects().length > 0) answerKey(event, Math.round(TENTH_S / first.about.period_s), this); });
    this.build();
  }

  /** Builds every part again, in the current language and colours. */
  build(): void {
    this.close();
    const { sides } = this;
    const maker = new PlotMaker(sides, this.chosen);
    this.header = new Header(sides, () => this.rebuild());
    this.notices = new ReplayNotices(sides, this.failed, (side) => void this.readOn(side));
    const hands = {
      seek: (time_s: number) => this.seek(time_s), zoom: (window: Span) => this.show(window), look: (look: HandLook) => { this.look = look; },
      scale: (time_s: number, factor: number) => { this.zoom.scale(time_s, factor); this.stale = true; },
      choice: () => { for (const { plots } of this.columns) plots.build(); this.stale = true; },
    };
    this.columns = sides.map((side) => new Column(side, maker, this.look, hands));
    this.line = new TimeLine(sides, this.span(), hands);
    this.transport = new Transport(this, this.player.speed);
    this.root.replaceChildren(this.header.element, this.notices.element, arranged(this.columns),
      h('footer', { class: 'foot' }, this.line.element, this.transport.element));
    if (this.viewsTried) this.columns.forEach((column, i) => column.setView(this.views[i]));
    this.stale = true;
    this.refreshed_ms = -Infinity;
  }

  /** Loads the 3D views; without WebGL the page shows a text instead. */
  async loadViews(): Promise<void> {
    for (const [i, side] of this.sides.entries()) {
      if (!side.hasScene) continue;
      try {
        const view = await PacedView.load({ forces: true });
        view.setScene(side.scene);
        this.views[i] = view;
      } catch (problem) {
        console.warn('The 3D view cannot be drawn here:', problem);
      }
    }
    this.viewsTried = true;
    this.columns.forEach((column, i) => column.setView(this.views[i]));
    for (const { side } of this.columns) side.shown = undefined;
  }

  get now(): ReplayNow {
    const { player, zoom, sides, scrub_ms } = this;
    return {
      time_s: player.time_s, playing: player.playing, window: zoom.window, rows: sides.map(({ shown }) => shown), wanted: sides.map(({ wanted }) => wanted),
      // A seek that no picture has followed yet is not exact.
      exact: this.exact && this.ordered_ms === undefined, scrub_ms, loaded: Math.min(...sides.map(({ series }) => series.progress)), quality: this.views[0]?.drawnIn ?? 'none',
      bodies: sides.map(({ bodies }) => bodies.length),
    };
  }

  /** Draws one frame of the page. */
  frame(now_ms: number): void {
    const { player, zoom } = this;
    player.advance(this.last_ms === undefined ? 0 : (now_ms - this.last_ms) / 1000);
    this.last_ms = now_ms;
    if (player.playing && zoom.follow(player.time_s)) this.stale = true;
    const moved = this.columns.map(({ side }) => side.seek(player.time_s, zoom.window, player.playing, player.speed));
    const came = this.sides.filter((side) => side.fresh);
    for (const side of came) side.fresh = false;
    if (this.stale || came.length > 0) this.drawWindow(came.length > 0);
    this.drawStates(moved, now_ms);
    this.placeHeads();
    if (now_ms - this.refreshed_ms < REFRESH_MS && (player.playing || !moved.includes(true))) return;
    this.refreshed_ms = now_ms;
    this.refresh();
  }

  toggle(): void { this.player.toggle(); }
  home(): void { this.seek(this.span().from_s); }
  end(): void { this.seek(this.span().to_s); }
  all(): void { this.show(this.span()); }

  /** Seeks to a moment and pauses there. */
  goTo(time_s: number): void {
    this.player.playing = false;
    this.seek(time_s);
  }

  speed(speed: number): void {
    this.player.speed = speed;
    this.transport?.chooseSpeed(speed);
  }

  step(ticks: number): void {
    const [first] = this.sides;
    const last = Math.max(0, first.about.ticks - 1);
    const row = Math.min(last, Math.max(0, first.states.stepped(first.wanted, ticks)));
    this.player.playing = false;
    this.seek(first.timeOf(row));
    first.wanted = row;
  }

  mark(way: 1 | -1): void {
    const found = this.sides.flatMap((side) => {
      const moment = side.moments.beside(this.player.time_s - side.shift_s, way);
      return moment ? [moment.time_s + side.shift_s] : [];
    });
    if (found.length > 0) this.seek(way > 0 ? Math.min(...found) : Math.max(...found));
  }

  scale(factor: number): void {
    this.zoom.scale(this.player.time_s, factor);
    this.stale = true;
  }

  close(): void {
    for (const column of this.columns) column.close();
    this.line?.close();
  }

  /** The span from the first tick of any recording to the last one. */
  private span(): Span {
    const spans = this.sides.map(({ span }) => span);
    return { from_s: Math.min(...spans.map(({ from_s }) => from_s)), to_s: Math.max(...spans.map(({ to_s }) => to_s)) };
  }

  private get exact(): boolean {
    return this.sides.every((side) => side.rowAt(this.player.time_s) === undefined || side.shown === side.wanted);
  }

  private seek(time_s: number): void {
    this.player.seek(time_s);
    if (this.zoom.follow(this.player.time_s)) this.stale = true;
    this.ordered_ms = performance.now();
  }

  private show(window: Span): void {
    this.zoom.set(window);
    this.stale = true;
  }

  private rebuild(): void {
    const focused = document.activeElement?.getAttribute('data-testid');
    this.build();
    if (focused) this.root.querySelector<HTMLElement>(`[data-testid="${focused}"]`)?.focus();
  }

  private drawWindow(came: boolean): void {
    this.stale = false;
    for (const column of this.columns) column.drawWindow(this.zoom.window);
    if (came) this.line?.draw();
    this.line?.setWindow(this.zoom.window);
    this.notices?.refresh();
  }

  private drawStates(moved: readonly boolean[], now_ms: number): void {
    this.columns.forEach((column, i) => {
      if (moved[i]) column.drawState(now_ms, this.player.playing);
      else column.settle(now_ms, this.views[i] === undefined || this.views[i]?.drawnIn !== 'none');
    });
    if (this.ordered_ms === undefined || !this.exact) return;
    this.scrub_ms.push(performance.now() - this.ordered_ms);
    if (this.scrub_ms.length > 600) this.scrub_ms.shift();
    this.ordered_ms = undefined;
  }

  private placeHeads(): void {
    const { time_s } = this.player;
    for (const { plots, moments } of this.columns) {
      plots.placeHead(time_s);
      moments.placeHead(time_s);
    }
    this.line?.placeHead(time_s, fill(texts().timeLine.position, { time: clockTime(time_s, 3), tick: this.tickWords() }));
  }

  private tickWords(): string {
    const [{ about, wanted }] = this.sides;
    return fill(texts().transport.tick, { n: grouped(about.ticks === 0 ? 0 : wanted + 1), m: grouped(about.ticks) });
  }

  private refresh(): void {
    const { player, zoom } = this;
    setAttribute(document.body, 'data-state', player.playing ? 'playing' : this.exact ? 'still' : 'reading');
    for (const column of this.columns) column.refresh();
    this.transport?.show(player.time_s, this.tickWords(), this.exact, player.playing, zoom.window);
    this.header?.refresh();
  }

  /** Reads the description again: the file may have grown since it was opened. */
  private async readOn(side: ReplaySide): Promise<void> {
    try {
      side.grow(await side.source.about());
      side.problem = undefined;
    } catch (thrown) {
      side.problem = asProblem(thrown);
    }
    this.player.setSpan(this.span());
    this.zoom.setWhole(this.span());
    this.build();
  }
}
