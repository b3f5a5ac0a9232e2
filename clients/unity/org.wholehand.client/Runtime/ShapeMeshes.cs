using System.Collections.Generic;
using UnityEngine;
using wholehand.protocol;

namespace Wholehand.Unity
{
    /// <summary>Meshes of the shapes of a scene, in Unity's axes [m]; corners clockwise seen from outside. Cylinders
    /// and capsules lie along y, which is Wholehand's z.</summary>
    public static class ShapeMeshes
    {
        private const int Segments = 24, Rings = 8;

        /// <param name="halfExtents">Half extents in Unity's axes.</param>
        public static Mesh Box(Vector3 halfExtents)
        {
            var vertices = new List<Vector3>();
            var triangles = new List<int>();
            for (int axis = 0; axis < 3; ++axis)
            {
                for (int sign = -1; sign <= 1; sign += 2)
                {
                    Vector3 n = Unit(axis) * sign, u = Unit((axis + 1) % 3) * sign, v = Unit((axis + 2) % 3);
                    int first = vertices.Count;
                    vertices.Add(Vector3.Scale(n - u - v, halfExtents));
                    vertices.Add(Vector3.Scale(n + u - v, halfExtents));
                    vertices.Add(Vector3.Scale(n + u + v, halfExtents));
                    vertices.Add(Vector3.Scale(n - u + v, halfExtents));
                    AddQuad(triangles, first, first + 1, first + 2, first + 3);
                }
            }
            return Made("box", vertices, triangles);
        }

        public static Mesh Sphere(float radius)
        {
            return Capsule(radius, 0.0f);
        }

        /// <param name="length">Distance between the centres of the caps; 0: a sphere.</param>
        public static Mesh Capsule(float radius, float length)
        {
            var vertices = new List<Vector3>();
            var triangles = new List<int>();
            int rings = 2 * Rings + 2; // both caps have the equator
            for (int ring = 0; ring < rings; ++ring)
            {
                bool upper = ring > Rings;
                float latitude = Mathf.PI * ((upper ? ring - 1 : ring) / (2.0f * Rings) - 0.5f);
                float y = radius * Mathf.Sin(latitude) + (upper ? 0.5f : -0.5f) * length;
                AddRing(vertices, radius * Mathf.Cos(latitude), y);
                if (ring > 0) AddBand(triangles, (ring - 1) * Segments, ring * Segments);
            }
            return Made("capsule", vertices, triangles);
        }

        public static Mesh Cylinder(float radius, float height)
        {
            var vertices = new List<Vector3>();
            var triangles = new List<int>();
            AddRing(vertices, radius, -0.5f * height);
            AddRing(vertices, radius, 0.5f * height);
            AddBand(triangles, 0, Segments);
            for (int sign = -1; sign <= 1; sign += 2)
            {
                int centre = vertices.Count;
                vertices.Add(new Vector3(0.0f, 0.5f * sign * height, 0.0f));
                AddRing(vertices, radius, 0.5f * sign * height);
                for (int i = 0; i < Segments; ++i)
                {
                    int a = centre + 1 + i, b = centre + 1 + (i + 1) % Segments;
                    triangles.Add(centre);
                    triangles.Add(sign > 0 ? b : a);
                    triangles.Add(sign > 0 ? a : b);
                }
            }
            return Made("cylinder", vertices, triangles);
        }

        /// <summary>The mesh of a shape, without its pose in the body; null for an unknown shape, or
        /// if triangles have invalid vertex indices.</summary>
        public static Mesh Of(Shape shape)
        {
            switch (shape.Type)
            {
                case ShapeType.Box: return shape.HalfExtentsM.HasValue ? Box(HalfExtents(shape)) : null;
                case ShapeType.Sphere: return Sphere(shape.RadiusM);
                case ShapeType.Cylinder: return Cylinder(shape.RadiusM, shape.LengthM);
                case ShapeType.Capsule: return Capsule(shape.RadiusM, shape.LengthM);
                case ShapeType.ConvexMesh: return Convex(shape);
                default: return null;
            }
        }

        /// <summary>Half extents of a box, in Unity's axes.</summary>
        internal static Vector3 HalfExtents(Shape box)
        {
            Vec3 h = box.HalfExtentsM.Value;
            return new Vector3(h.Y, h.Z, h.X);
        }

        // Edges are sharp: every triangle has its own vertices.
        private static Mesh Convex(Shape shape)
        {
            var vertices = new List<Vector3>();
            var triangles = new List<int>();
            for (int i = 0; i + 2 < shape.TrianglesLength; i += 3)
            {
                for (int corner = 2; corner >= 0; --corner) // a reflection reverses the winding order
                {
                    uint point = shape.Triangles(i + corner);
                    if (point >= shape.PointsMLength) return null;
                    triangles.Add(vertices.Count);
                    vertices.Add(shape.PointsM((int)point).Value.ToVector3());
                }
            }
            return vertices.Count == 0 ? null : Made("convex mesh", vertices, triangles);
        }

        private static Vector3 Unit(int axis)
        {
            return new Vector3(axis == 0 ? 1 : 0, axis == 1 ? 1 : 0, axis == 2 ? 1 : 0);
        }

        private static void AddRing(List<Vector3> vertices, float radius, float y)
        {
            for (int i = 0; i < Segments; ++i)
            {
                float angle = 2.0f * Mathf.PI * i / Segments;
                vertices.Add(new Vector3(radius * Mathf.Cos(angle), y, radius * Mathf.Sin(angle)));
            }
        }

        private static void AddBand(List<int> triangles, int lower, int upper)
        {
            for (int i = 0; i < Segments; ++i)
            {
                int next = (i + 1) % Segments;
                AddQuad(triangles, lower + i, upper + i, upper + next, lower + next);
            }
        }

        private static void AddQuad(List<int> triangles, int a, int b, int c, int d)
        {
            triangles.Add(a);
            triangles.Add(b);
            triangles.Add(c);
            triangles.Add(a);
            triangles.Add(c);
            triangles.Add(d);
        }

        private static Mesh Made(string name, List<Vector3> vertices, List<int> triangles)
        {
            var mesh = new Mesh { name = name };
            mesh.SetVertices(vertices);
            mesh.SetTriangles(triangles, 0);
            mesh.RecalculateNormals();
            mesh.RecalculateBounds();
            return mesh;
        }
    }
}
