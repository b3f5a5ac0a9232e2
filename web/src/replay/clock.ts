import type { TimeTick, Span } from '../console/plot_source';
import { niceStep, ticksIn } from '../console/scale';

/** Steps of a time axis beyond a second that people read easily [s]. */
const STEPS_S = [1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600, 7200];

/** Formats a time: 83.4567 s with three decimals is 1:23.457. */
export function clockTime(time_s: number, decimals: number): string {
  if (!Number.isFinite(time_s)) return '–';
  const unit = 10 ** decimals;
  const all = Math.round(Math.abs(time_s) * unit);
  const [whole, part] = [Math.floor(all / unit), all % unit];
  const two = (n: number): string => String(n).padStart(2, '0');
  const hours = Math.floor(whole / 3600);
  const minutes = Math.floor(whole / 60) % 60;
  const text = hours > 0 ? `${hours}:${two(minutes)}:${two(whole % 60)}` : `${minutes}:${two(whole % 60)}`;
  return `${time_s < 0 && all > 0 ? '−' : ''}${text}${decimals > 0 ? `.${String(part).padStart(decimals, '0')}` : ''}`;
}

/** Labelled times of a window, at most `most` of them. */
export function clockTicks({ from_s, to_s }: Span, most: number): TimeTick[] {
  const span_s = Math.max(1e-6, to_s - from_s);
  const step_s = span_s / most <= 0.5 ? niceStep(span_s, most) : STEPS_S.find((step) => span_s / step <= most) ?? niceStep(span_s, most);
  const decimals = Math.min(3, Math.max(0, -Math.floor(Math.log10(step_s) + 1e-9)));
  return ticksIn(from_s, to_s, step_s).map((at_s) => ({ at_s, name: clockTime(at_s, decimals) }));
}
