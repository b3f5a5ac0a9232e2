using System;

namespace Wholehand
{
    /// <summary>How states reached this client. Allocates nothing once made; any thread.</summary>
    public sealed class ClientStatistics
    {
        // 10 µs a bin up to 50 ms; what is slower is in the last one.
        private const int BinNs = 10000;
        private const int Bins = 5000;

        private readonly long[] latency = new long[Bins + 1];
        private readonly object gate = new object();
        private uint newest;
        private bool any;
        private long received, lost, outOfOrder, ignored, maxNs, roundTripNs;

        /// <summary>States that came in order.</summary>
        public long Received { get { lock (gate) return received; } }

        /// <summary>Datagrams that were sent and did not come before a later one did.</summary>
        public long Lost { get { lock (gate) return lost; } }

        /// <summary>Datagrams that came after a later one, or twice; they are not shown.</summary>
        public long OutOfOrder { get { lock (gate) return outOfOrder; } }

        /// <summary>Datagrams that were damaged, malformed, or of another conversation.</summary>
        public long Ignored { get { lock (gate) return ignored; } }

        /// <summary>Of all states that were sent so far, how many came in order; 1 before the first.</summary>
        public double Share
        {
            get { lock (gate) return received + lost == 0 ? 1.0 : received / (double)(received + lost); }
        }

        /// <summary>To the program and back by datagram, at last; 0: not known yet.</summary>
        public double RoundTripMs { get { lock (gate) return roundTripNs * 1e-6; } }

        public double MaxLatencyMs { get { lock (gate) return maxNs * 1e-6; } }

        /// <summary>The latency that <paramref name="percent"/> % of the states did not exceed, from the
        /// program's send to this client's receive, to 0.01 ms. Program and client must be on one machine:
        /// clocks of two differ.</summary>
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

        /// <summary>Begins to count anew.</summary>
        public void Reset()
        {
            lock (gate)
            {
                any = false;
                received = lost = outOfOrder = ignored = maxNs = 0;
                Array.Clear(latency, 0, latency.Length);
            }
        }

        /// <summary>False, and counted, for a datagram that came after a later one, or twice.</summary>
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

        /// <summary>A state that is newer than all before.</summary>
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

        /// <summary>A new conversation numbers its datagrams from 1.</summary>
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
