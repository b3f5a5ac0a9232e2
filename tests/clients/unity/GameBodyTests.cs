using System;
using System.Collections.Generic;
using System.Threading.Tasks;
using UnityEngine;
using UnityEngine.Headless;
using Wholehand;
using Wholehand.Unity;
using wholehand.protocol;

/// <summary>Bodies that a game spawns with the package's components, with the real program (game_table.toml: a table
/// beside the hand, its top at 0.02 m). Positions are in the game's world, in which Wholehand's world is
/// rotated.</summary>
[Tests]
public static class GameBodyTests
{
    private const float RadiusM = 0.03f, TopM = 0.02f;
    private static readonly Vector AboveM = new Vector(0.5f, 0.3f, 0.17f); // in the program's axes

    private sealed class Play : IDisposable
    {
        public readonly Game Game;
        public readonly Truth Truth;
        public readonly List<BodyEvent> Events = new List<BodyEvent>();
        private readonly RealProgram program;

        public Play(bool physics = false, string exercise = null)
        {
            program = new RealProgram("--udp 0 --port 0 --wait --exercise \""
                + (exercise ?? Environment.GetEnvironmentVariable("WHOLEHAND_GAME_TABLE")) + "\"");
            Game = new Game(program.Port, physics);
            Game.Connection.BodyEventReceived += Events.Add;
            Game.FramesUntil(() => Game.Connection.HasState, "a state");
            Accepted(Game.Connection.Client.TakeControls());
            Accepted(Game.Connection.Client.Arm(Game.Connection.State.Endings, Game.Connection.State.Basis));
            Game.FramesUntil(() => Game.Hand.DrawnSession == 1, "it renders");
            Truth = new Truth(program.Port);
        }

        /// <summary>Runs frames while the game waits for an answer.</summary>
        public CommandReply Ended(Task<CommandReply> command)
        {
            Game.FramesUntil(() => command.IsCompleted, "the command is answered");
            return command.Result;
        }

        public void Accepted(Task<CommandReply> command)
        {
            CommandReply reply = Ended(command);
            Check.True(reply.Accepted, reply.Reason);
        }

        public BodyEvent Becomes(BodyEventKind kind, uint slot)
        {
            int found = -1;
            Game.FramesUntil(() => (found = Events.FindIndex(e => e.Kind == kind && e.Slot == slot)) >= 0, slot + ": " + kind);
            BodyEvent happened = Events[found];
            Events.RemoveAt(found);
            return happened;
        }

        public Vector3 InGame(Vector programs)
        {
            return Game.World.transform.TransformPoint(new Vector3(-programs.Y, programs.Z, programs.X));
        }

        public void Dispose()
        {
            Truth.Dispose();
            Game.Dispose();
            program.Dispose();
        }
    }

