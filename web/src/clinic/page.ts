import { h, setAttribute } from '../console/dom';
import { Header } from '../console/header';
import { ConsoleModel } from '../console/model';
import { NoticesPanel } from '../console/notices';
import { listenForKeys } from '../console/keys';
import type { Connection } from '../net/connection';
import { PacedView } from '../scene/paced_view';
import { Changes } from '../shared/changes';
import { fill } from '../shared/i18n';
import { answerPresses } from '../shared/pressed';
import { AloneScreen } from './alone_screen';
import { Clinic } from './clinic';
import type { ClinicContext } from './clinic_context';
import { EndScreen } from './end_screen';
import { FirstStart } from './first_start';
import { texts } from './i18n';
import { LimitsScreen } from './limits_screen';
import { PatientForm } from './patient_form';
import { PatientScreen } from './patient_screen';
import { PatientsScreen } from './patients_screen';
import { ProgressPrint, VisitPrint } from './print_screens';
import { isOpen } from './records';
import { hashOf, routeOf, type Route } from './routes';
import { SettingsScreen } from './settings_screen';
import { inColour, UnlockScreen, WhoScreen } from './sign_in';
import { running } from './training';
import { button, problemWords, type Screen } from './ui';
import { VisitScreen } from './visit_screen';
import { clock } from './words';

/** Words and numbers are refreshed this often [ms]. */
const REFRESH_MS = 200;
/** The state of the records is requested this often [ms]. */
const LOOK_MS = 4000;
/** Period of the picture: it is drawn beside the patient's game, often on one machine [ms]. */
const PICTURE_MS = 1000 / 12;

/** The page for patients, visits and progress. One screen at a time is shown below a fixed header. */
export class ClinicPage implements ClinicContext {
  readonly clinic: Clinic;
  readonly model: ConsoleModel;
  private header: Header | undefined;
  private notices: NoticesPanel | undefined;
  private screen: Screen | undefined;
  private shown = '';
  private refreshed_ms = -Infinity;
  private drawn_ms = -Infinity;
  private view: Promise<PacedView | undefined> | undefined;
  private message: { words: string; bad: boolean } = { words: '', bad: false };
  /** During an open visit: the person asked for the unlock screen, which is shown instead of the visit. */
  private door = false;
  private readonly bars = { records: h('div', { class: 'notice warn', role: 'alert', hidden: true, 'data-testid': 'records-silent' }), told: h('div', { class: 'notice', role: 'status', hidden: true, 'data-testid': 'told' }), nav: h('nav', { class: 'places' }) };
  private readonly changes = { records: new Changes(), told: new Changes(), nav: new Changes() };

  constructor(private readonly root: HTMLElement, readonly connection: Connection) {
    this.model = new ConsoleModel(connection);
    this.clinic = new Clinic(location.hostname, () => sessionStorage, () => localStorage, () => performance.now());
    this.clinic.onChange = () => this.update();
    this.clinic.outbox.onRefused = (waiting, refused) => this.refuseKept(waiting.body, refused);
    this.model.onScene = () => this.screen?.sceneChanged?.();
    this.model.onRefused = (what, reason) => this.notices?.refuse(what, reason);
    connection.on('events', (events) => this.screen?.take?.(events));
    listenForKeys(this.model, () => this.header);
    for (const input of ['pointerdown', 'keydown', 'input']) addEventListener(input, () => this.clinic.touch(), { capture: true, passive: true });
    addEventListener('hashchange', () => { this.door = false; this.update(); });
    answerPresses(document);
    this.build();
    const look = (): void => void this.clinic.look().finally(() => setTimeout(look, LOOK_MS));
    look();
    setInterval(() => this.clinic.watch(), 1000);
  }

  go(route: Route): void {
    this.door = false;
    const hash = hashOf(route);
    if (location.hash === hash) this.update();
    else location.hash = hash;
  }

  showMessage(words: string, bad = false): void {
    this.message = { words, bad };
    this.refreshBars();
  }

  picture(): Promise<PacedView | undefined> {
    this.view ??= PacedView.load().catch((problem: unknown) => {
      console.warn('The 3D view cannot be drawn here:', problem);
      return undefined;
    });
    return this.view;
  }

