namespace Wholehand
{
    /// <summary>Three numbers, without Unity: new Vector3(v.X, v.Y, v.Z).</summary>
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

    /// <summary>A rotation in the order of Unity: new Quaternion(q.X, q.Y, q.Z, q.W).</summary>
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

    /// <summary>From Wholehand's axes (right-handed: x forward, y left, z up) to Unity's (left-handed: x
    /// right, y up, z forward), and back. The change of axes is a reflection: polar vectors (positions,
    /// velocities, forces) follow it, axial ones (angular velocities, torques) take the other sign.</summary>
    public static class UnityAxes
    {
        /// <summary>Positions, velocities, forces.</summary>
        public static Vector ToUnity(Vector v)
        {
            return new Vector(-v.Y, v.Z, v.X);
        }

        public static Vector FromUnity(Vector v)
        {
            return new Vector(v.Z, -v.X, v.Y);
        }

        public static Rotation ToUnity(Rotation q)
        {
            return new Rotation(q.Y, -q.Z, -q.X, q.W);
        }

        public static Rotation FromUnity(Rotation q)
        {
            return new Rotation(-q.Z, q.X, -q.Y, q.W);
        }

        /// <summary>Angular velocities, torques.</summary>
        public static Vector AxialToUnity(Vector v)
        {
            return new Vector(v.Y, -v.Z, -v.X);
        }

        public static Vector AxialFromUnity(Vector v)
        {
            return new Vector(-v.Z, v.X, -v.Y);
        }

        public static Vector ToUnity(wholehand.protocol.Vec3 v)
        {
            return ToUnity(new Vector(v.X, v.Y, v.Z));
        }

        public static Rotation ToUnity(wholehand.protocol.QuatXyzw q)
        {
            return ToUnity(new Rotation(q.X, q.Y, q.Z, q.W));
        }
    }
}
