import { nameOf } from '../shared/i18n';
import type { SceneT, WorldStateT } from '../protocol';
import type { BarScene } from '../scene/bar_scene';
import { QualityChooser, initialQuality, type Quality } from '../scene/quality';

export type HandLook = 'skin' | 'colliders';

/** The console asks for fewer pictures in low quality: the plots come first [Hz]. */
const RATE_HZ: Readonly<Record<Quality, number>> = { high: 30, low: 12 };
const LIQUIDS = ['lemon', 'cherry', 'blueberry', 'coconut'];

/** The small picture of the bar: drawn less often than the plots, and in the quality the machine can. */
export class SmallBar {
  readonly canvas: HTMLCanvasElement;
  /** Of none where the address says which quality. */
  private readonly chooser: QualityChooser | undefined;
  private quality: Quality;
  private drawn_ms = -Infinity;

  private constructor(private readonly scene: BarScene, canvas: HTMLCanvasElement, quality: Quality, asked: boolean) {
    this.canvas = canvas;
    this.quality = quality;
    this.chooser = asked ? undefined : new QualityChooser(quality);
  }

  /** Builds it. Fails where there is no WebGL. @param forces whether each contact's force is an arrow */
  static async load({ forces = false } = {}): Promise<SmallBar> {
    const asked = new URLSearchParams(location.search).get('quality');
    const quality: Quality = asked === 'high' || asked === 'low' ? asked : initialQuality();
    // three.js is large: the figures come first.
    const { BarScene } = await import('../scene/bar_scene');
    const canvas = document.createElement('canvas');
    canvas.setAttribute('aria-hidden', 'true');
    return new SmallBar(new BarScene(canvas, { quality, tone: 'honey', view: 'console', forces }), canvas, quality, asked === quality);
  }

  /** None until all of it can be drawn. */
  get drawnIn(): Quality | 'none' {
    return this.scene.whole ? this.quality : 'none';
  }

  setScene(scene: SceneT): void {
    this.scene.setScene(scene);
  }

  show(look: HandLook): void {
    const names = Object.fromEntries(LIQUIDS.map((liquid) => [liquid, nameOf('liquid', liquid)]));
    this.scene.setLook({ showColliders: look === 'colliders', names });
  }

  resize(): void {
    this.scene.resize();
  }

  close(): void {
    this.scene.dispose();
  }

  /** Draws a state if it is time to, or at once: then somebody waits for this very one. */
  draw(state: WorldStateT, now_ms: number, atOnce = false): void {
    if (!atOnce && now_ms - this.drawn_ms < 1000 / RATE_HZ[this.quality] - 2) return;
    this.drawn_ms = now_ms;
    this.scene.setState(state);
    this.scene.render(now_ms);
    if (atOnce) return;
    // Its own pace is no sign of a slow machine: only pictures slower than that are.
    const late_ms = this.scene.stats().frame_ms - 1000 / RATE_HZ[this.quality];
    const quality = this.chooser?.choose({ frame_ms: late_ms }, now_ms) ?? this.quality;
    if (quality === this.quality) return;
    this.quality = quality;
    this.scene.setQuality(quality);
  }
}