    public static void SpawnedBall_FallsRestsIsDrawnAndRemoved()
    {
        int meshesBefore = Mesh.Alive;
        using (var play = new Play(true))
        {
            WholehandWorld world = play.Game.World;
            play.Game.FramesUntil(() => world.DrawnTick != ulong.MaxValue, "the scene is drawn");
            Check.Equal(2, world.BodyCount, "bodies of the scene");
            int meshesOfTheScene = Mesh.Alive;
            play.Accepted(world.PrepareShapes(0, BodyShapes.Ball(RadiusM)));
            var ball = new BodyToSpawn { Slot = 1, Generation = 5 };
            play.Accepted(world.Spawn(ball, play.InGame(AboveM), world.transform.rotation));
            Check.Equal(5u, play.Becomes(BodyEventKind.Solid, 1).Generation, "generation");
            play.Game.FramesUntil(() => world.GameBody(ball.Id) != null, "it is drawn");
            WholehandBody drawn = world.GameBody(ball.Id);
            MeshFilter[] meshes = drawn.GetComponentsInChildren<MeshFilter>(true);
            Check.Equal(1, meshes.Length, "meshes");
            Check.Near(RadiusM, meshes[0].sharedMesh.vertices[0].magnitude, 1e-6, "radius of the mesh");
            int resting = 0;
            Vector3 restM = play.InGame(new Vector(AboveM.X, AboveM.Y, TopM + RadiusM));
            play.Game.FramesUntil(() =>
            {
                System.Threading.Thread.Sleep(5);
                resting = (drawn.transform.position - restM).magnitude < 0.002 ? resting + 1 : 0;
                return resting >= 50;
            }, "it rests on the table");
            Check.Equal(SlotState.Solid, drawn.State, "state");
            ExpectDrawnWhereTheProgramSays(play, drawn);
            SphereCollider collider = world.GetComponentsInChildren<SphereCollider>(true)[0];
            Check.Near(RadiusM, collider.radius, 1e-6, "radius for physics");
            Check.Near(0, (collider.transform.position - restM).magnitude, 0.002, "its place");
            play.Accepted(world.Remove(ball.Id));
            play.Becomes(BodyEventKind.Left, 1);
            play.Game.FramesUntil(() => world.GameBodyCount == 0, "it is gone");
            play.Game.Frame();
            Check.True(!drawn, "its object is destroyed");
            Check.Equal(0, world.GetComponentsInChildren<SphereCollider>(true).Length, "and what physics had of it");
            Check.Equal(meshesOfTheScene, Mesh.Alive, "its mesh, too");
            Game.NoErrors();
        }
        Check.Equal(meshesBefore, Mesh.Alive, "meshes that are left");
    }

    private static void ExpectDrawnWhereTheProgramSays(Play play, WholehandBody drawn)
    {
        Truth.Place before = new Truth.Place(), after;
        float share;
        ulong tick = play.Game.World.DrawnTick;
        Check.Until(() => play.Truth.Around(p => (long)p.Tick, 1000, (long)tick, out before, out after, out share), "the truth");
        Check.Equal(2 + 1 + 1, before.Bodies.Length, "bodies of the scene, and slots 0 and 1");
        var at = new Truth.Frame(drawn.transform, play.Game.World.transform);
        Check.Near(0, (at.At - before.Bodies[3].At).magnitude, 1e-4, "where the program has it");
    }

    // A scene without its own bodies: there, too, the last body that leaves must no longer be drawn.
    public static void DrivenBody_FollowsItsTargetWithTheGamesOwnLook()
    {
        using (var play = new Play(false, Environment.GetEnvironmentVariable("WHOLEHAND_CONFIG") + "/exercises/game-scene.toml"))
        {
            WholehandWorld world = play.Game.World;
            // The shape is twice as wide to the right as it is high, so its axes matter.
            play.Accepted(world.PrepareShapes(4, BodyShapes.Box(new Vector3(0.04f, 0.02f, 0.03f)),
                BodyShapes.Convex(ShapeMeshes.Box(new Vector3(0.01f, 0.01f, 0.01f))).At(new Vector3(0, 0.02f, 0), Quaternion.identity)));
            var own = new GameObject("my cart").AddComponent<WholehandBody>();
            own.transform.SetParent(world.transform, false);
            var cart = new BodyToSpawn { Slot = 3, ShapeSet = 4, Owner = BodyOwner.Game };
            own.GameId = cart.Id;
            play.Accepted(world.Spawn(cart, play.InGame(AboveM), world.transform.rotation));
            play.Becomes(BodyEventKind.Solid, 3);
            play.Game.FramesUntil(() => world.GameBodyCount == 1, "it is drawn");
            Check.True(ReferenceEquals(own, world.GameBody(0)), "the game's own object is moved");
            Check.Equal(0, own.GetComponentsInChildren<MeshFilter>(true).Length, "and not drawn over");
            ExpectPieces(play);
            Vector3 goal = play.InGame(new Vector(AboveM.X, AboveM.Y + 0.08f, AboveM.Z));
            Quaternion turned = world.transform.rotation * Quaternion.AngleAxis(60.0f, new Vector3(0, 1, 0));
            own.SetTarget(goal, turned);
            play.Game.FramesUntil(() => (own.transform.position - goal).magnitude < 0.002
                && (own.transform.rotation * new Vector3(1, 0, 0) - turned * new Vector3(1, 0, 0)).magnitude < 0.01, "the target is reached");
            own.ClearTarget();
            play.Accepted(world.SetOwner(cart.Id, BodyOwner.Fixed));
            play.Accepted(world.Teleport(cart.Id, play.InGame(AboveM), turned));
            play.Game.FramesUntil(() => (own.transform.position - play.InGame(AboveM)).magnitude < 1e-5, "it is put elsewhere");
            play.Accepted(world.Remove(cart.Id));
            play.Game.FramesUntil(() => world.GameBodyCount == 0, "it leaves");
            Check.True((bool)own && own.Index == -1, "the game's own object stays");
            Game.NoErrors();
        }
    }

