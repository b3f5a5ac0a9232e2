using System;
using System.Collections.Generic;
using System.Reflection;
using NUnit.Framework;
using UnityEngine;
using UnityEngine.Headless;
using Wholehand;
using Wholehand.Unity;
using Wholehand.Unity.Editor;
using Wholehand.Unity.Samples;
using wholehand.protocol;

/// <summary>The objects that components build, and their error messages.</summary>
[Tests]
public static class ComponentTests
{
    // Volume in closed form, or for a convex mesh from the program's own triangles, which are counter-clockwise in
    // right-handed axes.
    private static double Volume(Shape s)
    {
        switch (s.Type)
        {
            case ShapeType.Box: return 8.0 * s.HalfExtentsM.Value.X * s.HalfExtentsM.Value.Y * s.HalfExtentsM.Value.Z;
            case ShapeType.Sphere: return 4.0 / 3.0 * Math.PI * Math.Pow(s.RadiusM, 3);
            case ShapeType.Cylinder: return Math.PI * s.RadiusM * s.RadiusM * s.LengthM;
            case ShapeType.Capsule: return Math.PI * s.RadiusM * s.RadiusM * (s.LengthM + 4.0 / 3.0 * s.RadiusM);
        }
        double sum = 0;
        for (int i = 0; i < s.TrianglesLength; i += 3)
        {
            Vec3 a = s.PointsM((int)s.Triangles(i)).Value, b = s.PointsM((int)s.Triangles(i + 1)).Value,
                c = s.PointsM((int)s.Triangles(i + 2)).Value;
            sum += (a.X * (b.Y * c.Z - b.Z * c.Y) + a.Y * (b.Z * c.X - b.X * c.Z) + a.Z * (b.X * c.Y - b.Y * c.X)) / 6.0;
        }
        return sum;
    }

    public static void SceneOfEveryShape_HasItsBodiesCapsulesAndLimits()
    {
        using (var program = new RealProgram("--udp 0 --port 0 --scene " + Environment.GetEnvironmentVariable("WHOLEHAND_CONFIG") + "/scenes/table.toml"))
        using (var truth = new Truth(program.Port))
        using (var game = new Game(program.Port, true))
        {
            // The game has its own mug, whose look is kept.
            var mug = new GameObject("my mug");
            mug.transform.SetParent(game.World.transform, false);
            mug.AddComponent<WholehandBody>().BodyName = "mug";
            game.FramesUntilDrawn();
            ExpectBodies(game, truth.Scene);
            Check.True(ReferenceEquals(game.World.Body("mug").gameObject, mug), "the game's mug is the scene's");
            Check.Equal(0, mug.GetComponentsInChildrenOf<MeshFilter>(), "and is not drawn over");
            ExpectCapsules(game, truth.Scene);
            ExpectPhysics(game);
            ExpectGizmos(game, truth.Scene);
            Game.NoErrors();
        }
    }

    private static int GetComponentsInChildrenOf<T>(this GameObject o) where T : Component
    {
        return o.transform.GetComponentsInChildren<T>(true).Length;
    }

    private static void ExpectBodies(Game game, Scene scene)
    {
        Check.Equal(scene.BodiesLength, game.World.BodyCount, "bodies");
        int meshes = 0;
        for (int i = 0; i < scene.BodiesLength; ++i)
        {
            Body body = scene.Bodies(i).Value;
            Check.Equal(i, game.World.Body(body.Name).Index, body.Name);
            Check.Equal(body.Fixed, game.World.Body(i).Fixed, body.Name);
            MeshFilter[] drawn = game.World.Body(i).GetComponentsInChildren<MeshFilter>(true);
            for (int s = 0; s < drawn.Length; ++s)
            {
                Shape shape = body.Shapes(s).Value;
                // The corners lie on the surface: a round shape loses some percent of its volume, an edged one nothing.
                bool round = shape.Type != ShapeType.Box && shape.Type != ShapeType.ConvexMesh;
                double expected = Volume(shape);
                Check.Near(round ? 0.98 * expected : expected, Wholehand.Unity.Tests.ShapeMeshesTests.Volume(drawn[s].sharedMesh), (round ? 0.02 : 1e-4) * expected,
                    body.Name + ", " + shape.Type);
                Color color = drawn[s].GetComponent<MeshRenderer>().Block.Color;
                Check.Equal(body.Color, string.Format("#{0:X2}{1:X2}{2:X2}", (int)Math.Round(255 * color.r),
                    (int)Math.Round(255 * color.g), (int)Math.Round(255 * color.b)), "colour");
                if (shape.Type == ShapeType.ConvexMesh) ++meshes;
            }
        }
        Check.True(meshes > 0, "a convex mesh is among them");
    }

