// Texts of squeezing to a level, one on each line; {x} stands for a value that the page fills in.
export const en = {
  'sign.grip': 'Take hold here',
  'sign.open': 'Open your hand',
  'more.grip': 'Close your hand around the blue handle',
  'more.up': 'The balloon rises as you squeeze',
  'more.stay': 'Keep the basket between the two ribbons',
  'more.down': 'The balloon is too high: squeeze a little less',
  'more.open': 'Open your hand: the balloon comes down',
  'more.none': 'All lanterns are lit',
  height: 'Height {n}',
  hold: 'hold {a} s',
  heldOf: '{a} of {b} s',
  count: '{n} of {m} done',
  'oneButton.press': 'press once: your hand lifts the balloon',
  'oneButton.point': 'the handle: your hand lifts the balloon',
  'done.title': 'The whole valley is flying',
  'done.helped': 'Every height was held.',
  'done.effort': 'You held every height.',
  'welcome.lead': 'Your hand lifts a balloon over the valley. Take all the time you need.',
  'welcome.step1': 'Take hold',
  'welcome.step1More': 'Close your hand around the handle.',
  'welcome.step2': 'Squeeze',
  'welcome.step2More': 'The basket rises between the ribbons.',
  'welcome.step3': 'Hold',
  'welcome.step3More': 'Keep it there until the lantern is lit.',
} as const;

export type LevelTexts = Readonly<Record<keyof typeof en, string>>;
