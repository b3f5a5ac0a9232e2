// A button that lets the device move for as long as a person holds it, and not a moment longer.

const BEAT_MS = 40;
/** As the program counts (HoldSwitch::kSilent_ns): a page that hung for so long holds nothing any more. */
const SILENT_MS = 120;

/** The part of an element that is used. */
export type Holdable = Pick<HTMLElement, 'addEventListener' | 'removeEventListener' | 'setPointerCapture'>;
/** Where the page reports that the person cannot see it or has turned away from it. */
export interface Surroundings { readonly window: EventTarget; readonly document: EventTarget & { readonly hidden: boolean } }

export interface HoldOptions {
  /** A number above that of every press of this page before, of other buttons too: the program takes no older one. */
  readonly nextPress: () => number;
  /** With every beat, and once with `held` false when it is let go. */
  readonly send: (press: number, held: boolean) => void;
  /** It is held now, or not any more. */
  readonly changed: (held: boolean) => void;
  readonly allowed: () => boolean;
}

/**
 * Beats while a pointer or a key (space, enter) stays down on it. Letting go, a lost pointer or focus, a page that is
 * hidden, left or hung, and end() all end the press; it has to be pressed anew then. A click latches nothing.
 */
export class HoldButton {
  private press = 0;
  private by = '';            // 'pointer 3' or 'key Space'; empty: not held
  private beat_ms = 0;
  private timer: ReturnType<typeof setInterval> | undefined;
  private readonly unhook: (() => void)[] = [];

  constructor(private readonly element: Holdable, private readonly around: Surroundings, private readonly options: HoldOptions) {
    this.hook(element, 'pointerdown', (event) => this.pointerDown(event as PointerEvent));
    for (const up of ['pointerup', 'pointercancel', 'lostpointercapture']) {
      this.hook(element, up, (event) => this.endIf(`pointer ${(event as PointerEvent).pointerId}`));
    }
    this.hook(element, 'keydown', (event) => this.keyDown(event as KeyboardEvent));
    this.hook(element, 'keyup', (event) => this.endIf(`key ${(event as KeyboardEvent).code}`));
    this.hook(element, 'contextmenu', (event) => event.preventDefault());
    for (const gone of ['blur', 'pagehide']) {
      this.hook(around.window, gone, () => this.end());
    }
    this.hook(element, 'blur', () => this.end());
    for (const changed of ['visibilitychange', 'freeze']) this.hook(around.document, changed, () => { if (changed === 'freeze' || around.document.hidden) this.end(); });
  }

  get held(): boolean { return this.by !== ''; }

  /** Whatever ends it: the line is lost, another console leads, the program asks something. */
  end(): void {
    if (!this.held) return;
    this.by = '';
    clearInterval(this.timer);
    this.options.send(this.press, false);
    this.options.changed(false);
  }

  close(): void {
    this.end();
    for (const unhook of this.unhook) unhook();
  }

  private pointerDown(event: PointerEvent): void {
    if (event.button !== 0 || !event.isPrimary) return;
    this.element.setPointerCapture(event.pointerId);
    this.begin(`pointer ${event.pointerId}`);
  }

  private keyDown(event: KeyboardEvent): void {
    if (event.code !== 'Space' && event.code !== 'Enter') return;
    event.preventDefault();
    if (!event.repeat) this.begin(`key ${event.code}`);
  }

  private begin(by: string): void {
    if (this.held || !this.options.allowed() || this.around.document.hidden) return;
    this.by = by;
    this.press = this.options.nextPress();
    this.beat_ms = performance.now();
    this.options.send(this.press, true);
    this.timer = setInterval(() => this.beat(), BEAT_MS);
    this.options.changed(true);
  }

  private beat(): void {
    const now_ms = performance.now();
    const late = now_ms - this.beat_ms > SILENT_MS;
    this.beat_ms = now_ms;
    if (late || !this.options.allowed()) this.end();
    else this.options.send(this.press, true);
  }

  private endIf(by: string): void { if (this.by === by) this.end(); }

  private hook(target: Pick<EventTarget, 'addEventListener' | 'removeEventListener'>, name: string, call: (event: Event) => void): void {
    target.addEventListener(name, call);
    this.unhook.push(() => target.removeEventListener(name, call));
  }
}
