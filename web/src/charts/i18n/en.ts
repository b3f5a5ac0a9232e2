/** Everything a page of charts says. The other languages have the same shape. */
export const en = {
  charts: 'Charts', print: 'Print',
  /** What the program names in a page (src/page/chart_page.hpp). */
  sentences: {
    axis: '{axes}', stage: '{stage}',
    'certificate.certified': '{device} with {rendering}, {hand}: certified',
    'certificate.notCertified': '{device} with {rendering}, {hand}: NOT certified',
    'certificate.walls': 'With the walls of {exercise}.',
    'certificate.note': 'Z-width: largest stiffness (logarithmic) against the adaptive damping Φ K_dm at {rate} Hz. Thick: where the axis works, Φ from 0 to 1. It must stay below every line.',
    'certificate.chart': '{axes}: K_pm in {unit}',
    'certificate.rigid': 'rigid stop', 'certificate.passive': 'any person', 'certificate.quantisation': 'quantisation', 'certificate.wall': 'in the wall',
    'certificate.working': 'this axis', 'certificate.fails': 'FAILS',
    'impedance.title': 'What the person feels: {device} with {rendering} and {hand}',
    'impedance.note': 'Impedance Z, effort over velocity, at {rate} Hz. It rises by 20 dB a decade with +90° like a mass, falls with −90° like a spring, and is level at 0° like a damper. Shaded: where prediction and measurement are compared.',
    'impedance.magnitude': '{axes}: |Z| in dB of 1 {unit}', 'impedance.phase': 'phase in degrees',
    'impedance.free': 'free', 'impedance.spring': 'spring of {stiffness} N/m at the hand', 'impedance.rigid': 'rigid stop',
    'impedance.undamped': 'Φ = 0: no adaptive damping', 'impedance.damped': 'Φ = 1: all of it', 'impedance.measured': 'measured (lines: predicted)',
    'exercise.title': 'What the hand felt at the cocktail bar',
    'exercise.bumps': '① bumps into it', 'exercise.approaches': '② approaches', 'exercise.squeezes': '③ squeezes', 'exercise.letsGo': '④ lets go, retrieves',
    'exercise.fingers': 'Fingers, N at the tips', 'exercise.thumb': 'Thumb, N at the tip (turn in 0.1 Nm)', 'exercise.arm': 'Arm, N', 'exercise.phi': 'Adaptive damping φ',
    'exercise.alpha': 'Transition α of the exercise’s haptics', 'exercise.flow': 'Flow, ml/s', 'exercise.glass': 'In the glass, ml', 'exercise.wall': 'wall', 'exercise.asked': 'asked: {ml}',
    'grasping.title': 'Grasp, carry 20 cm, hold for 10 s', 'grasping.chart': 'Slip during the hold: share of the trials that slip no further',
    'grasping.asked': 'asked: 0.5 mm', 'grasping.tuned': 'tuned', 'grasping.jittered': 'jittered',
    'timing.title': 'Time per tick, {ticks} ticks', 'timing.chart': 'Ticks by their time on the wall clock', 'timing.mark': '{name}: {us} µs', 'timing.deadline': 'deadline: 1 ms',
    'timing.table': 'Times, µs', 'timing.what': 'What', 'timing.most': 'largest', 'timing.cpu': 'tick, processor', 'timing.wall': 'tick, wall clock',
    'passport.title': '{device}, serial number {serial}', 'passport.measured': 'Measured {day} by {operator}.',
    'passport.note': 'Bar: where the figure lies, as a share of the number in the device file, which stands at the line. The scale ends at twice that number.',
    'passport.figure': 'Figure', 'passport.share': 'Share of the file’s number', 'passport.interval': 'Measured', 'passport.file': 'File', 'passport.between': '{low} to {high} {unit}',
    'passport.mass': 'mass', 'passport.inertia': 'inertia', 'passport.damping': 'damping', 'passport.friction': 'dry friction', 'passport.delay': 'delay',
  },
  problems: {
    template: 'This page carries no charts. The program writes them, for example: wholehand certify --charts charts.html',
    broken: 'The data of this page cannot be read. Please make it again.', says: 'The reason:',
  },
};
export type ChartTexts = typeof en;
