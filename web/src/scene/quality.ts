// Drawing quality, high or low, by the machine's speed. Low has plain materials, no shadows, no multisampling.

export type Quality = 'high' | 'low';

export interface FrameStats { readonly frame_ms: number; readonly script_ms: number; readonly triangles: number }

/** Longer frames in high quality switch to low [ms]; 24 frames a second. */
const TOO_SLOW_MS = 42;
/** Frames must be slow for this long [ms]: a page that has just opened, or a tab in the background, is slow for a moment. */
const FOR_MS = 1500;

/** Names of software renderers. */
const SOFTWARE = /swiftshader|llvmpipe|softpipe|software|basic render/i;

/** The initial quality, by the name of the machine's renderer. */
export function initialQuality(): Quality {
  const gl = document.createElement('canvas').getContext('webgl2');
  if (!gl) return 'low';
  const info = gl.getExtension('WEBGL_debug_renderer_info');
  const name = String(info ? gl.getParameter(info.UNMASKED_RENDERER_WEBGL) : gl.getParameter(gl.RENDERER));
  gl.getExtension('WEBGL_lose_context')?.loseContext();
  return SOFTWARE.test(name) ? 'low' : 'high';
}

/**
 * Chooses low quality if frames are slow, and never switches back by itself: alternating pictures would be worse
 * than a plain one.
 */
export class QualityChooser {
  private slowSince_ms: number | undefined;

  constructor(private quality: Quality) {}

  /** @param now_ms of any monotonic clock */
  choose(stats: Pick<FrameStats, 'frame_ms'>, now_ms: number): Quality {
    if (this.quality === 'low') return 'low';
    if (stats.frame_ms <= TOO_SLOW_MS) this.slowSince_ms = undefined;
    else this.slowSince_ms ??= now_ms;
    if (this.slowSince_ms !== undefined && now_ms - this.slowSince_ms >= FOR_MS) this.quality = 'low';
    return this.quality;
  }
}
