// The data of a report: parsing, and texts on the therapy.
import { deflateSync } from 'node:zlib';
import { describe, expect, it, vi } from 'vitest';
import { pageData, unpackBytes, type Json } from '../src/embedded/page_data';
import { FakeRecordings } from '../fake/fake_recordings';
import { ReplaySide } from '../src/replay/side';
import { asProblem } from '../src/replay/problem';
import { titleWords } from '../src/console/title_words';
import { rangeOf } from '../src/charts/chart_range';
import { EmbeddedRecording, EmbeddedStates } from '../src/report/embedded_recording';
import { comparedWith, compareWithBefore, figuresOf, type Figure } from '../src/report/figures';
import { axesOfOne, differencesBetween } from '../src/replay/differences';
import { de } from '../src/report/i18n/de';
import { en } from '../src/report/i18n/en';
import { fr } from '../src/report/i18n/fr';
import { stepTimes, valueAt } from '../src/report/limits';
import { barOf } from '../src/exercises/cocktail_bar/bar';
import { barReport, drinkOf } from '../src/exercises/cocktail_bar/report';
import { labelOf } from '../src/exercises/panel';
import { BodyBudgetT, GameBodiesT, GameBodyT, GameShapesT, PanelT, PanelValueT, SceneT, ShapeT, ShapeType, SlotState, WordsT } from '../src/protocol';
import { setLanguage } from '../src/shared/i18n';
import { signWords } from '../src/report/sheet';
import { GivenHelp, Mover, readReport, type Attribution } from '../src/report/report_data';
import { sharePercent, marksByKind, whoseWords } from '../src/report/therapy';

const packed = (bytes: Uint8Array): string => Buffer.from(deflateSync(bytes)).toString('base64');

/** The data that src/replay/recording_report.cpp writes, from the stand-in's recording. */
async function carried(options = '', changes: Record<string, unknown> = {}, fake = new FakeRecordings(new URLSearchParams(`length=6&${options}`))): Promise<Json> {
  const ask = async (what: string): Promise<Response> => fake.answer(`/api/recordings/a.h5/replay/${what}`);
  const rows = [0, 100, 200, 300, fake.rows - 1];
  const states: Uint8Array[] = [];
  for (const row of rows) states.push(new Uint8Array(await (await ask(`states?tick=${row}&count=1&step=1`)).arrayBuffer()));
  const scene = await ask('scene');
  return {
    page: 'report', version: 1, about: await (await ask('about')).json(),
    series: packed(new Uint8Array(await (await ask('series?from_s=-0.0005&to_s=5.9995&columns=300')).arrayBuffer())),
    ...(fake.scene.budget ? { bodies: packed(new Uint8Array(await (await ask('bodies')).arrayBuffer())) } : {}),
    ...(scene.ok ? { scene: packed(new Uint8Array(await scene.arrayBuffer())), states: { rows, messages: packed(Buffer.concat(states)) } } : {}),
    therapy: THERAPY,
    engineering: { times: { counts: [1, 2] }, settings: { engine: 'bullet' } },
    ...changes,
  };
}

/** Figures of a person, as src/replay/therapy_facts.cpp writes them. */
const THERAPY = {
  moved: { by: [0, 5000, 1000, 0], helped: [0, 5000, 0, 0], share: 5 / 6, runs: [[0, 1, 2], [1, 6, 1]], runs_left_out: 0 },
  parts: [
    { event: 'drink_done', index: 0, value: 97, from_s: 0.2, to_s: 0.9, stars: 3, steps: [[0, 0.04]], by: 2, share: 0, help: 0, persons: false },
    { event: 'drink_done', index: 0, value: 91, from_s: 1.5, to_s: 5, stars: 3, steps: [[0, 0.041]], by: 1, share: 1, help: 1, persons: true },
  ],
  parts_left_out: 0, sums: { drink_done: { count: 1, shared: 0, others: 1, value: 91, stars: 3, helps: [0, 1, 0, 0] }, level_done: { count: 0, shared: 1, others: 0, value: 0, stars: 0, helps: [0, 0, 0, 0] } },
  reaches: { count: 2, shared: 1, others: 1, sum_s: 5 },
  results: [{ name: 'poured_total_l', label: 'Poured', unit: 'ml', value: 41, decimals: 0 }, { name: 'score', label: 'Score', unit: '', value: null, decimals: 0 }],
  bodies: [], bodies_in_scene: 0, touches: [], touches_left_out: 0, touches_not_persons: 4, grips: { count: 1, shared: 0, others: 2, mean_n: 2.5, variation: 0.1 },
  has_grip_force: true, limits: [[[0, 20]]], limits_between_s: 0.1, largest_force_n: 0, strongest: { force_n: 0, time_s: 0, by: 0 },
};

