import { OWN_SIGNS } from '../exercises/info';
import { RunState, type EventT } from '../protocol';
import type { ConsoleTexts } from './i18n/en';

/** A moment that every plot shows as a vertical line. */
export interface Mark {
  time_s: number;
  label: string;
  /** The meaning in words, for the safety panel and tables. */
  meaning: string;
  bad: boolean;
}

const SIGNS: Readonly<Record<string, [string, keyof ConsoleTexts['phases']]>> = { touched: ['①', 'bump'], engaged: ['②', 'engaged'] };

/** The sign of the grasp phase that an event begins; undefined where it begins none. */
export function phaseSign(name: string): string | undefined {
  return SIGNS[name]?.[0] ?? OWN_SIGNS[name]?.sign;
}

/** A repeated sign within this time belongs to the same moment [s]. */
const SAME_MOMENT_S = 0.4;

/** Marks of the last seconds: the phases of a grasp, stops and faults. */
export class Marks {
  list: Mark[] = [];
  private runState: RunState | undefined;

  /** Adds events of the exercise. @param timeOf a tick on the plots' clock */
  addEvents(events: readonly EventT[], names: readonly string[], timeOf: (tick: bigint) => number, texts: ConsoleTexts): void {
    for (const event of events) {
      const name = names[event.type] ?? '', label = phaseSign(name);
      if (label === undefined) continue;
      const meaning = OWN_SIGNS[name]?.meaning() ?? texts.phases[SIGNS[name]![1]];
      this.add({ time_s: timeOf(event.tick), label, meaning, bad: false });
    }
  }

  /** Adds a mark where rendering ends. */
  addRunState(runState: RunState, time_s: number, texts: ConsoleTexts, faulted = runState === RunState.Faulted): void {
    const left = this.runState === RunState.Rendering && runState !== RunState.Rendering;
    this.runState = runState;
    if (!left) return;
    const label = faulted ? texts.plots.fault : texts.plots.stop;
    this.add({ time_s, label, meaning: label, bad: true });
  }

  forgetBefore(time_s: number): void {
    this.list = this.list.filter((mark) => mark.time_s >= time_s);
  }

  private add(mark: Mark): void {
    const last = this.list.filter((other) => other.label === mark.label).at(-1);
    if (!last || mark.time_s - last.time_s > SAME_MOMENT_S) this.list.push(mark);
  }
}
