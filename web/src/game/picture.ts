// The 3D picture behind the texts, where WebGL is available, in the quality that the machine can draw.
import type { SceneView } from '../scene/scene_view';
import { QualityChooser, initialQuality, type Quality } from '../scene/quality';
import type { ToneName as Tone } from '../hand/tones';

export type Picture = SceneView;

/** Chooses the quality: by ?quality=, or from the machine and its frame time. */
export class QualityWatch {
  private readonly chooser: QualityChooser;

  /** @param asked the address names the quality */
  constructor(public now: Quality, private readonly asked: boolean) { this.chooser = new QualityChooser(now); }

  /**
   * Call after a frame. An asked quality holds while this page only shows; where it plays, slow pictures lower it, too:
   * software that draws them takes the processor that the page needs to be heard.
   */
  look(picture: Pick<Picture, 'stats' | 'setQuality'>, now_ms: number, plays: boolean): void {
    if (this.asked && !plays) return;
    const wanted = this.chooser.choose(picture.stats(), now_ms);
    if (wanted === this.now) return;
    this.now = wanted;
    picture.setQuality(wanted);
  }
}

/** Loads the 3D view, separately from the texts. Throws without WebGL. */
export async function loadPicture(canvas: HTMLCanvasElement, tone: Tone): Promise<{ picture: Picture; quality: QualityWatch }> {
  const { SceneView } = await import('../scene/scene_view');
  const asked = new URLSearchParams(location.search).get('quality');
  const quality = asked === 'low' || asked === 'high' ? asked : initialQuality();
  const picture = new SceneView(canvas, { quality, tone, view: 'game' });
  return { picture, quality: new QualityWatch(quality, quality === asked) };
}
