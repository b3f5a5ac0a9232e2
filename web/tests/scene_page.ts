// A page with only the scene, for pictures and measurements: "npm run dev", then
//   /tests/scene_page.html?at=pour&level=3&quality=high&tone=honey&ghost&colliders&plain&check
// Options of the stand-in program (fake/fake_program.ts) work too. window.scene is the scene,
// window.ready counts frames, window.check has the skin's positions on the graphics card.

import type { PerspectiveCamera } from 'three';
import '../src/shared/tokens.css';
import { FakeProgram } from '../fake/fake_program';
import type { SceneT, WorldStateT } from '../src/protocol';
import { DOOR, DRAWER, PUT, kitchenScene, kitchenState } from './kitchen_scene';
import { checkOnCard } from './scene_gpu_check';
import { SceneView } from '../src/scene/scene_view';
import type { Quality } from '../src/scene/quality';

// dump=ADDRESS, with step=: a scene and its states as JSON ({ scene, states }), like window.wholehandNow of the console.
const options = new URLSearchParams(location.search);
const program = new FakeProgram(options) as unknown as { advance(dt: number): void; scene(): SceneT; state(): WorldStateT };
const quality = (options.get('quality') ?? 'high') as Quality;

await document.fonts.load('700 40px "Atkinson Hyperlegible Next Variable"');
const scene = new SceneView(document.getElementById('scene') as HTMLCanvasElement, {
  quality, tone: options.get('tone') ?? 'honey', view: options.get('view') === 'console' ? 'console' : 'game' });
const reported = program.scene();
// kitchen=drawer, door or put, with step= and q=: a synthetic kitchen task around the stand-in's hand.
const task = { drawer: DRAWER, door: DOOR, put: PUT }[options.get('kitchen') ?? ''];
if (task) {
  const { exerciseJson, bodies, valueNames } = kitchenScene(task), take = program.state.bind(program);
  Object.assign(reported, { exerciseJson, bodies, valueNames });
  program.state = () => {
    const { values, bodies: poses } = kitchenState({ instruction: Number(options.get('step') ?? 0), joint_q: Number(options.get('q') ?? 0), held_s: Number(options.get('held') ?? 0), handle_n: Number(options.get('force') ?? 0) }, task);
    return Object.assign(take(), { values, bodies: poses, contacts: [] });
  };
}
if (options.has('dump')) {
  const { scene: dumped, states } = await (await fetch(options.get('dump')!)).json() as { scene: SceneT; states: WorldStateT[] };
  Object.assign(reported, dumped);
  program.state = () => states[Number(options.get('step') ?? 0)]!;
}
if (options.has('plain')) reported.exerciseJson = '';
scene.setScene(reported);
scene.setLook({ ghostHand: options.has('ghost'), grey: options.has('ghost'), showColliders: options.has('colliders') });

if (options.has('zoom')) {   // x, y of the middle in px of 1280 × 800, and the magnification
  const [x, y, more] = options.get('zoom')!.split(',').map(Number);
  const place = scene.resize.bind(scene), { camera } = scene as unknown as { camera: PerspectiveCamera };
  scene.resize = () => {
    place();
    const v = camera.view!;
    camera.setViewOffset(v.fullWidth, v.fullHeight, v.offsetX + x - 640 / more, v.offsetY + y - 400 / more, v.width / more, v.height / more);
  };
  scene.resize();
}

const page = window as unknown as { scene: SceneView; ready: number; check?: ReturnType<typeof checkOnCard> };
if (options.has('check')) page.check = checkOnCard(reported, program.state(), 2e-3);
page.scene = scene;
page.ready = 0;
const still = options.has('still');
scene.setState(program.state());
let last_ms = performance.now(), clock_ms = 0;
const frame = (now_ms: number) => {
  if (!still) {
    program.advance(Math.min(0.1, (now_ms - last_ms) / 1000));
    scene.setState(program.state());
  }
  last_ms = now_ms;
  // A still picture also needs time, until low-passed values have settled.
  clock_ms = still ? clock_ms + 200 : now_ms;
  scene.render(clock_ms);
  if (scene.whole) page.ready += 1;
  if (!still || page.ready < 6) requestAnimationFrame(frame);
};
requestAnimationFrame(frame);
