// What a page may order, as bytes.
import * as flatbuffers from 'flatbuffers';
import {
  ActionT, AimT, AnswerT, ArmT, CommandT, EmergencyStopT, HeartbeatT, HoldToMoveT, LoadExerciseT, LoadProfileT, Message, MessageT, Order, Payload, ReleaseControlsT,
  RestT, SaveProfileT, SCHEMA_VERSION, SetHelpT, SetParameterT, SteerT, StopT, TakeControlsT,
} from '../protocol';

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
