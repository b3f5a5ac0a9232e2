using FlatBuffers;
using wholehand.protocol;

namespace Wholehand
{
    /// <summary>Messages as FlatBuffers.</summary>
    internal static class Words
    {
        /// <summary>Schema version of protocol/wholehand.fbs.</summary>
        public const ushort SchemaVersion = 1;

        public static byte[] Command(FlatBufferBuilder b, uint id, Order type, int order)
        {
            int command = wholehand.protocol.Command.CreateCommand(b, id, type, order).Value;
            Message.FinishMessageBuffer(b, Message.CreateMessage(b, SchemaVersion, Payload.Command, command));
            return b.SizedByteArray();
        }

        public static byte[] Heartbeat(FlatBufferBuilder b)
        {
            b.Clear();
            wholehand.protocol.Heartbeat.StartHeartbeat(b);
            return Command(b, 0, Order.Heartbeat, wholehand.protocol.Heartbeat.EndHeartbeat(b).Value);
        }

        /// <summary>Whether it is a message of the program with a payload.</summary>
        public static bool IsMessage(ByteBuffer message, int length)
        {
            const int SmallestMessage = 8; // root offset and identifier
            return length >= SmallestMessage && Message.MessageBufferHasIdentifier(message)
                && Message.GetRootAsMessage(message).SchemaVersion == SchemaVersion
                && PayloadAt(new Table(message.GetInt(0), message)) != 0;
        }

        /// <summary>The state in a message that has one. Unlike Message.PayloadAsWorldState it does not box the state
        /// on every call.</summary>
        public static WorldState StateOf(ByteBuffer message)
        {
            var table = new Table(message.GetInt(0), message);
            return new WorldState().__assign(table.__indirect(PayloadAt(table) + table.bb_pos), message);
        }

        private static int PayloadAt(Table message)
        {
            const int PayloadField = 8; // the third slot of its table: 4 + 2 * 2
            return message.__offset(PayloadField);
        }
    }

    /// <summary>A message buffer that is reused.</summary>
    internal sealed class MessageBuffer
    {
        public MessageBuffer()
        {
            Bytes = new ByteBuffer(new byte[Datagram.LargestSize]);
        }

        /// <summary>The buffer for FlatBuffers, from position 0.</summary>
        public ByteBuffer Bytes { get; private set; }

        public int Length { get; private set; }

        public long ReceivedNs { get; private set; }

        public void CopyFrom(byte[] from, int offset, int length, long receivedNs)
        {
            byte[] memory = Bytes.Length < length ? new byte[2 * length] : null;
            if (memory != null) Bytes = new ByteBuffer(memory);
            System.ArraySegment<byte> target = Bytes.ToArraySegment(0, Bytes.Length);
            System.Buffer.BlockCopy(from, offset, target.Array, target.Offset, length);
            Length = length;
            ReceivedNs = receivedNs;
        }
    }
}
