using wholehand.protocol;

namespace Wholehand
{
    /// <summary>A copy of a WorldState that the game owns, or of a part of it. SI, the program's frame.</summary>
    public abstract class Snapshot
    {
        public uint Session;           // counts from 1 with every arming
        public ulong Tick;
        public double TimeS;
        public long SentMonotonicNs;   // clock of the program's machine
        public long ReceivedNs;        // MonotonicClock of this machine when it came

        private bool taken; // a program that was never armed sends a state of zeros

        internal Snapshot()
        {
        }

        /// <summary>Whether it is a copy of that state already.</summary>
        internal bool IsOf(WorldState s)
        {
            return taken && IsSameRest(s) && s.Tick == Tick && s.Session == Session && s.SentMonotonicNs == SentMonotonicNs;
        }

        /// <summary>Throws what FlatBuffers throws where the state is damaged; then it is no copy of it.</summary>
        internal void CopyFrom(WorldState s)
        {
            CopyRest(s);
            Session = s.Session;
            Tick = s.Tick;
            TimeS = s.TimeS;
            SentMonotonicNs = s.SentMonotonicNs;
            taken = true;
        }

        /// <summary>Whether what changes while no tick passes is the same.</summary>
        internal virtual bool IsSameRest(WorldState s)
        {
            return true;
        }

        internal abstract void CopyRest(WorldState s);
    }
}