    // Compares both ends of every capsule, drawn and for physics, with the scene's capsule in its link.
    private static void ExpectCapsules(Game game, Scene scene)
    {
        CapsuleCollider[] colliders = game.Hand.GetComponentsInChildren<CapsuleCollider>(true);
        Check.Equal(scene.CapsulesLength, colliders.Length, "capsules for physics");
        var byName = new Dictionary<string, CapsuleCollider>();
        foreach (CapsuleCollider c in colliders) byName[c.name] = c;
        for (int i = 0; i < scene.CapsulesLength; ++i)
        {
            Capsule capsule = scene.Capsules(i).Value;
            CapsuleCollider collider = byName[capsule.Name];
            Transform part = collider.transform;
            Check.Equal(game.Hand.Link(capsule.Link).name, part.parent.name, "link of " + capsule.Name);
            Vector3 half = 0.5f * (collider.height - 2.0f * collider.radius) * (part.localRotation * Vector3.up);
            Check.Near(0, (part.localPosition - half - Truth.ToUnity(capsule.AM.Value)).magnitude, 1e-5, capsule.Name + ", one end");
            Check.Near(0, (part.localPosition + half - Truth.ToUnity(capsule.BM.Value)).magnitude, 1e-5, capsule.Name + ", other end");
            Check.Near(capsule.RadiusM, collider.radius, 0, "radius");
            bool isDrawn = false;
            foreach (MeshFilter drawn in game.Hand.Link(capsule.Link).GetComponentsInChildren<MeshFilter>(true))
            {
                isDrawn |= drawn.name == capsule.Name && (drawn.transform.localPosition - part.localPosition).magnitude < 1e-6f;
            }
            Check.True(isDrawn, capsule.Name + " is drawn");
        }
    }

    // Bodies of Unity's physics are where the links are drawn, at most one state later, and have a velocity.
    private static void ExpectPhysics(Game game)
    {
        double fastest = 0, furthest = 0;
        for (int frame = 0; frame < 150; ++frame)
        {
            game.Frame(5);
            foreach (Rigidbody body in game.Hand.GetComponentsInChildren<Rigidbody>(true))
            {
                Check.True(body.isKinematic && !body.useGravity, "kinematic");
                furthest = Math.Max(furthest, (body.transform.position - game.Hand.Link(body.name).position).magnitude);
                if (frame > 10) fastest = Math.Max(fastest, body.Velocity.magnitude);
            }
        }
        Check.True(furthest < 0.01, "capsules are " + furthest + " m off");
        Check.True(fastest > 0.01, "and move");
        int moved = 0;
        foreach (Rigidbody body in game.World.GetComponentsInChildren<Rigidbody>(true))
        {
            if ((body.transform.position - game.World.transform.position).magnitude > 0.01f) ++moved;
        }
        Check.Equal(game.World.BodyCount, moved, "bodies for physics");
    }

    private static void ExpectGizmos(Game game, Scene scene)
    {
        Gizmos.Spheres = Gizmos.Cubes = 0;
        game.Frame();
        Check.Equal(1, Gizmos.Cubes, "the box of x, y, z");
        Check.Equal(scene.AxesLength + game.Connection.World.ContactCount, Gizmos.Spheres, "a mark on each gauge and at each contact");
        Axis x = scene.Axes(0).Value, y = scene.Axes(1).Value, z = scene.Axes(2).Value;
        Check.Near(y.Upper - y.Lower, Math.Abs(Gizmos.LastCubeSize.x), 1e-6, "width");
        Check.Near(z.Upper - z.Lower, Math.Abs(Gizmos.LastCubeSize.y), 1e-6, "height");
        Check.Near(x.Upper - x.Lower, Math.Abs(Gizmos.LastCubeSize.z), 1e-6, "depth");
    }

