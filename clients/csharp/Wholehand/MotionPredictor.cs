using System;

namespace Wholehand
{
    /// <summary>Predicts the hand's joints at present from states that come late, irregularly and with losses: a
    /// parabola through the newest state and two earlier ones. Its curvature is weighted by three quarters, which
    /// halves the overshoot at the end of a motion. The age of a state is relative to the fastest delivery of the last
    /// seconds: the clocks of program and client may differ, and the delay of the fastest delivery is not compensated.
    /// Allocates nothing after the states of a session. One thread.</summary>
    public sealed class MotionPredictor
    {
        private const double SpacingS = 0.0045;        // minimum spacing between the states of a parabola
        private const double CurvatureShare = 0.75;
        private const double LongestS = 0.05;          // maximum extrapolation beyond the newest state
        private const double FadesFromS = 0.1;         // without a new state the hand returns to the newest from this age,
        private const double FadedAtS = 0.25;          // until this age
        private const long DelayWindowNs = 2000000000; // the minimum delay is taken over one to two windows

        private struct Sample
        {
            public double TimeS;
            public float[] Joints;
        }

        private readonly Sample[] kept = new Sample[4]; // newest first; each other one is at least SpacingS older
        private int count;
        private uint session;
        private long newestSentNs, windowEndsNs, delayNs, delayBeforeNs;

        /// <summary>Whether no state has come yet.</summary>
        public bool IsEmpty { get { return count == 0; } }

        /// <summary>Clears all states for another connection, whose program may have another clock.</summary>
        public void Clear()
        {
            count = 0;
        }

        /// <summary>Adds a state that is newer than all before; others are ignored.</summary>
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
            // The newest sample is kept if it is far enough from the next one; otherwise it is replaced.
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

        /// <summary>Predicts the joints at <paramref name="nowNs"/> of MonotonicClock. False before the first state,
        /// and if
        /// <paramref name="joints"/> has another length than the states.</summary>
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

        // Keeps the minimum of this window and of the one before it.
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
