using System.Collections.Generic;

namespace Wholehand
{
    /// <summary>Scenes, events and replies in the order in which the program sent them, each once,
    /// whatever the network does: it repeats each until it is acknowledged.</summary>
    public sealed class ReliableInbox
    {
        /// <summary>The program has no more than this many on the way.</summary>
        public const int MostUnderway = 32;

        public const int LargestMessage = Datagram.MostFragments * Datagram.LargestPayload;

        private readonly Dictionary<uint, MessageAssembler> open = new Dictionary<uint, MessageAssembler>();
        private readonly Dictionary<uint, MessageAssembler> complete = new Dictionary<uint, MessageAssembler>();
        private uint next = 1;

        /// <summary>True when the message is whole, now or already: it is to be acknowledged.</summary>
        public bool Add(DatagramHeader header, byte[] datagram)
        {
            int ahead = unchecked((int)(header.Sequence - next)); // numbers may wrap
            if (ahead < 0 || complete.ContainsKey(header.Sequence)) return true;
            // As many again: those in between may wait for an acknowledgement that was lost.
            if (ahead >= 2 * MostUnderway) return false;
            MessageAssembler message;
            if (!open.TryGetValue(header.Sequence, out message))
            {
                message = new MessageAssembler(LargestMessage, Datagram.LargestPayload);
                open.Add(header.Sequence, message);
            }
            if (message.Add(header, datagram) != MessageAssembler.Result.Complete) return false;
            open.Remove(header.Sequence);
            complete.Add(header.Sequence, message);
            return true;
        }

        /// <summary>The next message in order; null while it is missing.</summary>
        public MessageAssembler Take()
        {
            MessageAssembler message;
            if (!complete.TryGetValue(next, out message)) return null;
            complete.Remove(next);
            next = unchecked(next + 1);
            return message;
        }
    }
}
