using System;

namespace Wholehand
{
    /// <summary>Where the joints of the hand are now, from states that come late, irregularly and in part not at all: a
    /// parabola through the newest state and two before it. The curvature counts three quarters, which halves its overshoot
    /// where a motion ends. How old a state is follows from the fastest delivery of the last seconds; the clocks of program
    /// and client may differ, and what the fastest delivery itself needs is not seen. Allocates nothing after the first
    /// states of a session. One thread.</summary>
    public sealed class MotionPredictor
    {
        private const double SpacingS = 0.0045;        // between the states of a parabola, at least
        private const double CurvatureShare = 0.75;
        private const double LongestS = 0.05;          // ahead of the newest state
        private const double FadesFromS = 0.1;         // without a new state the drawn hand returns to the newest,
        private const double FadedAtS = 0.25;          // until then
        private const long DelayWindowNs = 2000000000; // the clock's window is between one and two of them

        private struct Sample
        {
            public double TimeS;
            public float[] Joints;
        }

        private readonly Sample[] kept = new Sample[4]; // newest first; of the others each is SpacingS older, at least
        private int count;
        private uint session;
        private long newestSentNs, windowEndsNs, delayNs, delayBeforeNs;

        /// <summary>No state has come yet.</summary>
        public bool IsEmpty { get { return count == 0; } }

        /// <summary>For another connection, whose program may have another clock.</summary>
        public void Clear()
        {
            count = 0;
        }

        /// <summary>Every state that is newer than all before; others are ignored.</summary>
        public void Add(HandState state)
        {
            Add(state.Session, state.TimeS, state.SentMonotonicNs, state.ReceivedNs, state.JointAngles);
        }

        internal void Add(uint ofSession, double timeS, long sentNs, long receivedNs, float[] joints)
        {
            bool same = count > 0 && ofSession == session && joints.Length == kept[0].Joints.Length;
            if (same && (sentNs <= newestSentNs || timeS == kept[0].TimeS)) return;
            bool continues = same && timeS > kept[0].TimeS;
            CountDelay(receivedNs - sentNs, receivedNs);
            if (!continues) count = 0;
            session = ofSession;
            newestSentNs = sentNs;
            // The newest one stays where it is far enough from the next; otherwise it is replaced.
            if (count > 0 && (count == 1 || kept[0].TimeS - kept[1].TimeS >= SpacingS))
            {
                Sample last = kept[kept.Length - 1];
                Array.Copy(kept, 0, kept, 1, kept.Length - 1);
                kept[0] = last;
                count = Math.Min(count + 1, kept.Length);
            }
            count = Math.Max(count, 1);
            kept[0].TimeS = timeS;
            if (kept[0].Joints == null || kept[0].Joints.Length != joints.Length) kept[0].Joints = new float[joints.Length];
            Array.Copy(joints, kept[0].Joints, joints.Length);
        }

        /// <summary>The joints at <paramref name="nowNs"/> of MonotonicClock; false before the first state, and where
        /// <paramref name="joints"/> has another length than states have.</summary>
        public bool TryPredict(long nowNs, float[] joints)
        {
            if (count == 0 || joints.Length != kept[0].Joints.Length) return false;
            double ageS = Math.Max(0.0, (nowNs - newestSentNs - Math.Min(delayNs, delayBeforeNs)) * 1e-9);
            double fading = Math.Max(0.0, Math.Min(1.0, (FadedAtS - ageS) / (FadedAtS - FadesFromS)));
            double aheadS = Math.Min(ageS, LongestS) * fading;
            int one = count > 1 && kept[0].TimeS - kept[1].TimeS < SpacingS ? 2 : 1, two = one + 1;
            for (int i = 0; i < joints.Length; ++i)
            {
                double ahead = 0.0;
                if (one < count)
                {
                    double h = kept[0].TimeS - kept[one].TimeS, slope = (kept[0].Joints[i] - kept[one].Joints[i]) / h;
                    ahead = slope * aheadS;
                    if (two < count)
                    {
                        double before = kept[one].TimeS - kept[two].TimeS;
                        double curvature = (slope - (kept[one].Joints[i] - kept[two].Joints[i]) / before) / (h + before);
                        ahead += CurvatureShare * curvature * aheadS * (aheadS + h);
                    }
                }
                joints[i] = (float)(kept[0].Joints[i] + ahead);
            }
            return true;
        }

        // The smallest one of this window and of the one before it.
        private void CountDelay(long ns, long nowNs)
        {
            if (count == 0)
            {
                delayNs = delayBeforeNs = ns;
                windowEndsNs = nowNs + DelayWindowNs;
            }
            if (nowNs >= windowEndsNs)
            {
                delayBeforeNs = delayNs;
                delayNs = ns;
                windowEndsNs = nowNs + DelayWindowNs;
            }
            delayNs = Math.Min(delayNs, ns);
        }
    }
}
