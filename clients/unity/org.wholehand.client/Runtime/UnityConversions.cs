using UnityEngine;
using wholehand.protocol;

namespace Wholehand.Unity
{
    /// <summary>Conversions between Wholehand's and Unity's vectors and rotations: axes by EngineAxes.Unity, both in
    /// metres.</summary>
    public static class UnityConversions
    {
        /// <summary>Converts positions, velocities, forces.</summary>
        public static Vector3 ToVector3(this Vector v)
        {
            Vector u = EngineAxes.Unity.Position(v);
            return new Vector3(u.X, u.Y, u.Z);
        }

        public static Vector3 ToVector3(this Vec3 v)
        {
            return new Vector(v.X, v.Y, v.Z).ToVector3();
        }

        public static Quaternion ToQuaternion(this Rotation q)
        {
            Rotation u = EngineAxes.Unity.Orientation(q);
            return new Quaternion(u.X, u.Y, u.Z, u.W);
        }

        public static Quaternion ToQuaternion(this QuatXyzw q)
        {
            return new Rotation(q.X, q.Y, q.Z, q.W).ToQuaternion();
        }

        /// <summary>Converts positions, velocities, forces to the program's axes, for aims and game objects.</summary>
        public static Vector ToWholehand(this Vector3 v)
        {
            return EngineAxes.Unity.PositionFrom(new Vector(v.x, v.y, v.z));
        }

        public static Rotation ToWholehand(this Quaternion q)
        {
            return EngineAxes.Unity.OrientationFrom(new Rotation(q.x, q.y, q.z, q.w));
        }

        /// <summary>Converts a point of the game's world to the program's axes.</summary>
        /// <param name="world">Transform of the Wholehand World.</param>
        internal static Vector ToProgram(this Transform world, Vector3 point)
        {
            return world.InverseTransformPoint(point).ToWholehand();
        }

        internal static Rotation ToProgram(this Transform world, Quaternion rotation)
        {
            return (Quaternion.Inverse(world.rotation) * rotation).ToWholehand();
        }
    }
}
