import type { Way } from '../wish';

/** One line of help: the keys, and their effect. */
export interface HelpLine { keys: string[]; does: string }

export interface InputTexts {
  ways: Record<Way, string>;
  help: Record<Way, HelpLine[]>;
  /** The single press, where an exercise does the rest with full help. */
  oneButton: Partial<Record<Way, string>>;
  /** How to end a squeeze that is held. */
  letGo: Record<Way, string>;
  /** How to squeeze without help. */
  hold: Record<Way, string>;
  touch: { squeeze: string; higher: string; lower: string };
  webcam: Record<'insecure' | 'refused' | 'absent' | 'busy' | 'model' | 'ended', string>;
  /** Texts while the camera is on: before it steers, and during play. */
  camera: Record<'ask' | 'askMore' | 'load' | 'loadMore' | 'frame' | 'frameMore' | 'noHand' | 'noHandMore' | 'otherWay' | 'again', string>;
}

export const en: InputTexts = {
  ways: { keys: 'Keys', mouse: 'Mouse', touch: 'Touch', gamepad: 'Game pad', webcam: 'Camera' },
  help: {
    keys: [
      { keys: ['↑', '↓', 'W', 'S'], does: 'away from you, towards you' },
      { keys: ['←', '→', 'A', 'D'], does: 'left, right' },
      { keys: ['R', 'F', 'Page ↑', 'Page ↓'], does: 'up, down' },
      { keys: ['Space'], does: 'hold to squeeze, let go to open' },
    ],
    mouse: [
      { keys: ['Move'], does: 'left, right, up, down' },
      { keys: ['Wheel'], does: 'away from you, towards you' },
      { keys: ['Left button'], does: 'hold to squeeze, let go to open' },
    ],
    touch: [
      { keys: ['Drag'], does: 'left, right; up is away from you' },
      { keys: ['Second finger', 'Squeeze'], does: 'hold to squeeze, let go to open' },
      { keys: ['Higher', 'Lower'], does: 'up, down' },
    ],
    gamepad: [
      { keys: ['Left stick'], does: 'left, right, away, towards you' },
      { keys: ['Right stick'], does: 'up, down' },
      { keys: ['Trigger', 'A'], does: 'squeeze, as far as it is pulled' },
    ],
    webcam: [
      { keys: ['Hand'], does: 'move it before the camera; nearer to the camera is away from you' },
      { keys: ['Fist'], does: 'close your hand to squeeze, open it to let go' },
    ],
  },
  oneButton: { keys: 'Space', mouse: 'Click', touch: 'Tap', gamepad: 'A' },
  letGo: { keys: 'Let go of the space bar', mouse: 'Let go of the mouse button', touch: 'Lift the finger that squeezes', gamepad: 'Let go of the trigger', webcam: 'Open your hand' },
  hold: { keys: 'Here, hold the space bar to squeeze', mouse: 'Here, hold the button to squeeze', touch: 'Here, hold “Squeeze” to squeeze', gamepad: 'Here, hold the trigger to squeeze', webcam: 'Here, make a fist to squeeze' },
  touch: { squeeze: 'Squeeze', higher: 'Higher', lower: 'Lower' },
  webcam: {
    insecure: 'The browser gives no camera here. Open this page by https or on this computer itself.',
    refused: 'The camera was refused. Allow it in the browser’s address bar, then try again.',
    absent: 'No camera was found. Connect one, or play with keys or mouse.',
    busy: 'The camera did not start. Another program may be using it.',
    model: 'Hand tracking could not be loaded. Play with keys or mouse.',
    ended: 'The camera has stopped. Play with keys or mouse, or start it again.',
  },
  camera: {
    ask: 'Allow the camera',
    askMore: 'Your browser asks for it. The picture stays on this computer.',
    load: 'One moment …',
    loadMore: 'The camera is getting ready.',
    frame: 'Keep your hand in the frame',
    frameMore: 'Hold it open and still. Then it steers the hand in the exercise.',
    noHand: 'No hand is seen',
    noHandMore: 'Hold your open hand before the camera.',
    otherWay: 'Play another way',
    again: 'Start the camera',
  },
};
