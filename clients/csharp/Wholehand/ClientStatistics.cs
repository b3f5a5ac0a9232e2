using System;

namespace Wholehand
{
    /// <summary>Statistics of received states. Does not allocate after construction; any thread.</summary>
    public sealed class ClientStatistics
    {
        // Bins of 10 µs up to 50 ms; the last one holds all slower states.
        private const int BinNs = 10000;
        private const int Bins = 5000;

        private readonly long[] latency = new long[Bins + 1];
        private readonly object gate = new object();
        private uint newest;
        private bool any;
        private long received, lost, outOfOrder, ignored, maxNs, roundTripNs;

        /// <summary>States that came in order.</summary>
        public long Received { get { lock (gate) return received; } }

        /// <summary>Sent datagrams that had not come when a later one did.</summary>
        public long Lost { get { lock (gate) return lost; } }

        /// <summary>Datagrams that came after a later one, or twice; their states are not used.</summary>
        public long OutOfOrder { get { lock (gate) return outOfOrder; } }

        /// <summary>Datagrams that were damaged, malformed, or from another conversation.</summary>
        public long Ignored { get { lock (gate) return ignored; } }

        /// <summary>Share of the sent states that came in order; 1 before the first.</summary>
        public double Share
        {
            get { lock (gate) return received + lost == 0 ? 1.0 : received / (double)(received + lost); }
        }

        /// <summary>Newest round-trip time by datagram; 0: unknown.</summary>
        public double RoundTripMs { get { lock (gate) return roundTripNs * 1e-6; } }

        public double MaxLatencyMs { get { lock (gate) return maxNs * 1e-6; } }

        /// <summary>The percentile <paramref name="percent"/> of the latency from the
        /// program's send to this client's receive, to 0.01 ms. Program and client must be on one machine,
        /// since the clocks of two machines differ.</summary>
        public double LatencyMs(double percent)
        {
            lock (gate)
            {
                long rank = Math.Max(1, (long)Math.Ceiling(received * percent / 100.0));
                long seen = 0;
                for (int i = 0; i < Bins; ++i)
                {
                    seen += latency[i];
                    if (seen >= rank) return Math.Min((i + 1) * BinNs, maxNs) * 1e-6;
                }
                return received == 0 ? 0.0 : maxNs * 1e-6;
            }
        }

        /// <summary>Restarts all counters.</summary>
        public void Reset()
        {
            lock (gate)
            {
                any = false;
                received = lost = outOfOrder = ignored = maxNs = 0;
                Array.Clear(latency, 0, latency.Length);
            }
        }

        /// <summary>Returns false, and counts it, for a datagram that came after a later one, or twice.</summary>
        internal bool IsNewer(uint sequence)
        {
            lock (gate)
            {
                if (!any || unchecked((int)(sequence - newest)) > 0)
                {
                    if (any) lost += unchecked((int)(sequence - newest)) - 1;
                    any = true;
                    newest = sequence;
                    return true;
                }
                ++outOfOrder;
                return false;
            }
        }

        /// <summary>Counts a state that is newer than all before.</summary>
        internal void CountState(long latencyNs)
        {
            lock (gate)
            {
                ++received;
                ++latency[Math.Max(0, Math.Min(latencyNs / BinNs, Bins))];
                maxNs = Math.Max(maxNs, latencyNs);
            }
        }

        internal void CountRoundTrip(long ns)
        {
            lock (gate) roundTripNs = ns;
        }

        internal void CountIgnored()
        {
            lock (gate) ++ignored;
        }

        /// <summary>Restarts the sequence numbers: a new conversation counts its datagrams from 1.</summary>
        internal void BeginConversation()
        {
            lock (gate)
            {
                any = true;
                newest = 0;
            }
        }
    }
}