    public static void BarGame_TakesTheControlsArmsStopsAndLoadsAnotherScene()
    {
        using (var program = new RealProgram("--udp 0 --port 0 --wait"))
        {
            try
            {
                int meshesBefore = Mesh.Alive;
                var bar = new GameObject("Bar").AddComponent<Bar>();
                bar.Port = program.Port;
                WholehandConnection connection = bar.Connection;
                var world = connection.GetComponentsInChildren<WholehandWorld>(true)[0];
                Until(() => connection.HasState && world.BodyCount > 0, "connected");
                Check.Equal(RunState.Disarmed, connection.State.RunState, "it waits");
                Press("Arm", () => bar.Answer != "", "arming without the controls is refused with the reason");
                Press("Take the controls", () => connection.Client.HoldsControls, "the controls");
                var hand = connection.GetComponentsInChildren<WholehandHand>(true)[0];
                var ring = new GameObject("ring");
                ring.transform.SetParent(hand.Link("ring_pip_flexion"), false);
                Press("Arm", () => connection.State.RunState == RunState.Rendering, "rendering");
                ExpectPanel(connection, "Poured: ", "Score: ");
                Until(() => connection.Scene.Value.Session == 1 && hand.DrawnSession == 1, "its scene");
                Check.True(ring && ring.transform.parent == hand.Link("ring_pip_flexion"), "what hangs on a link stays");
                int shown = connection.GetComponentsInChildren<MeshFilter>(true).Length;
                Check.Equal(connection.Scene.Value.CapsulesLength, hand.GetComponentsInChildren<MeshFilter>(true).Length,
                    "capsules of the new scene only");
                Check.Equal(shown, Mesh.Alive - meshesBefore, "meshes of scenes before are destroyed");
                Press("Stop", () => connection.State.RunState == RunState.Stopped, "stopped");
                Check.Equal("", bar.Answer, "nothing was refused");
                WholehandBody glass = world.Body("glass");
                Check.True((bool)glass, "the bar's glass");
                connection.Client.LoadExercise("free-grasping");
                Until(() => world.Body("glass") == null && world.BodyCount > 0, "the scene of free grasping");
                Check.True(!glass, "the glass is removed");
                connection.enabled = false;
                Until(() => !connection.HasState && connection.Client == null, "disabled");
                connection.enabled = true;
                Until(() => connection.HasState, "enabled again");
                Check.True((bool)world.Body(0), "bodies again");
                Press("EMERGENCY STOP", () => connection.State.RunState == RunState.Stopped, "needs no controls");
                Game.NoErrors();
                Player.Quit();
                Check.Equal(meshesBefore, Mesh.Alive, "meshes that are left");
            }
            finally
            {
                GUILayout.Press = "";
                Player.Quit();
            }
        }
    }

    // Labels of config/exercises/cocktail-bar.toml.
    private static void ExpectPanel(WholehandConnection connection, params string[] labels)
    {
        Until(() => connection.State.Values.Length > 0, "values of the exercise");
        foreach (string label in labels)
        {
            string shown = GUILayout.Labels.Find(l => l.StartsWith(label));
            Check.True(shown != null && char.IsDigit(shown[label.Length]), label + " is " + shown);
        }
    }

    private static void Until(Func<bool> condition, string what)
    {
        Check.Until(() =>
        {
            Player.Frame(1, Game.FixedPeriodS);
            return condition();
        }, what);
    }

    // Presses a key for one frame.
    private static void Press(string button, Func<bool> condition, string what)
    {
        GUILayout.Press = button;
        Player.Frame(1, Game.FixedPeriodS);
        GUILayout.Press = "";
        Until(condition, what);
    }

    private static void ExpectError(System.Action make, Func<Behaviour> of, params string[] texts)
    {
        try
        {
            make();
            for (int i = 0; i < 3; ++i) Player.Frame(1, Game.FixedPeriodS);
            Check.Equal(1, Debug.Errors.Count, "one error, once");
            foreach (string text in texts) Check.True(Debug.Errors[0].Contains(text), Debug.Errors[0] + " does not say: " + text);
            Check.True(!of().enabled, "the component is disabled");
        }
        finally
        {
            Player.Quit();
        }
    }

    public static void ComponentsWithoutConnection_ReportWhatToDo()
    {
        Behaviour made = null;
        ExpectError(() => made = new GameObject("lost hand").AddComponent<WholehandHand>(), () => made,
            "WholehandHand on lost hand", "set its field Connection");
        ExpectError(() => made = new GameObject("lost world").AddComponent<WholehandWorld>(), () => made,
            "WholehandWorld on lost world", "set its field Connection");
        ExpectError(() => made = new GameObject("lost gizmos").AddComponent<WholehandGizmos>(), () => made,
            "WholehandGizmos on lost gizmos", "set its field Connection");
    }

