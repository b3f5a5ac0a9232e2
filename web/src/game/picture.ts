// The 3D picture behind the texts, where WebGL is available, in the quality that the machine can draw.
import type { SceneView } from '../scene/scene_view';
import type { Quality, QualityChooser } from '../scene/quality';
import type { ToneName as Tone } from '../hand/tones';

export type Picture = SceneView;

/** Chooses the quality: by ?quality=, or from the machine and its frame time. */
export class QualityWatch {
  constructor(public now: Quality, private readonly chooser: QualityChooser | null) {}

  /** Call after a frame. */
  look(picture: Picture, now_ms: number): void {
    const wanted = this.chooser?.choose(picture.stats(), now_ms) ?? this.now;
    if (wanted === this.now) return;
    this.now = wanted;
    picture.setQuality(wanted);
  }
}

/** Loads the 3D view, separately from the texts. Throws without WebGL. */
export async function loadPicture(canvas: HTMLCanvasElement, tone: Tone): Promise<{ picture: Picture; quality: QualityWatch }> {
  const [{ SceneView }, { initialQuality, QualityChooser }] = await Promise.all([import('../scene/scene_view'), import('../scene/quality')]);
  const asked = new URLSearchParams(location.search).get('quality');
  const quality = asked === 'low' || asked === 'high' ? asked : initialQuality();
  const picture = new SceneView(canvas, { quality, tone, view: 'game' });
  return { picture, quality: new QualityWatch(quality, quality === asked ? null : new QualityChooser(quality)) };
}
