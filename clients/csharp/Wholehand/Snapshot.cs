using wholehand.protocol;

namespace Wholehand
{
    /// <summary>A copy of a WorldState or of a part of it, owned by the game. SI, the program's frame.</summary>
    public abstract class Snapshot
    {
        public uint Session;           // increases by one with every arming, from 1
        public ulong Tick;
        public double TimeS;
        public long SentMonotonicNs;   // clock of the program's machine
        public long ReceivedNs;        // MonotonicClock of this machine when it came

        private bool taken; // a program that was never armed sends a state of zeros

        internal Snapshot()
        {
        }

        /// <summary>Whether it is already a copy of that state.</summary>
        internal bool IsOf(WorldState s)
        {
            return taken && IsSameRest(s) && s.Tick == Tick && s.Session == Session && s.SentMonotonicNs == SentMonotonicNs;
        }

        /// <summary>Copies a state. Throws FlatBuffers' exceptions if it is damaged; then this is not a copy of
        /// it.</summary>
        internal void CopyFrom(WorldState s)
        {
            CopyRest(s);
            Session = s.Session;
            Tick = s.Tick;
            TimeS = s.TimeS;
            SentMonotonicNs = s.SentMonotonicNs;
            taken = true;
        }

        /// <summary>Whether the fields are equal that can change without a new tick.</summary>
        internal virtual bool IsSameRest(WorldState s)
        {
            return true;
        }

        internal abstract void CopyRest(WorldState s);
    }
}
