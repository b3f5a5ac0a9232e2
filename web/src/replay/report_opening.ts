// The page while the program makes a report, which takes half a minute for a recording of one hour.
import { h, setText } from '../console/dom';
import { icon } from '../console/icons';
import { fill } from '../shared/i18n';
import { factsPanel } from './facts_panel';
import { headerButtons } from './header';
import { texts } from './i18n';
import type { RecordingSource } from './recording_source';

export class ReportOpening {
  private readonly facts = h('div');
  private readonly words = h('p', { role: 'status', 'data-testid': 'making' });
  private readonly begun_ms = performance.now();
  private built: (() => void) | undefined;

  /** @param source the recording @param get fetches a page, and reports whether it came */
  constructor(private readonly root: HTMLElement, private readonly source: RecordingSource, private readonly get: (address: string) => Promise<boolean>) {}

  /** Shows the known facts at once, and the report once it is there. False: the program does not answer. */
  async open(show: (address: string) => void): Promise<boolean> {
    this.build();
    const seconds = setInterval(() => this.count(), 1000);
    void this.source.about().then((about) => {
      this.built = () => { this.facts.replaceChildren(factsPanel({ ...about, result: [] }, about.ticks_missing, null)); };
      this.built();
    }, () => {});   // the report itself describes faults of the file
    try {
      const came = await this.get(this.source.madeUrl);
      if (came) show(this.source.madeUrl);
      return came;
    } finally {
      clearInterval(seconds);
    }
  }

  build(): void {
    const t = texts();
    document.title = t.brand;
    document.body.dataset.state = 'opening';
    this.root.replaceChildren(h('header', { class: 'top' }, h('h1', { class: 'brand' }, icon('logo'), t.brand), h('span', { class: 'sp' }), headerButtons(() => this.build())),
      h('div'), h('main', { class: 'replay alone' }, h('section', { class: 'panel making' }, this.words, h('div', { class: 'going', role: 'progressbar', 'aria-label': t.makingLine })), this.facts));
    this.count();
    this.built?.();
  }

  private count(): void {
    setText(this.words, fill(texts().making, { s: Math.floor((performance.now() - this.begun_ms) / 1000) }));
  }
}
