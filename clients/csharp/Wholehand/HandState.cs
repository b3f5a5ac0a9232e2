using System;
using wholehand.protocol;

namespace Wholehand
{
    /// <summary>A copy of a WorldState, owned by the game. Copying the next state into it allocates
    /// nothing unless the number of axes changes. SI, radians, the program's frame (EngineAxes converts);
    /// arrays per axis are in the order of Scene.Axes, joints in that of Scene.JointNames, values in that
    /// of Scene.ValueNames.</summary>
    public sealed class HandState : Snapshot
    {
        public uint Endings;           // counts stops, faults and ends of sessions; Arm needs the last one shown
        public uint Basis;             // number of the person, hand, level and limits of LatestScene; Arm needs it
        public RunState RunState;
        public Steering Steering;
        public uint Faults;
        public uint LatchedFaults;
        public bool Silent;            // the robot does not answer: show it, with the device's own emergency stop
        public float Authority;        // 1 while rendering, 0 at neutral
        public float Alpha;            // blend factor of the exercise's transition
        public int PalmBody = -1;      // the nearest of the exercise's bodies; -1: none
        public float PalmTargetDistanceM;
        public float[] DevicePosition = new float[0];
        public float[] HandPosition = new float[0];    // of the avatar, per axis
        public float[] JointAngles = new float[0];     // of the avatar
        public float[] Intention = new float[0];
        public float[] Coupling = new float[0];        // efforts, N or N·m
        public float[] ExerciseEffort = new float[0];
        public float[] Damping = new float[0];
        public float[] Sent = new float[0];
        public float[] Phi = new float[0];
        public double[] Values = new double[0];        // of the exercise

        private const int MostNumbers = 1024;

        // The number of stops, and the start of arming, can change while nothing renders.
        internal override bool IsSameRest(WorldState s)
        {
            return s.Endings == Endings && s.RunState == RunState && s.Steering == Steering && s.Silent == Silent;
        }

        // Lambdas without captured variables, which are allocated once.
        internal override void CopyRest(WorldState s)
        {
            Endings = s.Endings;
            RunState = s.RunState;
            Steering = s.Steering;
            Silent = s.Silent;
            Faults = s.Faults;
            LatchedFaults = s.LatchedFaults;
            Authority = s.Authority;
            Alpha = s.Alpha;
            PalmBody = s.PalmBody;
            PalmTargetDistanceM = s.PalmTargetDistanceM;
            Copy(ref DevicePosition, s, s.QMLength, (w, i) => w.QM(i));
            Copy(ref HandPosition, s, s.QSLength, (w, i) => w.QS(i));
            Copy(ref JointAngles, s, s.ThetaLength, (w, i) => w.Theta(i));
            Copy(ref Intention, s, s.IntentionLength, (w, i) => w.Intention(i));
            Copy(ref Coupling, s, s.CouplingLength, (w, i) => w.Coupling(i));
            Copy(ref ExerciseEffort, s, s.ExerciseEffortLength, (w, i) => w.ExerciseEffort(i));
            Copy(ref Damping, s, s.DampingLength, (w, i) => w.Damping(i));
            Copy(ref Sent, s, s.SentLength, (w, i) => w.Sent(i));
            Copy(ref Phi, s, s.PhiLength, (w, i) => w.Phi(i));
            Copy(ref Values, s, s.ValuesLength, (w, i) => w.Values(i));
        }

        private static void Copy<T>(ref T[] target, WorldState from, int length, Func<WorldState, int, T> at)
        {
            if (length < 0 || length > MostNumbers) throw new InvalidOperationException("an array that no state has");
            if (target.Length != length) target = new T[length];
            for (int i = 0; i < length; ++i) target[i] = at(from, i);
        }
    }
}