    public static void RegisteredBody_IsTheSameObjectInAndOutOfReach()
    {
        using (var play = new Play(true))
        {
            WholehandWorld world = play.Game.World;
            play.Accepted(world.PrepareShapes(0, BodyShapes.Ball(RadiusM)));
            Vector nearM = new Vector(0.1f, 0.25f, 0.2f), farM = new Vector(3.0f, 0.5f, 0.0f);
            var still = new BodyToSpawn { Slot = 1000, Generation = 6, Owner = BodyOwner.Fixed };
            var driven = new BodyToSpawn { Slot = 2000, Generation = 7, Owner = BodyOwner.Game };
            play.Accepted(world.Spawn(still, play.InGame(nearM), world.transform.rotation));
            play.Accepted(world.Spawn(driven, play.InGame(farM), world.transform.rotation));
            play.Game.FramesUntil(() => world.GameBodyCount == 2 && IsAt(world.GameBody(driven.Id), play.InGame(farM))
                && IsAt(world.GameBody(still.Id), play.InGame(nearM)) && world.GameBody(still.Id).Index >= 0, "both are drawn");
            WholehandBody there = world.GameBody(driven.Id), here = world.GameBody(still.Id);
            Check.Equal(Whereabouts.OutOfReach, there.Whereabouts, "far away");
            Check.Equal(-1, there.Index, "without a slot");
            Check.Equal(Whereabouts.InSlot, here.Whereabouts, "near");
            Check.Equal(6u, play.Becomes(BodyEventKind.Solid, (uint)(here.Index - world.BodyCount)).Body.Generation, "whose event");
            var goalM = new Vector(2.0f, -0.5f, 1.0f);
            there.SetTarget(play.InGame(goalM), world.transform.rotation);
            play.Game.FramesUntil(() => IsAt(there, play.InGame(goalM)), "out of reach it is at its target at once");
            there.ClearTarget();
            var besideM = new Vector(0.1f, 0.25f, 0.4f);
            play.Accepted(world.Teleport(driven.Id, play.InGame(besideM), world.transform.rotation));
            play.Game.FramesUntil(() => there.Index >= 0 && IsAt(there, play.InGame(besideM)), "it has come near, and has a slot");
            Check.Equal(2, world.GameBodyCount, "no other object stands for it");
            play.Game.FramesUntil(() => (world.GetComponentsInChildren<SphereCollider>(true)[1].transform.position
                - play.InGame(besideM)).magnitude < 1e-4, "and physics has it there");
            play.Accepted(world.Teleport(driven.Id, play.InGame(farM), world.transform.rotation));
            play.Game.FramesUntil(() => there.Index < 0 && IsAt(there, play.InGame(farM)), "and is far again");
            play.Accepted(world.Remove(driven.Id));
            play.Accepted(world.Remove(still.Id));
            play.Game.FramesUntil(() => world.GameBodyCount == 0, "they are gone");
            play.Game.Frame();
            Check.True(!there && !here, "their objects are destroyed");
            Game.NoErrors();
        }
    }

    private static bool IsAt(WholehandBody drawn, Vector3 place)
    {
        return drawn && (drawn.transform.position - place).magnitude < 1e-4;
    }

