import type { GameBodyShown } from '../net/game_bodies';
import type { SceneT, WorldStateT } from '../protocol';
import type { SceneView } from './scene_view';
import { QualityChooser, initialQuality, type Quality } from './quality';

export type HandLook = 'skin' | 'colliders';

/** Pictures per second [Hz]. */
export const PICTURES_HZ: Readonly<Record<Quality, number>> = { high: 30, low: 12 };

/** The picture beside plots: it is drawn less often than they are, in the quality that the machine can draw. */
export class PacedView {
  readonly canvas: HTMLCanvasElement;
  /** Chooses the quality; undefined where the address names one. */
  private readonly chooser: QualityChooser | undefined;
  private quality: Quality;
  private drawn_ms = -Infinity;

  private constructor(private readonly scene: SceneView, canvas: HTMLCanvasElement, quality: Quality, asked: boolean) {
    this.canvas = canvas;
    this.quality = quality;
    this.chooser = asked ? undefined : new QualityChooser(quality);
  }

  /** Builds the view. Fails without WebGL. @param forces each contact's force is drawn as an arrow */
  static async load({ forces = false } = {}): Promise<PacedView> {
    const asked = new URLSearchParams(location.search).get('quality');
    const quality: Quality = asked === 'high' || asked === 'low' ? asked : initialQuality();
    // three.js is large and is loaded after the numbers are shown.
    const { SceneView } = await import('./scene_view');
    const canvas = document.createElement('canvas');
    canvas.setAttribute('aria-hidden', 'true');
    return new PacedView(new SceneView(canvas, { quality, tone: 'honey', view: 'console', forces }), canvas, quality, asked === quality);
  }

  /** The quality; "none" until the picture can be drawn completely. */
  get drawnIn(): Quality | 'none' {
    return this.scene.whole ? this.quality : 'none';
  }

  setScene(scene: SceneT): void {
    this.scene.setScene(scene);
  }

  setBodies(bodies: readonly GameBodyShown[]): void {
    this.scene.setBodies(bodies);
  }

  show(look: HandLook): void {
    this.scene.setLook({ showColliders: look === 'colliders' });
  }

  resize(): void {
    this.scene.resize();
  }

  close(): void {
    this.scene.dispose();
  }

  /** Draws a state when the next picture is due. @param atOnce draws it now, because somebody waits for this state */
  draw(state: WorldStateT, now_ms: number, atOnce = false): void {
    if (!atOnce && now_ms - this.drawn_ms < 1000 / PICTURES_HZ[this.quality] - 2) return;
    this.drawn_ms = now_ms;
    this.scene.setState(state);
    this.scene.render(now_ms);
    if (atOnce) return;
    // Only frames that are slower than this view's own pace indicate a slow machine.
    const late_ms = this.scene.stats().frame_ms - 1000 / PICTURES_HZ[this.quality];
    const quality = this.chooser?.choose({ frame_ms: late_ms }, now_ms) ?? this.quality;
    if (quality === this.quality) return;
    this.quality = quality;
    this.scene.setQuality(quality);
  }
}
