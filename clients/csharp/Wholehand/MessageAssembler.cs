using System;
using FlatBuffers;

namespace Wholehand
{
    /// <summary>Puts the fragments of one message together, in any order. Its memory is used again for
    /// the next message.</summary>
    public sealed class MessageAssembler
    {
        private readonly int largest;
        private byte[] bytes;
        private bool[] have = new bool[1];
        private int received;
        private bool open;
        private uint sequence;
        private int count;

        public MessageAssembler(int largestMessage, int room = 4096)
        {
            largest = largestMessage;
            Provide(Math.Min(largestMessage, room));
        }

        public enum Result
        {
            Incomplete,
            Complete,
            Repeated,
            Refused // fragments contradict each other, or the message would be too large
        }

        /// <summary>Of a message that is complete.</summary>
        public int Length { get; private set; }

        /// <summary>The message for FlatBuffers, from position 0.</summary>
        public ByteBuffer Bytes { get; private set; }

        /// <summary>Adds a fragment, whose payload stands behind the header in the datagram. One of
        /// another message than before drops what came of that.</summary>
        public Result Add(DatagramHeader header, byte[] datagram)
        {
            bool last = header.FragmentIndex + 1 == header.FragmentCount;
            int from = header.FragmentIndex * Datagram.LargestPayload;
            int end = from + header.PayloadLength;
            // All but the last are full: the place of each is then known whatever the order.
            if (end > largest || (!last && header.PayloadLength != Datagram.LargestPayload)) return Result.Refused;
            if (!open || header.Sequence != sequence) Begin(header);
            if (header.FragmentCount != count) return Result.Refused;
            if (have[header.FragmentIndex]) return Result.Repeated;
            if (end > bytes.Length) Provide(Math.Min(largest, Math.Max(end, 2 * bytes.Length)));
            have[header.FragmentIndex] = true;
            Buffer.BlockCopy(datagram, Datagram.HeaderSize, bytes, from, header.PayloadLength);
            Length = Math.Max(Length, end);
            if (++received < count) return Result.Incomplete;
            open = false;
            return Result.Complete;
        }

        private void Begin(DatagramHeader header)
        {
            open = true;
            sequence = header.Sequence;
            count = header.FragmentCount;
            received = 0;
            Length = 0;
            if (have.Length < count) have = new bool[count];
            Array.Clear(have, 0, have.Length);
        }

        private void Provide(int size)
        {
            var more = new byte[size];
            if (bytes != null) Buffer.BlockCopy(bytes, 0, more, 0, bytes.Length);
            bytes = more;
            Bytes = new ByteBuffer(more);
        }
    }
}
