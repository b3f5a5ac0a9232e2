using System;
using Wholehand;

/// <summary>Against matrices: Unity's axes are a reflection M of ours (its x is our -y, its y our z, its
/// z our x; Unity's manual: left-handed, y up, z forward). A rotation R becomes M R Mᵀ, a polar vector
/// M v, an axial one det(M) M v.</summary>
[Tests]
public static class UnityAxesTests
{
    private static readonly double[,] M = { { 0, -1, 0 }, { 0, 0, 1 }, { 1, 0, 0 } };

    private static double[,] Times(double[,] a, double[,] b)
    {
        var c = new double[3, 3];
        for (int i = 0; i < 3; ++i)
        {
            for (int j = 0; j < 3; ++j)
            {
                for (int k = 0; k < 3; ++k) c[i, j] += a[i, k] * b[k, j];
            }
        }
        return c;
    }

    private static double[,] Transposed(double[,] a)
    {
        var c = new double[3, 3];
        for (int i = 0; i < 3; ++i)
        {
            for (int j = 0; j < 3; ++j) c[i, j] = a[j, i];
        }
        return c;
    }

    private static double[] Times(double[,] a, Vector v)
    {
        var c = new double[3];
        for (int i = 0; i < 3; ++i) c[i] = a[i, 0] * v.X + a[i, 1] * v.Y + a[i, 2] * v.Z;
        return c;
    }

    private static double Determinant(double[,] a)
    {
        return a[0, 0] * (a[1, 1] * a[2, 2] - a[1, 2] * a[2, 1])
            - a[0, 1] * (a[1, 0] * a[2, 2] - a[1, 2] * a[2, 0])
            + a[0, 2] * (a[1, 0] * a[2, 1] - a[1, 1] * a[2, 0]);
    }

    // The textbook matrix of a unit quaternion; the same in left- and right-handed axes.
    private static double[,] Matrix(Rotation q)
    {
        double x = q.X, y = q.Y, z = q.Z, w = q.W;
        return new[,]
        {
            { 1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w) },
            { 2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w) },
            { 2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y) }
        };
    }

    private static Vector RandomVector(Random random)
    {
        return new Vector((float)random.NextDouble() - 0.5f, (float)random.NextDouble() - 0.5f,
            (float)random.NextDouble() - 0.5f);
    }

    private static Rotation RandomRotation(Random random)
    {
        Vector a = RandomVector(random);
        double w = random.NextDouble() - 0.5;
        double n = Math.Sqrt(a.X * a.X + a.Y * a.Y + a.Z * a.Z + w * w);
        return new Rotation((float)(a.X / n), (float)(a.Y / n), (float)(a.Z / n), (float)(w / n));
    }

    private static void Same(double[] expected, Vector actual, string what)
    {
        Check.Near(expected[0], actual.X, 1e-6, what);
        Check.Near(expected[1], actual.Y, 1e-6, what);
        Check.Near(expected[2], actual.Z, 1e-6, what);
    }

    public static void ChangeOfAxes_IsAReflection()
    {
        Check.Near(-1.0, Determinant(M), 0.0, "determinant");
    }

    public static void Positions_FollowTheMatrix()
    {
        var random = new Random(Runner.Seed);
        for (int i = 0; i < 1000; ++i)
        {
            Vector v = RandomVector(random);
            Same(Times(M, v), UnityAxes.ToUnity(v), "position");
            Vector back = UnityAxes.FromUnity(UnityAxes.ToUnity(v));
            Same(new double[] { v.X, v.Y, v.Z }, back, "and back");
        }
        // Away from the person is forward, left is left, up is up.
        Same(new double[] { 0, 0, 1 }, UnityAxes.ToUnity(new Vector(1, 0, 0)), "forward");
        Same(new double[] { -1, 0, 0 }, UnityAxes.ToUnity(new Vector(0, 1, 0)), "left");
        Same(new double[] { 0, 1, 0 }, UnityAxes.ToUnity(new Vector(0, 0, 1)), "up");
    }

    public static void Rotations_FollowTheMatrix()
    {
        var random = new Random(Runner.Seed);
        for (int i = 0; i < 1000; ++i)
        {
            Rotation q = RandomRotation(random);
            double[,] expected = Times(Times(M, Matrix(q)), Transposed(M));
            double[,] actual = Matrix(UnityAxes.ToUnity(q));
            double[,] back = Matrix(UnityAxes.FromUnity(UnityAxes.ToUnity(q)));
            double[,] start = Matrix(q);
            for (int r = 0; r < 3; ++r)
            {
                for (int c = 0; c < 3; ++c)
                {
                    Check.Near(expected[r, c], actual[r, c], 1e-6, "rotation");
                    Check.Near(start[r, c], back[r, c], 1e-6, "and back");
                }
            }
        }
    }

    public static void AxialVectors_TakeTheOtherSign()
    {
        var random = new Random(Runner.Seed);
        for (int i = 0; i < 1000; ++i)
        {
            Vector v = RandomVector(random);
            double[] expected = Times(M, v);
            for (int k = 0; k < 3; ++k) expected[k] *= Determinant(M);
            Same(expected, UnityAxes.AxialToUnity(v), "axial");
            Vector back = UnityAxes.AxialFromUnity(UnityAxes.AxialToUnity(v));
            Same(new double[] { v.X, v.Y, v.Z }, back, "and back");
        }
    }

    public static void TorqueOfAForce_IsTheSameInBothWorlds()
    {
        // r × f, computed in our axes and carried over, is r' × f' of Unity's own (left-handed) cross
        // product, whose formula is the same.
        var random = new Random(Runner.Seed);
        for (int i = 0; i < 1000; ++i)
        {
            Vector r = RandomVector(random), f = RandomVector(random);
            Vector there = Cross(UnityAxes.ToUnity(r), UnityAxes.ToUnity(f));
            Vector carried = UnityAxes.AxialToUnity(Cross(r, f));
            Same(new double[] { there.X, there.Y, there.Z }, carried, "torque");
        }
    }

    private static Vector Cross(Vector a, Vector b)
    {
        return new Vector(a.Y * b.Z - a.Z * b.Y, a.Z * b.X - a.X * b.Z, a.X * b.Y - a.Y * b.X);
    }
}
