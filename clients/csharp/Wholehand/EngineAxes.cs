using System;

namespace Wholehand
{
    /// <summary>Three numbers; in Unity: new Vector3(v.X, v.Y, v.Z).</summary>
    public struct Vector
    {
        public float X, Y, Z;

        public Vector(float x, float y, float z)
        {
            X = x;
            Y = y;
            Z = z;
        }
    }

    /// <summary>A rotation as a quaternion x, y, z, w, like Unity's: new Quaternion(q.X, q.Y, q.Z, q.W).</summary>
    public struct Rotation
    {
        public float X, Y, Z, W;

        public Rotation(float x, float y, float z, float w)
        {
            X = x;
            Y = y;
            Z = z;
            W = w;
        }
    }

    /// <summary>The axes of one engine: the source of each of its x, y, z in Wholehand's axes (right-handed: x away
    /// from the person, y left, z up, metres). Engines contains all engines of docs/axes.md. Nothing here
    /// allocates.</summary>
    public sealed class EngineAxes
    {
        public static readonly EngineAxes Unity = new EngineAxes("Unity", "-y", "z", "x", 1.0f);
        public static readonly EngineAxes Unreal = new EngineAxes("Unreal", "x", "-y", "z", 100.0f);
        public static readonly EngineAxes Godot = new EngineAxes("Godot", "-y", "z", "-x", 1.0f);
        public static readonly EngineAxes ThreeJs = new EngineAxes("three.js", "-y", "z", "-x", 1.0f);
        public static readonly EngineAxes Ros = new EngineAxes("ROS", "x", "y", "z", 1.0f);

        public static readonly EngineAxes[] Engines = { Unity, Unreal, Godot, ThreeJs, Ros };

        private readonly int[] source = new int[3];
        private readonly float[] sign = new float[3];

        private EngineAxes(string name, string x, string y, string z, float unitsPerMetre)
        {
            Name = name;
            UnitsPerMetre = unitsPerMetre;
            Sources = new[] { x, y, z };
            for (int i = 0; i < 3; ++i)
            {
                source[i] = Sources[i][Sources[i].Length - 1] - 'x';
                sign[i] = Sources[i][0] == '-' ? -1.0f : 1.0f;
            }
            // The determinant: the sign of the permutation, times the signs.
            int inversions = 0;
            for (int i = 0; i < 3; ++i)
            {
                for (int j = i + 1; j < 3; ++j) if (source[i] > source[j]) ++inversions;
            }
            Handedness = sign[0] * sign[1] * sign[2] * (inversions % 2 == 0 ? 1.0f : -1.0f);
        }

        public string Name { get; private set; }

        /// <summary>Unit of positions. Unreal uses centimetres.</summary>
        public float UnitsPerMetre { get; private set; }

        /// <summary>Wholehand's axis for each of the engine's x, y, z: "x", "-y" ...</summary>
        public string[] Sources { get; private set; }

        /// <summary>1: right-handed, as Wholehand; -1: left-handed. Determinant of the change of axes.</summary>
        public float Handedness { get; private set; }

        /// <summary>Converts a position [m] to the engine's unit.</summary>
        public Vector Position(Vector m)
        {
            return Scaled(UnitsPerMetre, Polar(m));
        }

        /// <summary>Converts a position from the engine's unit to [m].</summary>
        public Vector PositionFrom(Vector v)
        {
            return Scaled(1.0f / UnitsPerMetre, PolarFrom(v));
        }

        /// <summary>Converts forces and directions, which have no unit of length.</summary>
        public Vector Polar(Vector v)
        {
            return new Vector(sign[0] * At(v, source[0]), sign[1] * At(v, source[1]), sign[2] * At(v, source[2]));
        }

        public Vector PolarFrom(Vector v)
        {
            var into = new Vector();
            Put(ref into, source[0], sign[0] * v.X);
            Put(ref into, source[1], sign[1] * v.Y);
            Put(ref into, source[2], sign[2] * v.Z);
            return into;
        }

        /// <summary>Converts angular velocities and torques: a reflection changes their sign.</summary>
        public Vector Axial(Vector v)
        {
            return Scaled(Handedness, Polar(v));
        }

        public Vector AxialFrom(Vector v)
        {
            return Scaled(Handedness, PolarFrom(v));
        }

        public Rotation Orientation(Rotation q)
        {
            Vector axis = Axial(new Vector(q.X, q.Y, q.Z));
            return new Rotation(axis.X, axis.Y, axis.Z, q.W);
        }

        public Rotation OrientationFrom(Rotation q)
        {
            Vector axis = AxialFrom(new Vector(q.X, q.Y, q.Z));
            return new Rotation(axis.X, axis.Y, axis.Z, q.W);
        }

        private static float At(Vector v, int i)
        {
            return i == 0 ? v.X : i == 1 ? v.Y : v.Z;
        }

        private static void Put(ref Vector v, int i, float value)
        {
            if (i == 0) v.X = value;
            else if (i == 1) v.Y = value;
            else v.Z = value;
        }

        private static Vector Scaled(float s, Vector v)
        {
            return new Vector(s * v.X, s * v.Y, s * v.Z);
        }
    }
}
