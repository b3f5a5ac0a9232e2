using System;
using wholehand.protocol;

namespace Wholehand
{
    /// <summary>Poses of the hand's links from Scene.Links and the joints of a state. They equal
    /// WorldState.links of the WebSocket, for states that come without them. The program's frame; EngineAxes
    /// converts. Does not allocate after the constructor.</summary>
    public sealed class HandKinematics
    {
        private readonly string[] names;
        private readonly int[] parents, joints;
        private readonly JointType[] types;
        private readonly Vector[] axes, offsets, positions;
        private readonly Rotation[] turns, rotations;

        /// <exception cref="ArgumentException">The scene describes no links, since the program is older than this
        /// client, or their order is not parents first.</exception>
        public HandKinematics(Scene scene)
        {
            int n = scene.LinksLength;
            if (n == 0) throw new ArgumentException("the scene says nothing of links: the program is older than this client");
            names = new string[n];
            parents = new int[n];
            joints = new int[n];
            types = new JointType[n];
            axes = new Vector[n];
            offsets = new Vector[n];
            positions = new Vector[n];
            turns = new Rotation[n];
            rotations = new Rotation[n];
            for (int i = 0; i < n; ++i)
            {
                Link link = scene.Links(i).Value;
                if (link.Parent >= i) throw new ArgumentException("link " + i + " stands before its parent");
                if (!link.Axis.HasValue || !link.AtZero.HasValue) throw new ArgumentException("link " + i + " has no frame");
                Vec3 axis = link.Axis.Value, at = link.AtZero.Value.PositionM;
                QuatXyzw turn = link.AtZero.Value.OrientationXyzw;
                names[i] = link.Name;
                parents[i] = link.Parent;
                joints[i] = link.Joint;
                types[i] = link.Type;
                axes[i] = new Vector(axis.X, axis.Y, axis.Z);
                offsets[i] = new Vector(at.X, at.Y, at.Z);
                turns[i] = new Rotation(turn.X, turn.Y, turn.Z, turn.W);
            }
        }

        public int LinkCount { get { return names.Length; } }

        /// <summary>Position after the last Update, in the world [m].</summary>
        public Vector Position(int link) { return positions[link]; }

        /// <summary>Orientation after the last Update, from the link's frame to the world's.</summary>
        public Rotation Orientation(int link) { return rotations[link]; }

        /// <returns>Index of a link; -1: there is no such link.</returns>
        public int Find(string name) { return Array.IndexOf(names, name); }

        /// <param name="jointAngles">HandState.JointAngles [rad or m].</param>
        public void Update(float[] jointAngles)
        {
            for (int i = 0; i < names.Length; ++i)
            {
                float theta = joints[i] < 0 ? 0.0f : jointAngles[joints[i]];
                Vector at = offsets[i];
                Rotation turn = turns[i];
                if (types[i] == JointType.Prismatic) at = Add(at, Turn(turn, Scale(theta, axes[i])));
                if (types[i] == JointType.Revolute) turn = Multiply(turn, About(axes[i], theta));
                int parent = parents[i];
                positions[i] = parent < 0 ? at : Add(positions[parent], Turn(rotations[parent], at));
                rotations[i] = parent < 0 ? turn : Multiply(rotations[parent], turn);
            }
        }

        private static Vector Add(Vector a, Vector b) { return new Vector(a.X + b.X, a.Y + b.Y, a.Z + b.Z); }

        private static Vector Scale(float s, Vector v) { return new Vector(s * v.X, s * v.Y, s * v.Z); }

        private static Rotation About(Vector axis, float angle)
        {
            float s = (float)Math.Sin(0.5 * angle);
            return new Rotation(s * axis.X, s * axis.Y, s * axis.Z, (float)Math.Cos(0.5 * angle));
        }

        private static Rotation Multiply(Rotation a, Rotation b)
        {
            return new Rotation(a.W * b.X + a.X * b.W + a.Y * b.Z - a.Z * b.Y,
                a.W * b.Y - a.X * b.Z + a.Y * b.W + a.Z * b.X,
                a.W * b.Z + a.X * b.Y - a.Y * b.X + a.Z * b.W,
                a.W * b.W - a.X * b.X - a.Y * b.Y - a.Z * b.Z);
        }

        // v + 2 q x (q x v + w v), q the vector part of a unit quaternion.
        private static Vector Turn(Rotation q, Vector v)
        {
            float x = q.Y * v.Z - q.Z * v.Y + q.W * v.X;
            float y = q.Z * v.X - q.X * v.Z + q.W * v.Y;
            float z = q.X * v.Y - q.Y * v.X + q.W * v.Z;
            return new Vector(v.X + 2.0f * (q.Y * z - q.Z * y), v.Y + 2.0f * (q.Z * x - q.X * z),
                v.Z + 2.0f * (q.X * y - q.Y * x));
        }
    }
}