const kindOf = async (data: Json): Promise<string> => readReport(data).then(() => 'none', (thrown: unknown) => asProblem(thrown).kind);

describe('the data in a page', () => {
  const page = (text: string | null): Document => ({ querySelector: () => (text === null ? null : { textContent: text }) }) as unknown as Document;

  it('is an object; a template has none; a truncated file is recognized', () => {
    expect(pageData(page('{"page":"report"}'))).toEqual({ page: 'report' });
    for (const text of ['"wholehand-page-data"', '[]', 'null']) expect(pageData(page(text))).toBeNull();
    for (const text of ['{"page":"rep', '', null]) expect(() => pageData(page(text))).toThrow(SyntaxError);
  });

  it('contains bytes as packed by packBytes()', async () => {
    // python3 -c "import zlib, base64; print(base64.b64encode(zlib.compress(b'wholehand', 9)))", as in page_file_test.cpp
    expect(new TextDecoder().decode(await unpackBytes('eNorz8jPSc1IzEsBABMFA7s='))).toBe('wholehand');
  });
});

describe('a report', () => {
  it('contains the recording like the program\'s answers', async () => {
    const data = await readReport(await carried());
    const fake = new FakeRecordings(new URLSearchParams('length=6'));
    expect(data.about).toMatchObject({ name: 'a.h5', ticks: 6000, exercise: 'cocktail-bar' });
    expect(data.scene?.axes).toHaveLength(fake.scene.axes.length);
    expect([data.states.length, data.series.columns, data.therapy.limits[0]]).toEqual([5, 300, [[0, 20]]]);
  });

  it('shows the nearest available state, and states its time', async () => {
    const fake = new FakeRecordings(new URLSearchParams('length=6'));
    const side = await ReplaySide.open(new EmbeddedRecording(await readReport(await carried())));
    expect(side.seek(0.13, { from_s: 0, to_s: 6 }, false, 1)).toBe(true);
    expect([side.wanted, side.shown]).toEqual([100, 100]);
    expect(side.state?.qM[3]).toBeCloseTo(fake.state(100).qM[3], 6);
    expect(side.seek(0.19, { from_s: 0, to_s: 6 }, false, 1)).toBe(true);
    expect(side.shown).toBe(200);
    side.look({ from_s: 0, to_s: 6 });
    expect(side.series.overview()).toHaveLength(1);
  });

  it('has bodies of a game at its states', async () => {
    const fake = new FakeRecordings(new URLSearchParams('length=6'));
    const ball = new GameShapesT(7, null, [new ShapeT(ShapeType.Sphere, null, 0.03)]);
    fake.scene.budget = new BodyBudgetT(64, 24);
    fake.bodies = [{ row: 100, reported: new GameBodiesT(1, [new GameBodyT(2, 1, 7, SlotState.Ghost)], [ball]) }, { row: 300, reported: new GameBodiesT(1, []) }];
    const side = await ReplaySide.open(new EmbeddedRecording(await readReport(await carried('', {}, fake))));
    await vi.waitFor(() => expect(side.fresh).toBe(true));
    const at = (time_s: number) => { side.seek(time_s, { from_s: 0, to_s: 6 }, false, 1); return side.bodies.map(({ slot, ghost, shapes }) => [slot, ghost, shapes.length]); };
    expect([at(0), at(0.1), at(0.2), at(0.3)]).toEqual([[], [[2, true, 1]], [[2, true, 1]], []]);
  });

  it('without a scene has no picture, and is shown', async () => {
    const data = await readReport(await carried('nopicture'));
    expect([data.scene, data.states]).toEqual([undefined, []]);
    const side = await ReplaySide.open(new EmbeddedRecording(data));
    expect([side.hasScene, side.seek(1, { from_s: 0, to_s: 6 }, false, 1)]).toEqual([false, false]);
  });

  it.each<[string, Record<string, unknown>]>([
    ['of another page', { page: 'certificate' }], ['of a newer program', { version: 2 }], ['without what it is', { about: null }], ['without series', { series: undefined }],
    ['with bytes that are none', { series: '###' }], ['with bytes that are cut', { series: packed(new Uint8Array([1, 2])) }],
    ['with states of other rows', { states: { rows: [1], messages: packed(new Uint8Array(0)) } }], ['with bodies of a game that are cut', { bodies: packed(new Uint8Array([1, 0, 0, 0, 9])) }], ['with a scene that is none', { scene: packed(new Uint8Array(40)) }],
  ])('%s is refused', async (_what, changes) => { expect(await kindOf(await carried('', changes))).toBe('nonsense'); });

  it('without figures is shown without them', async () => {
    const data = await readReport(await carried('', { therapy: undefined, engineering: 'x' }));
    expect([data.therapy.bodies, data.engineering.faults, data.engineering.times.counts]).toEqual([[], [], []]);
  });
});

