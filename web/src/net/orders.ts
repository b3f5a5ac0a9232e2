// The orders of a page, as methods and as bytes.
import * as flatbuffers from 'flatbuffers';
import {
  Act, ActionT, AimT, AnswerT, ArmT, CommandT, EmergencyStopT, HeartbeatT, Help, HoldToMoveT, LoadExerciseT, LoadProfileT, Message, MessageT, Order,
  Payload, ReleaseControlsT, RestT, SaveProfileT, SCHEMA_VERSION, SetHelpT, SetParameterT, type Steering, SteerT, StopT, TakeControlsT,
} from '../protocol';
import type { Answer } from './pending_answers';

export type AnyOrder =
  | ArmT | StopT | EmergencyStopT | LoadExerciseT | SetParameterT | AimT | SteerT | ActionT
  | TakeControlsT | ReleaseControlsT | HeartbeatT | RestT | SaveProfileT | LoadProfileT | SetHelpT | AnswerT | HoldToMoveT;

const ORDER_OF = new Map<unknown, Order>([
  [ArmT, Order.Arm], [StopT, Order.Stop], [EmergencyStopT, Order.EmergencyStop],
  [LoadExerciseT, Order.LoadExercise], [SetParameterT, Order.SetParameter], [AimT, Order.Aim],
  [SteerT, Order.Steer], [ActionT, Order.Action], [TakeControlsT, Order.TakeControls],
  [ReleaseControlsT, Order.ReleaseControls], [HeartbeatT, Order.Heartbeat], [RestT, Order.Rest],
  [SaveProfileT, Order.SaveProfile], [LoadProfileT, Order.LoadProfile], [SetHelpT, Order.SetHelp],
  [AnswerT, Order.Answer], [HoldToMoveT, Order.HoldToMove],
]);

/** The bytes of a command, as the program reads them. */
export function encodeCommand(id: number, order: AnyOrder): Uint8Array<ArrayBuffer> {
  const kind = ORDER_OF.get(order.constructor) ?? Order.NONE;
  const builder = new flatbuffers.Builder(256);
  const message = new MessageT(SCHEMA_VERSION, Payload.Command, new CommandT(id, kind, order));
  Message.finishMessageBuffer(builder, message.pack(builder));
  return builder.asUint8Array().slice();
}

/** The orders that a page may send, except those of the controls. */
export abstract class Orders {
  /** Sends an order; never rejects. */
  abstract order(order: AnyOrder): Promise<Answer>;

  /** The newest number of the person, hand, level and limits that the program has shown (WorldState.basis). */
  abstract readonly basis: number;

  /** @param endingsSeen, basisSeen the values of `endings` and `basis` when the pressed button was shown */
  arm(endingsSeen: number, basisSeen: number): Promise<Answer> { return this.order(new ArmT(endingsSeen, basisSeen)); }
  /** Ends the session gently. The button Stop sends SocketConnection.emergencyStop() (connection.ts) instead. */
  stop(): Promise<Answer> { return this.order(new StopT()); }
  /** A gentle stop that the same page may end by arming again. */
  rest(): Promise<Answer> { return this.order(new RestT()); }
  /** Empty names and level 0 leave that part unchanged. */
  loadExercise(exercise: string, level: number, hand: string): Promise<Answer> {
    return this.order(new LoadExerciseT(exercise, level, hand));
  }
  /** Saves the loaded and set values as a patient's profile; opens a saved one while nothing is armed. */
  saveProfile(name: string): Promise<Answer> { return this.order(new SaveProfileT(name)); }
  loadProfile(name: string): Promise<Answer> { return this.order(new LoadProfileT(name)); }
  /** Sets how much the game helps the player; Unspecified: the player chooses. */
  setHelp(help: Help): Promise<Answer> { return this.order(new SetHelpT(help)); }
  setParameter(name: string, value: number): Promise<Answer> { return this.order(new SetParameterT(name, value, this.basis)); }
  /** The posture that the person intends, one value per axis of the scene [m or rad]. @param by how much of it the page does for them */
  aim(q: number[], by = Help.Unspecified): Promise<Answer> { return this.order(new AimT(q, by)); }
  steer(by: Steering): Promise<Answer> { return this.order(new SteerT(by)); }
  act(act: Act): Promise<Answer> { return this.order(new ActionT(act, this.basis)); }
  /** Answers an exercise that compares: the first or the second was more. */
  choose(chosen: 1 | 2): Promise<Answer> { return this.order(new ActionT(Act.Next, this.basis, chosen)); }
  /** Answers a question of a commissioning, by its number. */
  answer(question: number, words: string): Promise<Answer> { return this.order(new AnswerT(question, words)); }
  /** Reports whether the hold button is held; a commissioning moves nothing without it. */
  holdToMove(press: number, held: boolean): Promise<Answer> { return this.order(new HoldToMoveT(press, held)); }
}
