// The orders of a page, as methods and as bytes.
import * as flatbuffers from 'flatbuffers';
import {
  type Act, ActionT, AimT, AnswerT, ArmT, CommandT, EmergencyStopT, HeartbeatT, Help, HoldToMoveT, LoadExerciseT, LoadProfileT, Message, MessageT, Order,
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

/** Bytes of a command, as the program reads them. */
export function encodeCommand(id: number, order: AnyOrder): Uint8Array<ArrayBuffer> {
  const kind = ORDER_OF.get(order.constructor) ?? Order.NONE;
  const builder = new flatbuffers.Builder(256);
  const message = new MessageT(SCHEMA_VERSION, Payload.Command, new CommandT(id, kind, order));
  Message.finishMessageBuffer(builder, message.pack(builder));
  return builder.asUint8Array().slice();
}

/** The orders that a page may give, but for those of the controls. */
export abstract class Orders {
  /** Sends an order; never rejects. */
  abstract order(order: AnyOrder): Promise<Answer>;

  /** `endingsSeen`: what `endings` was when the person was shown what they pressed on. */
  arm(endingsSeen: number): Promise<Answer> { return this.order(new ArmT(endingsSeen)); }
  stop(): Promise<Answer> { return this.order(new StopT()); }
  /** A gentle stop that the same page may end by arming again. */
  rest(): Promise<Answer> { return this.order(new RestT()); }
  /** Empty names and level 0 leave that part as it is. */
  loadExercise(exercise: string, level: number, hand: string): Promise<Answer> {
    return this.order(new LoadExerciseT(exercise, level, hand));
  }
  /** Saves what is loaded and set now as a patient's profile; opens a saved one while nothing is armed. */
  saveProfile(name: string): Promise<Answer> { return this.order(new SaveProfileT(name)); }
  loadProfile(name: string): Promise<Answer> { return this.order(new LoadProfileT(name)); }
  /** Sets how much the game does for the player; Unsaid: the player chooses. */
  setHelp(help: Help): Promise<Answer> { return this.order(new SetHelpT(help)); }
  setParameter(name: string, value: number): Promise<Answer> { return this.order(new SetParameterT(name, value)); }
  /** Where the person wants to be, one value per axis of the scene [m or rad]. `by`: how much of it the page does for them. */
  aim(q: number[], by = Help.Unsaid): Promise<Answer> { return this.order(new AimT(q, by)); }
  steer(by: Steering): Promise<Answer> { return this.order(new SteerT(by)); }
  act(act: Act): Promise<Answer> { return this.order(new ActionT(act)); }
  /** Answers a question of a commissioning, by its number. */
  answer(question: number, words: string): Promise<Answer> { return this.order(new AnswerT(question, words)); }
  /** Reports whether the button is held without which a commissioning moves nothing. */
  holdToMove(press: number, held: boolean): Promise<Answer> { return this.order(new HoldToMoveT(press, held)); }
}