describe('states in a page', () => {
  const states = new EmbeddedStates([0, 10, 20, 35], [new Uint8Array(0), new Uint8Array(0), new Uint8Array(0), new Uint8Array(0)]);

  it.each([[-5, 0], [4, 0], [5, 0], [6, 10], [27, 20], [28, 35], [1000, 35]])('have for row %d the nearest one %d', (row, nearest) => { expect(states.existing(row)).toBe(nearest); });
  it('are stepped through one by one, to the ends', () => {
    expect([states.stepped(10, 1), states.stepped(10, -1), states.stepped(35, 1), states.stepped(0, -100)]).toEqual([20, 0, 35, 0]);
  });
});

describe('the therapy', () => {
  const whose = (by: Mover, share: number, help: GivenHelp, persons = share === 1): Attribution => ({ by, share, help, persons });

  it('states whose a part is, and with how much help', () => {
    vi.stubGlobal('document', { documentElement: {} });
    setLanguage('en');
    expect([
      whose(Mover.Person, 1, GivenHelp.Full), whose(Mover.Person, 1, GivenHelp.None), whose(Mover.Person, 1, GivenHelp.Unspecified),
      whose(Mover.VirtualPatient, 0, GivenHelp.Unspecified), whose(Mover.Motion, 0, GivenHelp.Unspecified), whose(Mover.Person, 0.634, GivenHelp.Full),
    ].map(whoseWords)).toEqual(['with full help', 'without help', 'the person’s', 'shown by the virtual patient', 'shown by a replayed motion', 'shared, 63.4 % the person’s']);
    vi.unstubAllGlobals();
  });

  it('never shows a share as 100 % while a tick is missing in it', () => {
    expect([1, 0.9999999, 0.5, 0].map(sharePercent)).toEqual(['100.0', '99.9', '50.0', '0.0']);
  });

  it('counts only the person\'s actions', async () => {
    const figures = figuresOf(await readReport(await carried()));
    expect(figures.map(({ key, shown, unit }) => [key, shown, unit])).toEqual([
      ['drinks', '1', ''], ['levels', '0', ''], ['result/poured_total_l', '41', 'ml'], ['result/score', '–', ''], ['reach', '2.5', 's'], ['grip', '2.5', 'N'], ['steadiness', '10', '%'], ['stars', '★ 3', 'of 3'],
    ]);
  });

  it('lists each drink with the poured amounts of its steps, the person’s first', () => {
    const exercise_json = JSON.stringify({ kind: 'cocktail_bar', dispensers: [], drinks: [{ name: 'blush', steps: [{ liquid: 'lemon', amount_l: 0.04 }, { liquid: 'cherry', amount_l: 0.02 }] }] });
    const part = { index: 0, steps: [[0, 0.039], [1, 0.02]] as const };
    expect(drinkOf(part, barOf({ exerciseJson: exercise_json }))).toEqual({
      name: 'blush', steps: [{ liquid: 'lemon', poured_l: 0.039, asked_l: 0.04 }, { liquid: 'cherry', poured_l: 0.02, asked_l: 0.02 }],
    });
    const broken = (drinks: string): string => `{"kind":"cocktail_bar","dispensers":[],"drinks":${drinks}}`;
    for (const json of ['', '{', 'null', broken('7'), broken('[]'), broken('[7]'), broken('[{"steps":"x"}]')]) expect(drinkOf(part, barOf({ exerciseJson: json })).name).toBe('1');
    const rows = barReport.table({ parts: THERAPY.parts.map((one) => ({ ...one, steps: [] })), sums: THERAPY.sums, scene: undefined }, String, ({ persons }) => (persons ? 'person' : 'other'))!.rows;
    expect(rows.map((cells) => cells.slice(3))).toEqual([['91', '5', 'person'], ['97', '0.9', 'other']]);
  });

  it('lists every stop, fault and loss of the controls, and their absence', () => {
    const mark = (kind: 'stop' | 'fault' | 'controls_lost' | 'armed') => ({ time_s: 1, kind, text: '', axis: '' });
    const happened = marksByKind({ marks: [mark('armed'), mark('stop'), mark('fault'), mark('fault'), mark('controls_lost')] });
    expect(happened.map(({ kind, marks }) => [kind, marks.length])).toEqual([['stop', 1], ['emergency_stop', 0], ['fault', 2], ['controls_lost', 1]]);
  });
});