  /** Builds everything again; the screens keep typed text. */
  build(): void {
    document.title = texts().title;
    this.notices?.close();
    this.header = new Header(this.model, () => this.build(), false, {
      who: () => this.screen?.who?.() ?? [texts().clinic, ''], what: () => this.screen?.what?.() ?? ['', ''],
      startable: () => (this.screen?.startable ? this.screen.startable() : undefined),
    });
    this.notices = new NoticesPanel(this.model);
    this.root.classList.add('live-page', 'clinic-page');
    this.root.dataset.view = 'therapy';
    this.shown = '';
    if (this.screen?.stays) this.root.replaceChildren(this.header.element, this.below(), this.screen.element);
    this.update();
  }

  frame(now_ms: number): void {
    // What was typed is kept, and a session that runs is not left.
    if (this.clinic.moved && this.clinic.silentSince && !running(this)) {
      this.clinic.moved = false;
      location.reload();
    }
    if (now_ms - this.refreshed_ms >= REFRESH_MS) {
      this.refreshed_ms = now_ms;
      this.header?.refresh();
      this.notices?.refresh();
      this.screen?.refresh?.();
    }
    if (!this.model.fresh || now_ms - this.drawn_ms < PICTURE_MS) return;
    this.model.fresh = false;
    this.drawn_ms = now_ms;
    this.screen?.draw?.();
  }

  /** Shows the current screen; an unchanged screen is not rebuilt. */
  private update(): void {
    const [name, make] = this.due();
    if (name !== this.shown && !this.screen?.stays) {
      this.shown = name;
      this.screen?.close?.();
      // The earlier screen is removed before the next one is made, so that no name stays in the page.
      this.screen = undefined;
      this.root.replaceChildren();
      this.screen = make();
      setAttribute(document.body, 'data-screen', name.split(' ')[0]);
      this.root.replaceChildren(this.header!.element, this.below(), this.screen.element);
      this.header!.refresh();
    }
    this.refreshBars();
    this.screen?.refresh?.();
  }

  private below(): HTMLElement {
    return h('div', { class: 'below' }, this.bars.nav, h('div', { class: 'notices' }, this.notices!.element, this.bars.records, this.bars.told));
  }

  /** The screen to show, and a name that changes whenever it must be built again. */
  private due(): readonly [name: string, make: () => Screen] {
    const { clinic } = this;
    const { stage } = clinic;
    const route = routeOf(location.hash);
    const visit = clinic.visit;
    // An open visit stays usable when names are hidden or the records are absent.
    if (visit && isOpen(visit) && stage !== 'in' && !this.door && ['hidden', 'who', 'locked', 'absent'].includes(stage)) return [`visit ${visit.id} ${stage}`, () => new VisitScreen(this, visit.id)];
    // A session that runs without records stays on the screen when the records answer again.
    const runs = this.screen instanceof AloneScreen && running(this);
    if (stage === 'absent' || (route.at === 'alone' && (clinic.silentSince || runs)) || (runs && stage !== 'in')) return ['alone', () => new AloneScreen(this)];
    switch (stage) {
      case 'looking': case 'without': return [stage, () => notYet(stage)];
      case 'new': return ['new', () => new FirstStart(this)];
      case 'locked': return ['locked', () => new UnlockScreen(this)];
      case 'who': case 'hidden': return [`who ${stage} ${JSON.stringify(clinic.state?.tiles)}`, () => new WhoScreen(this)];
      default: return this.of(route);
    }
  }

  private of(route: Route): readonly [name: string, make: () => Screen] {
    const name = `${route.at} ${hashOf(route)} ${this.clinic.account}`;
    switch (route.at) {
      case 'patients': return [name, () => new PatientsScreen(this)];
      case 'new': return [name, () => new PatientForm(this, 0)];
      case 'edit': return [name, () => new PatientForm(this, route.patient)];
      case 'limits': return [name, () => new LimitsScreen(this, route.patient)];
      case 'patient': return [name, () => new PatientScreen(this, route.patient)];
      case 'progress': return [name, () => new ProgressPrint(this, route.patient)];
      case 'summary': return [name, () => new VisitPrint(this, route.patient, route.visit)];
      case 'alone': return ['patients', () => new PatientsScreen(this)];
      case 'visit': return [name, () => new VisitScreen(this, route.visit)];
      case 'end': return [name, () => new EndScreen(this, route.visit)];
      case 'settings': return [name, () => new SettingsScreen(this)];
    }
  }

