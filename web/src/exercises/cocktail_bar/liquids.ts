/** Appearance of a liquid by its name in exercise_json: colour, pattern and symbol each distinguish it. */
export type LiquidPattern = 'stripes' | 'dots' | 'waves' | 'rings';
export type LiquidSymbol = 'triangle' | 'circle' | 'square' | 'diamond';

export interface LiquidLook {
  readonly color: string;    // colour of the liquid
  readonly ink: string;      // colour of its pattern
  readonly deep: string;     // the same hue on paper, for symbols
  readonly bubble: string;   // colour of air bubbles in it
  readonly pattern: LiquidPattern;
  readonly symbol: LiquidSymbol;
}

const LOOKS: Record<string, LiquidLook> = {
  lemon: { color: '#F6C636', ink: '#FFF0B0', deep: '#8A6100', bubble: '#FFFFFF', pattern: 'stripes', symbol: 'triangle' },
  cherry: { color: '#A31D38', ink: '#E58A97', deep: '#8E1730', bubble: '#FFFFFF', pattern: 'dots', symbol: 'circle' },
  blueberry: { color: '#3B6FD1', ink: '#A9C6FF', deep: '#2450A8', bubble: '#FFFFFF', pattern: 'waves', symbol: 'square' },
  coconut: { color: '#FBF4E6', ink: '#B9A98F', deep: '#4A3B2C', bubble: '#9C8A6E', pattern: 'rings', symbol: 'diamond' },
};
const UNKNOWN: LiquidLook = { color: '#9AA7A0', ink: '#DDE4E0', deep: '#4C5752', bubble: '#FFFFFF', pattern: 'rings', symbol: 'circle' };

/** The appearance of a liquid; an unknown one is grey with rings. */
export function liquidLook(name: string): LiquidLook {
  return LOOKS[name] ?? UNKNOWN;
}
