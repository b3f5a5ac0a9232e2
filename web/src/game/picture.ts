// The picture behind the words: the bar scene where WebGL is there, in the quality that the machine can draw.
import type { BarScene } from '../scene/bar_scene';
import type { Quality, QualityChooser } from '../scene/quality';
import type { Tone } from './dialogs';

export type Picture = BarScene;

/** Which quality is drawn in: asked for by ?quality=, or chosen from the machine and its frame time. */
export class QualityWatch {
  constructor(public now: Quality, private readonly chooser: QualityChooser | null) {}

  /** After a frame. */
  look(picture: Picture, now_ms: number): void {
    const wanted = this.chooser?.choose(picture.stats(), now_ms) ?? this.now;
    if (wanted === this.now) return;
    this.now = wanted;
    picture.setQuality(wanted);
  }
}

/** Throws where there is no WebGL. Loaded apart from the words, which are there at once. */
export async function loadPicture(canvas: HTMLCanvasElement, tone: Tone): Promise<{ picture: Picture; quality: QualityWatch }> {
  const [{ BarScene }, { initialQuality, QualityChooser }] = await Promise.all([import('../scene/bar_scene'), import('../scene/quality')]);
  const asked = new URLSearchParams(location.search).get('quality');
  const quality = asked === 'low' || asked === 'high' ? asked : initialQuality();
  const picture = new BarScene(canvas, { quality, tone, view: 'game' });
  return { picture, quality: new QualityWatch(quality, quality === asked ? null : new QualityChooser(quality)) };
}