  private refreshBars(): void {
    const t = texts(), { clinic, bars } = this;
    const { visit, silentSince, stage } = clinic;
    const waits = clinic.outbox.waiting;
    const at = document.body.dataset.screen;
    const silent = silentSince === undefined ? '' : fill(t.silentSince, { at: clock(silentSince) }) + (waits > 0 ? ` ${fill(t.waiting, { n: waits })}` : '');
    bars.records.hidden = silent === '';
    const offer = silent !== '' && !visit && at !== 'alone';
    if (this.changes.records.of(silent, offer)) bars.records.replaceChildren(h('span', {}, silent), offer ? button(t.alone.begin, 'to-alone', () => this.go({ at: 'alone' }), 'small') : '');
    if (clinic.cameBack && stage === 'in') {
      clinic.cameBack = false;
      if (waits === 0 && this.message.words === '') this.message = { words: t.answerAgain, bad: false };
    }
    bars.told.hidden = this.message.words === '';
    bars.told.className = this.message.bad ? 'notice bad' : 'notice';
    if (this.changes.told.of(this.message.words, t.close)) bars.told.replaceChildren(h('span', {}, this.message.words), button(t.close, 'close-told', () => this.showMessage(''), 'small'));
    if (!this.changes.nav.of(stage, at, visit?.id, clinic.tile, this.door, t.title)) return;
    bars.nav.setAttribute('aria-label', t.places);
    bars.nav.replaceChildren(...this.places());
  }

  /** Links to the other screens, and the account that works. */
  private places(): Node[] {
    const t = texts(), { clinic } = this;
    const { visit, stage, tile } = clinic;
    const at = document.body.dataset.screen;
    const to = (words: string, test: string, route: Route, here: boolean): HTMLElement =>
      h('a', { class: 'b place', href: hashOf(route), 'data-testid': test, ...(here ? { 'aria-current': 'page' } : {}) }, words);
    if (stage !== 'in') {
      const open = visit !== null && isOpen(visit);
      return [...(open && at === 'visit' ? [button(stage === 'locked' ? t.unlock.open : t.names.show, 'show-names', () => { this.door = true; this.update(); }, 'place')] : []),
        ...(open && at !== 'visit' && stage !== 'absent' ? [button(t.backToVisit, 'back-to-visit', () => { this.door = false; this.update(); }, 'place')] : [])];
    }
    return [
      to(t.patients.title, 'to-patients', { at: 'patients' }, at === 'patients'),
      ...(visit ? [to(t.visitOpen, 'to-visit', { at: 'visit', visit: visit.id }, at === 'visit')] : []),
      to(t.settings.title, 'to-settings', { at: 'settings' }, at === 'settings'),
      h('span', { class: 'chip' }, h('i', { style: inColour(tile?.colour) }), tile?.name ?? ''),
      button(t.names.hide, 'hide-names', () => clinic.hide(), 'place'),
    ];
  }

  /** Shows text that the records will never accept, so that it can be entered again. */
  private refuseKept(body: Readonly<Record<string, unknown>>, problem: unknown): void {
    const words = typeof body.text === 'string' && body.text !== '' ? ` “${body.text.slice(0, 200)}”` : '';
    this.showMessage(`${problemWords(problem)}${words}`, true);
  }
}

/** The screen of a station without records, or before their first answer. */
function notYet(stage: 'looking' | 'without'): Screen {
  const t = texts().stages[stage];
  return { element: h('main', { class: 'gate' }, h('section', { class: 'panel narrow', 'data-testid': stage }, h('h2', {}, t.title), h('p', {}, t.words), stage === 'looking' ? null : h('p', {}, h('a', { href: '/console' }, texts().console)))) };
}
