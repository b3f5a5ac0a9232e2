using System;
using System.Collections.Generic;
using System.Linq;
using System.Threading.Tasks;
using FlatBuffers;
using wholehand.protocol;

namespace Wholehand
{
    // Commands. Each task ends with the program's answer, and never in an exception.
    public sealed partial class WholehandClient
    {
        /// <summary>Requests the controls; refused while another client holds them.</summary>
        public Task<CommandReply> TakeControls()
        {
            return Ask(Order.TakeControls, b =>
                wholehand.protocol.TakeControls.CreateTakeControls(b, b.CreateString(options.Token ?? "")).Value);
        }

        public Task<CommandReply> ReleaseControls()
        {
            return Ask(Order.ReleaseControls, b =>
            {
                wholehand.protocol.ReleaseControls.StartReleaseControls(b);
                return wholehand.protocol.ReleaseControls.EndReleaseControls(b).Value;
            });
        }

        /// <summary>Starts rendering. <paramref name="endingsSeen"/> and <paramref name="basisSeen"/> are
        /// HandState.Endings and HandState.Basis as they were shown to the person at the press; refused if anything
        /// was stopped since, if another client changed the person, hand, level or limits, and before the first
        /// state.</summary>
        public Task<CommandReply> Arm(uint endingsSeen, uint basisSeen)
        {
            lock (gate)
            {
                if (connected && !haveState) return Refused("no state has come yet: wait for the first (TryGetState), and give its Endings and Basis");
            }
            return Ask(Order.Arm, b => wholehand.protocol.Arm.CreateArm(b, endingsSeen, basisSeen).Value);
        }

        /// <summary>Fades the exercise out and ramps to neutral.</summary>
        public Task<CommandReply> Stop()
        {
            return Ask(Order.Stop, b =>
            {
                wholehand.protocol.Stop.StartStop(b);
                return wholehand.protocol.Stop.EndStop(b).Value;
            });
        }

        /// <summary>Ramps to neutral at once; it needs no controls. It is sent by WebSocket, and by
        /// datagram until the program confirms it.</summary>
        public Task<CommandReply> EmergencyStop()
        {
            lock (gate)
            {
                Task<CommandReply> answer = Ask(Order.EmergencyStop, b =>
                {
                    wholehand.protocol.EmergencyStop.StartEmergencyStop(b);
                    return wholehand.protocol.EmergencyStop.EndEmergencyStop(b).Value;
                });
                if (!connected) return answer;
                stopId = command;
                stopMessage = builder.SizedByteArray();
                SendDatagram(DatagramKind.Command, stopMessage);
                return answer;
            }
        }

        /// <summary>Loads an exercise, level and hand; empty texts and level 0 keep the present ones.</summary>
        public Task<CommandReply> LoadExercise(string exercise, int level = 0, string hand = "")
        {
            if (level < 0 || level > ushort.MaxValue)
            {
                return Task.FromResult(new CommandReply(false, "there is no level " + level));
            }
            return Ask(Order.LoadExercise, b =>
            {
                StringOffset name = b.CreateString(exercise ?? "");
                StringOffset handName = b.CreateString(hand ?? "");
                return wholehand.protocol.LoadExercise.CreateLoadExercise(b, name, (ushort)level, handName).Value;
            });
        }

        /// <summary>Sets one of Scene.Parameters; the program ramps to the value. <paramref name="basisSeen"/> is
        /// HandState.Basis as it was shown to the person; only an order that raises an effort limit needs it.</summary>
        public Task<CommandReply> SetParameter(string name, double value, uint basisSeen = 0)
        {
            return Ask(Order.SetParameter, b =>
                wholehand.protocol.SetParameter.CreateSetParameter(b, b.CreateString(name ?? ""), value, basisSeen).Value);
        }

        /// <summary>Sets who controls the virtual patient's intention.</summary>
        public Task<CommandReply> Steer(Steering by)
        {
            return Ask(Order.Steer, b => wholehand.protocol.Steer.CreateSteer(b, by).Value);
        }

        /// <summary>Sends an action to the exercise: next, restart, pause, resume. <paramref name="basisSeen"/> is
        /// HandState.Basis as it was shown to the person; a pause needs none. <paramref name="chosen"/> with Next,
        /// where the exercise compares: 1 the first was more, 2 the second.</summary>
        public Task<CommandReply> Action(Act act, uint basisSeen = 0, byte chosen = 0)
        {
            return Ask(Order.Action, b => wholehand.protocol.Action.CreateAction(b, act, basisSeen, chosen).Value);
        }

        /// <summary>The person's intended position of the hand, per axis; sent once and at once, since the next
        /// one corrects it. Only a refusal is answered, through ReplyReceived. Throws
        /// ArgumentException for a posture without axes or with a number that is not finite. `by` is the share of
        /// the motion the game does for the person; recordings keep it.</summary>
        public void Aim(float[] position, Help by = Help.Unspecified)
        {
            if (position == null || position.Length < 1) throw new ArgumentException("no axes", "position");
            foreach (float p in position)
            {
                if (float.IsNaN(p) || float.IsInfinity(p)) throw new ArgumentException("not finite", "position");
            }
            lock (gate)
            {
                if (!connected) return;
                builder.Clear();
                VectorOffset q = wholehand.protocol.Aim.CreateQVector(builder, position);
                int aim = wholehand.protocol.Aim.CreateAim(builder, q, by).Value;
                byte[] message = Words.Command(builder, ++command, Order.Aim, aim);
                if (DatagramsCome(MonotonicClock.NowNs())) SendDatagram(DatagramKind.Command, message);
                else SendMessage(message);
            }
        }

        private Task<CommandReply> Ask(Order type, Func<FlatBufferBuilder, int> make)
        {
            lock (gate)
            {
                if (!connected) return Task.FromResult(new CommandReply(false, "not connected"));
                builder.Clear();
                int order = make(builder);
                byte[] message = Words.Command(builder, ++command, type, order);
                var answer = new TaskCompletionSource<CommandReply>(TaskCreationOptions.RunContinuationsAsynchronously);
                asked.Add(command, answer);
                SendMessage(message);
                return answer.Task;
            }
        }

        // Processes the answer to a command; gate is held.
        private void Answer(uint id, CommandReply reply)
        {
            if (id == stopId) stopMessage = null;
            // Number 0 answers a message that the program could not read; it does not report which one.
            if (id == 0) id = asked.Keys.Where(asking => asking != stopId).DefaultIfEmpty().Min();
            TaskCompletionSource<CommandReply> answer;
            if (!asked.TryGetValue(id, out answer)) return;
            asked.Remove(id);
            answer.TrySetResult(reply);
        }

        // Ends all pending commands, since no answer comes any more; gate is held.
        private void DropCommands(string why)
        {
            stopMessage = null;
            foreach (TaskCompletionSource<CommandReply> answer in asked.Values)
            {
                answer.TrySetResult(new CommandReply(false, why));
            }
            asked.Clear();
        }
    }
}
