// A button that lets the device move only while a person holds it.

const HEARTBEAT_MS = 40;
/** Equal to HoldSwitch::kSilent_ns of the program: a page that hung for this long holds nothing any more. */
const SILENT_MS = 120;

/** The part of an element that is used. */
export type Holdable = Pick<HTMLElement, 'addEventListener' | 'removeEventListener' | 'setPointerCapture'>;
/** The targets of events by which the page is hidden or loses the focus. */
export interface Surroundings { readonly window: EventTarget; readonly document: EventTarget & { readonly hidden: boolean } }

export interface HoldOptions {
  /** Returns a number above those of all earlier presses of this page, other buttons included: the program accepts no older number. */
  readonly nextPress: () => number;
  /** Called with every heartbeat, and once with `held` false when the button is released. */
  readonly send: (press: number, held: boolean) => void;
  /** Called when the button becomes held or released. */
  readonly changed: (held: boolean) => void;
  readonly allowed: () => boolean;
}

/**
 * Sends heartbeats while a pointer or a key (space, enter) stays down on it. A release, a lost pointer or focus, a page that
 * is hidden, left or hung, and end() all end the press; then it must be pressed again. A click does not latch.
 */
export class HoldButton {
  private press = 0;
  private by = '';            // 'pointer 3' or 'key Space'; empty: not held
  private heartbeat_ms = 0;
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

  /** Ends the press from outside: the connection is lost, another console leads, or the program asks a question. */
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
    this.heartbeat_ms = performance.now();
    this.options.send(this.press, true);
    this.timer = setInterval(() => this.heartbeat(), HEARTBEAT_MS);
    this.options.changed(true);
  }

  private heartbeat(): void {
    const now_ms = performance.now();
    const late = now_ms - this.heartbeat_ms > SILENT_MS;
    this.heartbeat_ms = now_ms;
    if (late || !this.options.allowed()) this.end();
    else this.options.send(this.press, true);
  }

  private endIf(by: string): void { if (this.by === by) this.end(); }

  private hook(target: Pick<EventTarget, 'addEventListener' | 'removeEventListener'>, name: string, call: (event: Event) => void): void {
    target.addEventListener(name, call);
    this.unhook.push(() => target.removeEventListener(name, call));
  }
}