    // Compares the program's shapes by volume: a box in closed form, and a mesh of 12 triangles with 8 corners.
    private static void ExpectPieces(Play play)
    {
        Check.True(play.Game.Connection.Client.TryGetShapes(play.Game.Connection.Bodies.Shapes[0], out GameShapes shapes), "shapes");
        Shape box = shapes.Pieces(0).Value, mesh = shapes.Pieces(1).Value;
        Check.Near(0.015, box.HalfExtentsM.Value.X, 1e-6, "away from the person: Unity's z");
        Check.Near(0.02, box.HalfExtentsM.Value.Y, 1e-6, "left: Unity's -x");
        Check.Near(0.01, box.HalfExtentsM.Value.Z, 1e-6, "up: Unity's y");
        Check.Equal(8, mesh.PointsMLength, "corners");
        Check.Near(0.02, mesh.InBody.Value.PositionM.Z - box.InBody.Value.PositionM.Z, 1e-6, "0.02 m above the box");
    }

    public static void RefusedOrders_ReportTheReason()
    {
        using (var play = new Play())
        {
            WholehandWorld world = play.Game.World;
            play.Accepted(world.PrepareShapes(0, BodyShapes.Capsule(0.02f, 0.1f)));
            play.Accepted(world.Spawn(new BodyToSpawn { Slot = 9, Owner = BodyOwner.Fixed }, play.InGame(AboveM), world.transform.rotation));
            play.Game.FramesUntil(() => world.GameBodyCount == 1, "one is good");
            CommandReply far = play.Ended(world.Spawn(new BodyToSpawn(), play.InGame(new Vector(9, 0, 0)), world.transform.rotation));
            Check.Equal(Refusal.BodiesRefused, far.Refusal, far.Reason);
            Check.Equal(BodyRefusal.BadPose, far.Items[0].Refusal, far.Items[0].Reason);
            Check.True(far.Items[0].Reason != "", "in words");
            play.Accepted(world.Remove(new BodyId(6, 1)));
            Check.Equal(BodyRefusal.WrongGeneration, play.Becomes(BodyEventKind.Refused, 6).Refusal, "there is none");
            play.Accepted(play.Game.Connection.Client.Stop());
            play.Game.FramesUntil(() => world.GameBodyCount == 0, "bodies end with their session");
            play.Game.Connection.enabled = false;
            play.Game.Frame();
            Check.Equal("not connected", play.Ended(world.Remove(new BodyId(0, 1))).Reason, "without a connection");
        }
    }

    public static void FramesWith64Bodies_AllocateNothing()
    {
        using (var play = new Play())
        {
            WholehandWorld world = play.Game.World;
            play.Accepted(world.PrepareShapes(0, BodyShapes.Box(new Vector3(0.02f, 0.02f, 0.02f))));
            for (uint i = 0; i < 64; ++i)
            {
                // A grid of fixed bodies beside the hand; fixed bodies do not count for the budget of moving ones.
                var at = new Vector(0.4f + 0.03f * (i % 8), 0.2f + 0.03f * (i / 8), 0.3f);
                play.Accepted(world.Spawn(new BodyToSpawn { Slot = i, Owner = BodyOwner.Fixed }, play.InGame(at), world.transform.rotation));
            }
            play.Game.FramesUntil(() => world.GameBodyCount == 64, "64 bodies are drawn");
            play.Becomes(BodyEventKind.Solid, 63);
            for (int i = 0; i < 200; ++i) play.Game.Frame();
            int drawn = 0;
            ulong tick = 0;
            long sum = Game.AllocatedIn(500, () =>
            {
                if (world.DrawnTick != tick) ++drawn;
                tick = world.DrawnTick;
            });
            Console.WriteLine("figure: Unity package under mono, 500 frames with 64 bodies of a game, {0} new states of them: {1} bytes "
                + "allocated", drawn, sum);
            Check.True(drawn > 20, "new states are drawn");
            Check.Equal(0L, sum, "bytes allocated");
            Game.NoErrors();
        }
    }
}
