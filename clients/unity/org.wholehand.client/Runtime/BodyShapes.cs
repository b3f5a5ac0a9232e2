using System.Collections.Generic;
using UnityEngine;

namespace Wholehand.Unity
{
    /// <summary>Pieces of bodies to spawn, in Unity's axes [m]; cylinders and capsules lie along y.</summary>
    public static class BodyShapes
    {
        public static BodyShape Box(Vector3 size)
        {
            return BodyShape.Box(new Vector(size.z, size.x, size.y)); // Wholehand's x is Unity's z, its y -x, its z y
        }

        public static BodyShape Ball(float radius)
        {
            return BodyShape.Ball(radius);
        }

        public static BodyShape Cylinder(float radius, float height)
        {
            return BodyShape.Cylinder(radius, height);
        }

        /// <param name="height">Total height, like that of Unity's capsule collider.</param>
        public static BodyShape Capsule(float radius, float height)
        {
            return BodyShape.Capsule(radius, Mathf.Max(0.0f, height - 2.0f * radius));
        }

        /// <summary>A piece from a convex and closed mesh. Vertices at the same place are merged, as the program's
        /// check of closed surfaces requires it: Unity's meshes have one vertex for each normal.</summary>
        public static BodyShape Convex(Mesh mesh)
        {
            Vector3[] vertices = mesh.vertices;
            int[] corners = mesh.triangles;
            var points = new List<Vector>();
            var known = new Dictionary<Vector3, uint>();
            var triangles = new uint[corners.Length];
            for (int i = 0; i < corners.Length; ++i)
            {
                Vector3 at = vertices[corners[i]] + new Vector3(); // no negative zero
                uint point;
                if (!known.TryGetValue(at, out point))
                {
                    known[at] = point = (uint)points.Count;
                    points.Add(at.ToWholehand());
                }
                triangles[i] = point;
            }
            return BodyShape.Mesh(points.ToArray(), triangles);
        }

        /// <summary>The piece at another pose in the body's frame.</summary>
        public static BodyShape At(this BodyShape shape, Vector3 position, Quaternion rotation)
        {
            shape.PositionM = position.ToWholehand();
            shape.Orientation = rotation.ToWholehand();
            return shape;
        }
    }
}
