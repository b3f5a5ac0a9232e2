import { h } from '../console/dom';
import { icon } from '../console/icons';
import { texts as consoleTexts } from '../console/i18n';
import { StepState, type CommissioningStepT, type CommissioningT, type FindingT } from '../protocol';
import { Changes } from '../shared/changes';
import { texts } from './i18n';
import { numbers } from './view';

const ICON = { [StepState.Waiting]: 'wait', [StepState.UnderWay]: 'play', [StepState.Done]: 'ok', [StepState.Failed]: 'bad' } as const;

/** All steps with their state and their findings. */
export class StepList {
  private readonly list = h('ol', { class: 'course' });
  readonly element = h('section', { class: 'panel', 'aria-label': texts().steps }, this.list);
  private readonly changes = new Changes();

  show(c: CommissioningT | null): void {
    if (!this.changes.of(c?.steps ?? [])) return;
    this.list.replaceChildren(...(c?.steps ?? []).map((step, i) => this.item(step, i)));
  }

  private item(step: CommissioningStepT, i: number): HTMLElement {
    const t = texts();
    const name = String(step.name);
    const item = h('li', { class: `todo ${StepState[step.state].toLowerCase()}`, 'data-step': name, 'data-state': StepState[step.state] },
      h('span', { class: 'mark' }, icon(ICON[step.state])),
      h('span', { class: 'name' }, `${i + 1}. ${t.step[name] ?? name}`), h('span', { class: 'state' }, t.states[step.state]));
    if (step.state === StepState.UnderWay) item.setAttribute('aria-current', 'step');
    if (step.findings.length > 0) item.append(this.findings(step.findings));
    return item;
  }

  // One row for each axis: its findings with units.
  private findings(findings: readonly FindingT[]): HTMLElement {
    const t = texts();
    const axes = [...new Set(findings.map((found) => String(found.axis)))];
    const findingWords = (found: FindingT): string => `${t.finding[String(found.quantity)] ?? String(found.quantity)}\u00a0${numbers(found, t.to)}\u00a0${String(found.unit)}`;
    return h('dl', {}, ...axes.flatMap((axis) => [
      h('dt', {}, axis === '' ? '' : consoleTexts().axesLong[axis] ?? axis),
      h('dd', {}, findings.filter((found) => String(found.axis) === axis).map(findingWords).join(', ')),
    ]));
  }
}
