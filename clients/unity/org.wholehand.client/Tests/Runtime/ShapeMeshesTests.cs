using NUnit.Framework;
using UnityEngine;

namespace Wholehand.Unity.Tests
{
    /// <summary>A mesh's signed volume is positive if its vertices are ordered clockwise seen from outside.</summary>
    public sealed class ShapeMeshesTests
    {
        public static float Volume(Mesh mesh)
        {
            Vector3[] v = mesh.vertices;
            int[] t = mesh.triangles;
            float sum = 0.0f;
            for (int i = 0; i < t.Length; i += 3) sum += Vector3.Dot(v[t[i]], Vector3.Cross(v[t[i + 1]], v[t[i + 2]])) / 6.0f;
            return sum;
        }

        [Test]
        public void Box_HasItsVolume()
        {
            Assert.Less(Mathf.Abs(Volume(ShapeMeshes.Box(new Vector3(0.5f, 1.0f, 1.5f))) - 6.0f), 1e-4f, "1 x 2 x 3");
        }

        // A prism of 24 corners has sin(2π/24) / (2π/24) = 0.9886 of its circle's area; a sphere's rings have the same
        // loss.
        [Test]
        public void RoundShapes_HaveTheirVolumesButForTheirCorners()
        {
            float disk = Mathf.PI * 0.25f;
            Inside(0.9886f * disk * 2.0f, Volume(ShapeMeshes.Cylinder(0.5f, 2.0f)), 0.001f, "cylinder");
            float ball = 4.0f / 3.0f * Mathf.PI * 0.125f;
            Inside(ball, Volume(ShapeMeshes.Sphere(0.5f)), 0.04f, "sphere");
            Inside(ball + disk * 2.0f, Volume(ShapeMeshes.Capsule(0.5f, 2.0f)), 0.03f, "capsule");
        }

        private static void Inside(float expected, float actual, float share, string what)
        {
            Assert.Less(Mathf.Abs(actual / expected - 1.0f), share, what);
        }
    }
}
