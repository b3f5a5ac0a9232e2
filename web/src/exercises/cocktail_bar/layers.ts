// The content of the glass as heights: layers in the order of pouring.

export interface Layer { readonly liquid: string; readonly bottom_m: number; readonly top_m: number }

/** Layers thinner than this are not drawn [m]. */
const THINNEST_M = 2e-4;

/**
 * @param poured_l volume of each step, in the steps' order [l]
 * @param liquids  the liquid of each step
 * @param m_per_l  rise of the surface per litre [m]
 * @param rim_m    height of the rim over the glass's floor: what is above has overflowed [m]
 */
export function layersOf(poured_l: readonly number[], liquids: readonly string[], m_per_l: number, rim_m: number): Layer[] {
  const out: Layer[] = [];
  let height = 0;
  poured_l.forEach((volume, step) => {
    const top = Math.min(rim_m, height + Math.max(0, volume) * m_per_l);
    if (top - height > THINNEST_M && step < liquids.length) {
      const last = out[out.length - 1];
      if (last && last.liquid === liquids[step]) out[out.length - 1] = { ...last, top_m: top };
      else out.push({ liquid: liquids[step], bottom_m: height, top_m: top });
    }
    height = top;
  });
  return out;
}

/** Height of the surface over the glass's floor [m]. */
export function surfaceHeight(poured_l: readonly number[], m_per_l: number, rim_m: number): number {
  return Math.min(rim_m, poured_l.reduce((sum, v) => sum + Math.max(0, v), 0) * m_per_l);
}

/** Height of the fill line: the asked amount of this step over the earlier layers [m]. */
export function lineHeight(poured_l: readonly number[], step: number, asked_l: number, m_per_l: number, rim_m: number): number {
  return surfaceHeight([...poured_l.slice(0, step), asked_l], m_per_l, rim_m);
}
