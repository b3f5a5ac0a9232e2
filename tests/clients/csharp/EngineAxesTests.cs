using System;
using System.Globalization;
using System.IO;
using Wholehand;

/// <summary>Compares the table of axes with the engines' manuals: where forward, left and up of the person are in each,
/// and the matrices that follow: a rotation R becomes M R Mᵀ, an axial vector det(M) M v.</summary>
[Tests]
public static class EngineAxesTests
{
    private sealed class Manual
    {
        public string Name;
        public EngineAxes Axes;
        public Vector Forward, Left, Up; // of length 1
        public double Unit;
    }

    private static Vector V(float x, float y, float z)
    {
        return new Vector(x, y, z);
    }

    // Unity: Vector3.forward, left, up. Unreal: FVector::ForwardVector, -RightVector, UpVector, centimetres.
    // Godot: Vector3.FORWARD, LEFT, UP. three.js: a camera looks along -z, up is y. ROS: REP 103.
    private static readonly Manual[] Manuals =
    {
        new Manual { Name = "Unity", Axes = EngineAxes.Unity, Forward = V(0, 0, 1), Left = V(-1, 0, 0), Up = V(0, 1, 0), Unit = 1 },
        new Manual { Name = "Unreal", Axes = EngineAxes.Unreal, Forward = V(1, 0, 0), Left = V(0, -1, 0), Up = V(0, 0, 1), Unit = 100 },
        new Manual { Name = "Godot", Axes = EngineAxes.Godot, Forward = V(0, 0, -1), Left = V(-1, 0, 0), Up = V(0, 1, 0), Unit = 1 },
        new Manual { Name = "three.js", Axes = EngineAxes.ThreeJs, Forward = V(0, 0, -1), Left = V(-1, 0, 0), Up = V(0, 1, 0), Unit = 1 },
        new Manual { Name = "ROS", Axes = EngineAxes.Ros, Forward = V(1, 0, 0), Left = V(0, 1, 0), Up = V(0, 0, 1), Unit = 1 }
    };

    private static double Dot(Vector a, Vector b)
    {
        return a.X * b.X + a.Y * b.Y + a.Z * b.Z;
    }

    private static Vector Cross(Vector a, Vector b)
    {
        return V(a.Y * b.Z - a.Z * b.Y, a.Z * b.X - a.X * b.Z, a.X * b.Y - a.Y * b.X);
    }

    private static Vector Times(float s, Vector v)
    {
        return V(s * v.X, s * v.Y, s * v.Z);
    }

    private static Vector Sum(Vector a, Vector b)
    {
        return V(a.X + b.X, a.Y + b.Y, a.Z + b.Z);
    }

    // M v; the columns of M are forward, left and up.
    private static Vector Change(Manual m, Vector v)
    {
        return Sum(Sum(Times(v.X, m.Forward), Times(v.Y, m.Left)), Times(v.Z, m.Up));
    }

    // Rotates a vector by the textbook's matrix of a unit quaternion, which is the same in left-handed axes.
    private static Vector Turned(Rotation q, Vector v)
    {
        var u = V(q.X, q.Y, q.Z);
        return Sum(Sum(Times(2 * (float)Dot(u, v), u), Times(q.W * q.W - (float)Dot(u, u), v)), Times(2 * q.W, Cross(u, v)));
    }

    private static void Same(Vector expected, Vector actual, string what)
    {
        Check.Near(expected.X, actual.X, 2e-6, what);
        Check.Near(expected.Y, actual.Y, 2e-6, what);
        Check.Near(expected.Z, actual.Z, 2e-6, what);
    }

    private static Vector Some(Random random)
    {
        return V((float)random.NextDouble() - 0.5f, (float)random.NextDouble() - 0.5f, (float)random.NextDouble() - 0.5f);
    }

    public static void EveryEngine_IsInTheTest()
    {
        Check.Equal(EngineAxes.Engines.Length, Manuals.Length, "engines");
        for (int i = 0; i < Manuals.Length; ++i)
        {
            Check.True(ReferenceEquals(EngineAxes.Engines[i], Manuals[i].Axes), Manuals[i].Name);
            Check.Equal(Manuals[i].Name, EngineAxes.Engines[i].Name, "name");
        }
    }

    public static void VectorsAndRotations_FollowTheManuals()
    {
        var random = new Random(Runner.Seed);
        foreach (Manual m in Manuals)
        {
            double determinant = Dot(Cross(m.Forward, m.Left), m.Up);
            Check.Near(determinant, m.Axes.Handedness, 0, m.Name + ", handedness");
            Check.Near(m.Unit, m.Axes.UnitsPerMetre, 0, m.Name + ", unit");
            for (int i = 0; i < 300; ++i)
            {
                Vector v = Some(random), r = Some(random), there = Change(m, v);
                Same(there, m.Axes.Polar(v), m.Name + ", direction");
                Same(v, m.Axes.PolarFrom(there), m.Name + ", direction back");
                Vector position = m.Axes.Position(v);
                Same(there, Times((float)(1.0 / m.Unit), position), m.Name + ", position");
                Same(v, m.Axes.PositionFrom(position), m.Name + ", position back");
                // A converted torque r × f is the cross product of the converted vectors.
                Same(Cross(m.Axes.Polar(r), there), m.Axes.Axial(Cross(r, v)), m.Name + ", torque");
                Same(r, m.Axes.AxialFrom(m.Axes.Axial(r)), m.Name + ", axial back");
                float w = (float)random.NextDouble(), n = (float)Math.Sqrt(Dot(r, r) + w * w);
                var q = new Rotation(r.X / n, r.Y / n, r.Z / n, w / n);
                // Rotating and then converting gives the same as converting and then rotating.
                Same(Change(m, Turned(q, v)), Turned(m.Axes.Orientation(q), there), m.Name + ", orientation");
                Rotation back = m.Axes.OrientationFrom(m.Axes.Orientation(q));
                Same(V(q.X, q.Y, q.Z), V(back.X, back.Y, back.Z), m.Name + ", orientation back");
            }
        }
    }

    public static void Document_ContainsTheTable()
    {
        string page = Environment.GetEnvironmentVariable("WHOLEHAND_AXES_PAGE");
        if (page == null) return;
        string text = File.ReadAllText(page);
        foreach (EngineAxes axes in EngineAxes.Engines)
        {
            string row = string.Format(CultureInfo.InvariantCulture, "| {0} | {1} | {2} | {3} | {4} | {5} |", axes.Name,
                axes.Handedness > 0 ? "right" : "left", axes.Sources[0], axes.Sources[1], axes.Sources[2], axes.UnitsPerMetre);
            Check.True(text.Contains(row), page + " lacks the row: " + row);
        }
    }
}
