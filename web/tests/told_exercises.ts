// What the program told a page in every exercise, for both hands (fixtures/record_exercises.ts).
import { readFileSync } from 'node:fs';
import { resolve } from 'node:path';
import { gunzipSync } from 'node:zlib';
import { readMessage } from '../src/net/read_message';
import type { SceneT, WorldStateT } from '../src/protocol';

/** A scene, the state before arming, and states of the virtual patient's play. Messages as the program sent them. */
export interface ToldExercise { readonly name: string; readonly right: boolean; readonly scene: SceneT; readonly states: readonly WorldStateT[]; readonly messages: readonly ArrayBuffer[] }

export function toldExercises(): ToldExercise[] {
  const bytes = gunzipSync(readFileSync(resolve(__dirname, 'fixtures/exercises.bin.gz')));
  const all: { scene: SceneT; states: WorldStateT[]; messages: ArrayBuffer[] }[] = [];
  for (let at = 0; at < bytes.length;) {
    const length = bytes.readUInt32LE(at), message = new Uint8Array(bytes.subarray(at + 4, at + 4 + length)).buffer;
    at += 4 + length;
    const { is, value } = readMessage(message) as { is: string; value: unknown };
    if (is === 'scene') all.push({ scene: value as SceneT, states: [], messages: [] });
    const one = all.at(-1)!;
    one.messages.push(message);
    if (is === 'state') one.states.push(value as WorldStateT);
  }
  return all.map((one) => ({ ...one, name: String(one.scene.exerciseName), right: one.scene.rightHand }));
}