    public static void ImpossibleOptions_AreNamed()
    {
        WholehandConnection made = null;
        ExpectError(() =>
        {
            made = new GameObject("fast").AddComponent<WholehandConnection>();
            made.RateHz = 2000;
        }, () => made, "Wholehand Connection on fast", "0 to 1000 Hz");
    }

    public static void ProgramWithoutLinks_IsReportedOnce()
    {
        using (var program = new StandIn())
        using (var game = new Game(program.Port))
        {
            game.FramesUntil(() => Debug.Errors.Count > 0, "an error");
            for (int i = 0; i < 20; ++i) game.Frame();
            Check.Equal(1, Debug.Errors.Count, "once, not in every frame");
            Check.True(Debug.Errors[0].Contains("to the same version"), Debug.Errors[0]);
            game.FramesUntil(() => game.Connection.HasState, "the rest of the game goes on");
            Check.Equal(1, Debug.Errors.Count, "errors");
        }
    }

    public static void ComponentDisabledByAHandler_EndsWithoutErrors()
    {
        using (var program = new StandIn())
        using (var game = new Game(program.Port))
        {
            game.Connection.SceneChanged += s => game.Connection.enabled = false;
            game.FramesUntil(() => game.Connection.SceneNumber == 1, "a scene");
            game.Frame();
            Check.True(!game.Connection.enabled && game.Connection.Client == null, "disabled");
            foreach (string error in Debug.Errors) Check.True(error.Contains("to the same version"), error); // no links
        }
    }

    public static void MissingProgram_IsReportedAndSearchedFor()
    {
        using (var game = new Game(1)) // no program listens at port 1
        {
            game.FramesUntil(() => game.Connection.Message.Contains("no connection to 127.0.0.1:1"), "the message");
            Check.True(!game.Connection.HasState && game.Hand.LinkCount == 0, "nothing is drawn");
            Check.True(double.IsInfinity(game.Connection.SecondsSinceState), "no state");
            Game.NoErrors();
        }
    }

    public static void MenuAndInspector_Work()
    {
        using (var program = new StandIn())
        {
            try
            {
                WholehandMenu.CreateHandAndWorld(new UnityEditor.MenuCommand());
                Transform root = UnityEditor.Selection.activeGameObject.transform;
                var connection = root.GetComponent<WholehandConnection>();
                connection.Port = program.Port;
                int events = 0, scenes = 0;
                string reported = "";
                connection.EventsReceived += e => events += e.Events_Length;
                connection.SceneChanged += s => ++scenes;
                connection.ConnectionChanged += (connected, why) => reported = why;
                connection.ControlsChanged += c => reported += c.HeldByYou ? ", held" : ", not held";
                Until(() => connection.HasState, "a state");
                Until(() => events > 1 && scenes == 1, "events and a scene");
                connection.Client.TakeControls();
                Until(() => reported.StartsWith("connected to Wholehand") && reported.EndsWith(", held"), "notified of line and controls");
                var inspector = new WholehandConnectionEditor { target = connection };
                Until(() =>
                {
                    inspector.OnInspectorGUI();
                    return UnityEditor.EditorGUILayout.Shown.Contains("states by datagram");
                }, "what the inspector says: " + UnityEditor.EditorGUILayout.Shown);
                Check.True(UnityEditor.EditorGUILayout.Shown.StartsWith("Info: connected"), UnityEditor.EditorGUILayout.Shown);
                Check.Equal(1, root.GetComponentsInChildren<WholehandHand>(true).Length, "a hand");
                Check.Equal(1, root.GetComponentsInChildren<WholehandWorld>(true).Length, "a world");
            }
            finally
            {
                Player.Quit();
            }
        }
    }

    // Runs the tests that Unity's test runner would run, found by NUnit's attributes.
    public static void PackagesOwnTests_Pass()
    {
        int passed = 0;
        foreach (Type type in typeof(Wholehand.Unity.Tests.ConversionTests).Assembly.GetTypes())
        {
            foreach (MethodInfo test in type.GetMethods())
            {
                if (test.GetCustomAttributes(typeof(TestAttribute), false).Length == 0) continue;
                test.Invoke(Activator.CreateInstance(type), null);
                ++passed;
            }
        }
        Check.Equal(5, passed, "tests");
    }
}