describe('charts', () => {
  it('contain all values, and the required minimum range', () => {
    const line = { name: '', color: '', values: [2, NaN, 4] };
    const [low, high] = rangeOf([line], [0, 1]);
    expect([low, high > 4, high < 5]).toEqual([0, true, true]);
    expect(rangeOf([{ ...line, values: [NaN] }])).toEqual([0, 1]);
  });

  it('draw a limit as steps at each change', () => {
    const limit = [[0, 20], [2, 8]] as const;
    const times = stepTimes([limit, [[0, 5]]], 10);
    expect(times).toEqual([0, 2, 2, 10]);
    expect(times.map((time_s, i) => valueAt(limit, time_s, times[i + 1] === time_s))).toEqual([20, 20, 8, 8]);
  });
});

describe('a result', () => {
  it('has the name of its exercise in the page’s language, in report and replay', () => {
    const scene = Object.assign(new SceneT(), { panel: Object.assign(new PanelT(), { values: [Object.assign(new PanelValueT(), { name: 'held_s', label: Object.assign(new WordsT(), { en: 'Held', de: 'Gehalten', fr: 'Tenu' }) })] }) });
    vi.stubGlobal('document', { documentElement: {} });
    setLanguage('fr');
    expect([labelOf(scene, 'held_s'), labelOf(scene, 'other'), labelOf(null, 'held_s')]).toEqual(['Tenu', '', '']);
    setLanguage('en');
    expect(labelOf(scene, 'held_s')).toBe('Held');
    vi.unstubAllGlobals();
  });
});

describe('signs in the charts', () => {
  it('are explained on the sheet, exactly those that are shown', () => {
    const words = signWords(['②', '①', '②', 'stop', ''].map((label) => ({ label })));
    expect(words).toBe('① the hand touches an object; ② grasped, the wall fades in.');
    expect(signWords([{ label: '③' }])).toMatch(/^③ \S/);   // the exercise's own
    expect(signWords([{ label: 'stop' }, { label: '' }])).toBe('');
  });
});

describe('the texts of the report', () => {
  const keys = (texts: object, path = ''): string[] => Object.entries(texts).flatMap(([key, value]) => (typeof value === 'object' ? keys(value as object, `${path}${key}.`) : [`${path}${key}`]));
  const places = (texts: object): string[] => Object.values(texts).flatMap((value) => (typeof value === 'object' ? places(value as object) : [(String(value).match(/\{\w+\}/g) ?? []).sort().join()]));

  it.each([['German', de], ['French', fr]])('are complete in %s, with the same placeholders', (_name, texts) => {
    expect(keys(texts)).toEqual(keys(en));
    expect(places(texts)).toEqual(places(en));
  });
});

