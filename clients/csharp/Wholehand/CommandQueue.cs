using System.Collections.Generic;
using System.Threading.Tasks;
using FlatBuffers;
using wholehand.protocol;

namespace Wholehand
{
    /// <summary>Commands one after another: each is sent again until the program answers it, and only
    /// then comes the next, so that they are carried out in order whatever the network loses. An
    /// emergency stop drops those that wait. Not for several threads at once.</summary>
    internal sealed class CommandQueue
    {
        public const long PauseNs = 50000000;
        public const long PatienceNs = 2000000000;

        private sealed class Waiting
        {
            public uint Id;
            public byte[] Message;
            public TaskCompletionSource<CommandReply> Done;
            public long BegunNs = -1, SentNs;
            public bool Emergency;
        }

        private readonly LinkedList<Waiting> waiting = new LinkedList<Waiting>();

        public Task<CommandReply> Add(uint id, byte[] message, bool dropOthers)
        {
            if (dropOthers) Drop("an emergency stop came first");
            var command = new Waiting
            {
                Id = id,
                Message = message,
                Emergency = dropOthers,
                Done = new TaskCompletionSource<CommandReply>(TaskCreationOptions.RunContinuationsAsynchronously)
            };
            waiting.AddLast(command);
            return command.Done.Task;
        }

        /// <summary>What is to be sent now; null: nothing.</summary>
        public byte[] Due(long nowNs)
        {
            while (waiting.Count > 0)
            {
                Waiting first = waiting.First.Value;
                if (first.BegunNs < 0)
                {
                    first.BegunNs = first.SentNs = nowNs;
                    return first.Message;
                }
                if (nowNs - first.BegunNs > PatienceNs)
                {
                    waiting.RemoveFirst();
                    first.Done.TrySetResult(new CommandReply(false, "the program did not answer"));
                    continue;
                }
                if (nowNs - first.SentNs < PauseNs) return null;
                first.SentNs = nowNs;
                return first.Message;
            }
            return null;
        }

        /// <summary>An answer; 0 answers a message that the program could not read: which one, it does not
        /// say. An emergency stop is none, and goes on being sent.</summary>
        public void Answer(uint id, CommandReply reply)
        {
            if (waiting.Count == 0) return;
            Waiting first = waiting.First.Value;
            if (first.BegunNs < 0 || (id != first.Id && (id != 0 || first.Emergency))) return;
            waiting.RemoveFirst();
            first.Done.TrySetResult(reply);
        }

        public void Drop(string reason)
        {
            foreach (Waiting command in waiting) command.Done.TrySetResult(new CommandReply(false, reason));
            waiting.Clear();
        }
    }

    /// <summary>What a client says, as FlatBuffers.</summary>
    internal static class Words
    {
        /// <summary>Of protocol/wholehand.fbs.</summary>
        public const ushort SchemaVersion = 1;

        public static byte[] Acknowledge(FlatBufferBuilder b, uint sequence)
        {
            b.Clear();
            return Finish(b, Payload.Acknowledge, wholehand.protocol.Acknowledge.CreateAcknowledge(b, sequence).Value);
        }

        public static byte[] Command(FlatBufferBuilder b, uint id, Order type, int order)
        {
            return Finish(b, Payload.Command, wholehand.protocol.Command.CreateCommand(b, id, type, order).Value);
        }

        /// <summary>The state in a message that has one. As Message.PayloadAsWorldState, which boxes a state
        /// on every call.</summary>
        public static WorldState StateOf(ByteBuffer message)
        {
            var table = new Table(message.GetInt(0), message);
            return new WorldState().__assign(table.__indirect(PayloadAt(table) + table.bb_pos), message);
        }

        public static bool HasPayload(ByteBuffer message)
        {
            return PayloadAt(new Table(message.GetInt(0), message)) != 0;
        }

        private static int PayloadAt(Table message)
        {
            const int PayloadField = 8; // the third slot of its table: 4 + 2 * 2
            return message.__offset(PayloadField);
        }

        private static byte[] Finish(FlatBufferBuilder b, Payload type, int payload)
        {
            Message.FinishMessageBuffer(b, Message.CreateMessage(b, SchemaVersion, type, payload));
            return b.SizedByteArray();
        }
    }
}