describe('the session before', () => {
  const figure = (key: string, value: number, better?: 'more' | 'less', shown = String(value)): Figure => ({ key, value, shown, unit: '', words: '', better, of: key === 'grip' ? 'grip' : 'exercise' });

  it('is read with its own figures, without earlier sessions', async () => {
    const before = await carried('', { scene: undefined, before: await carried() });
    const data = await readReport(await carried('', { before }));
    expect(data.before?.about.name).toBe('a.h5');
    expect([data.before?.scene, data.before?.before]).toEqual([undefined, undefined]);
    expect(figuresOf(data.before!).find(({ key }) => key === 'result/poured_total_l')).toMatchObject({ shown: '41', value: 41 });
    expect((await readReport(await carried())).before).toBeUndefined();
  });

  it('shows better, worse and equal figures', () => {
    const became = (now: Figure, ...before: Figure[]): string | undefined => comparedWith(now, before, [])?.became;
    expect(became(figure('drinks', 3, 'more'), figure('drinks', 2, 'more'))).toBe('better');
    expect(became(figure('reach', 3, 'less'), figure('reach', 2, 'less'))).toBe('worse');
    expect(became(figure('grip', 3), figure('grip', 2))).toBe('other');
    expect(became(figure('reach', 1.04, 'less', '1.0'), figure('reach', 0.96, 'less', '1.0'))).toBe('same');
    expect(became(figure('reach', 1, 'less'), figure('grip', 1))).toBeUndefined();
  });

  it('is marked for another patient, hand, device, exercise or level', async () => {
    const { about } = await readReport(await carried());
    const other = (changes: Partial<typeof about>): string[] => differencesBetween(about, { ...about, ...changes });
    expect([other({}), other({ patient: 'x', hand: 'y' }), other({ exercise: 'z' }), other({ level: about.level + 1 }), other({ exercise: 'z', level: 0 })])
      .toEqual([[], ['patient', 'hand'], ['exercise'], ['exercise'], ['exercise']]);
  });

  it('compares only comparable figures: results of one exercise, the grip of one hand at one device, and one patient', () => {
    const [score, grip] = [figure('result/score', 90, 'more'), figure('grip', 3, 'more')];
    const became = (...differences: Parameters<typeof comparedWith>[2]): (string | undefined)[] =>
      [score, grip].map((now) => comparedWith(now, [figure('result/score', 80), figure('grip', 2)], differences)?.became);
    expect(became()).toEqual(['better', 'better']);
    expect(became('exercise')).toEqual([undefined, 'better']);
    expect(became('hand')).toEqual(['better', undefined]);
    expect(became('device')).toEqual(['better', undefined]);
    expect(became('patient')).toEqual(['other', 'other']);
    expect(became('exercise', 'device')).toEqual([undefined, undefined]);
  });

  it('shows no figure of another exercise beside one of this', async () => {
    const data = await readReport(await carried('', { before: await carried() }));
    expect(compareWithBefore(data).figures.map(({ compared }) => compared?.became)).toEqual(Array(8).fill('same'));
    const other = { ...data, before: { ...data.before!, about: { ...data.about, exercise: 'squeeze-to-level' } } };
    expect(compareWithBefore(other).differences).toEqual(['exercise']);
    expect(compareWithBefore(other).figures.filter(({ of, compared }) => of === 'exercise' && compared)).toEqual([]);
  });

  it('names the axes that only one device has', () => {
    const axes = (...names: string[]): { name: string }[] => names.map((name) => ({ name }));
    expect(axesOfOne(axes('x', 'y'), axes('y', 'yaw'))).toEqual(['x', 'yaw']);
    expect(axesOfOne(axes('x'), axes('x'))).toEqual([]);
  });
});

describe('titles of recordings', () => {
  it('of an exercise are translated, all others unchanged', () => {
    expect(titleWords('cocktail-bar, level 1 of 4', 'f.h5')).toBe('Cocktail bar, Level 1');
    expect(titleWords('squeeze-to-level, level 2', 'f.h5')).toBe('Squeeze to a level, Level 2');
    expect(titleWords('my-exercise, level 1', 'f.h5')).toBe('My exercise, Level 1');
    expect(titleWords('my-exercise, level 2 of 3', 'f.h5', 'Ma tâche')).toBe('Ma tâche, Level 2');
    for (const own of ['محمد علي', '<b>x</b>', 'x'.repeat(10_000)]) expect(titleWords(own, 'f.h5')).toBe(own);
    expect(titleWords('', 'f.h5')).toBe('f.h5');
  });
});
