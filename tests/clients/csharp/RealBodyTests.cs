using System;
using System.Collections.Concurrent;
using System.Collections.Generic;
using System.Linq;
using Wholehand;
using wholehand.protocol;
using static Answers;

/// <summary>Bodies of a game with the real program, in a scene that has its own bodies (game_table.toml).
/// unity/GameBodyTests.cs tests with the same client how bodies fall, follow and are teleported.</summary>
[Tests]
public static class RealBodyTests
{
    private const float RadiusM = 0.03f;
    private static readonly Vector Above = new Vector(0.5f, 0.3f, 0.17f);
    private static readonly Vector OverTheHand = new Vector(0.034f, 0.0f, 0.15f); // above the hand at the device's zero

    /// <summary>A client that holds the controls of a rendering program.</summary>
    private sealed class Play : IDisposable
    {
        public readonly WholehandClient Client;
        public readonly WorldSnapshot World = new WorldSnapshot();
        public readonly BodySlots Slots = new BodySlots();
        private readonly RealProgram program;
        private readonly ConcurrentQueue<BodyEvent> events = new ConcurrentQueue<BodyEvent>();

        public Play(bool armed = true)
        {
            program = new RealProgram("--udp 0 --port 0 --wait --exercise \""
                + Environment.GetEnvironmentVariable("WHOLEHAND_GAME_TABLE") + "\"");
            Client = new WholehandClient(new ClientOptions { Port = program.Port });
            Client.BodyEventReceived += events.Enqueue;
            Client.Connect();
            var state = new HandState();
            Check.Until(() => Client.LatestScene.HasValue && Client.TryGetState(state), "a state");
            Accepted(Client.TakeControls());
            if (!armed) return;
            Accepted(Client.Arm(state.Endings, state.Basis));
            Check.Until(() => Client.TryGetState(state) && state.RunState == RunState.Rendering
                && Client.LatestScene.Value.Session == state.Session, "it renders");
        }

        public BodyEvent Becomes(BodyEventKind kind, uint slot)
        {
            BodyEvent found = new BodyEvent();
            Check.Until(() => events.TryDequeue(out found) && found.Kind == kind && found.Slot == slot, slot + ": " + kind);
            return found;
        }

        /// <summary>Position of a body from the list of all bodies.</summary>
        public bool TryGetPlace(BodyId body, out Vector position)
        {
            position = new Vector();
            Client.TryGetBodies(Slots);
            Client.TryGetWorld(World);
            int found = Slots.FindInAll(body);
            return found >= 0 && Slots.TryGetPlace(found, World, out position, out Rotation turn);
        }

        public Whereabouts WhereIs(BodyId body)
        {
            Client.TryGetBodies(Slots);
            int found = Slots.FindInAll(body);
            return found < 0 ? Whereabouts.Gone : Slots.All[found].Whereabouts;
        }

        public bool TryTakeEvent(out BodyEvent happened)
        {
            return events.TryDequeue(out happened);
        }

        public void Dispose()
        {
            Client.Dispose();
            program.Dispose();
        }
    }

    public static void BallFallingOnTheHand_ReportsItsTouch()
    {
        using (var play = new Play())
        {
            Accepted(play.Client.PrepareShapes(0, BodyShape.Ball(RadiusM)));
            var ball = new BodyToSpawn { Slot = 1, Generation = 9, ShapeSet = 0, MassKg = 0.2f, PositionM = OverTheHand };
            Accepted(play.Client.Spawn(ball));
            BodyEvent touched = play.Becomes(BodyEventKind.Touched, 1);
            Check.Equal(9u, touched.Generation, "generation");
            // The ball falls 0.15 m at most: 1.7 m/s.
            Check.True(touched.ImpulseNs > 0.005 && touched.ImpulseNs < 0.2 * 1.7, "impulse: " + touched.ImpulseNs);
            Check.Equal(BodyRefusal.None, touched.Refusal, "refusal");
        }
    }

    private static double Distance(Vector a, Vector b)
    {
        return Math.Sqrt(Math.Pow(a.X - b.X, 2) + Math.Pow(a.Y - b.Y, 2) + Math.Pow(a.Z - b.Z, 2));
    }

    public static void RegisteredBodies_ExistAndAreSimulatedNearTheHand()
    {
        using (var play = new Play())
        {
            Accepted(play.Client.PrepareShapes(0, BodyShape.Ball(RadiusM)));
            var bodies = new BodyToSpawn[64];
            for (uint i = 0; i < 3; ++i)
            {
                bodies[i] = new BodyToSpawn { Slot = 1000 + i, Owner = BodyOwner.Fixed, PositionM = new Vector(0.1f, 0.25f, 0.1f * i) };
            }
            for (uint i = 3; i < 64; ++i)
            {
                bodies[i] = new BodyToSpawn { Slot = 2000 + i, Generation = 4, PositionM = new Vector(3.0f, 0.05f * i, 0.0f) };
            }
            Accepted(play.Client.Spawn(bodies));
            Check.Until(() => Enumerable.Range(0, 3).All(i => play.WhereIs(bodies[i].Id) == Whereabouts.InSlot), "the near ones have slots");
            Check.Equal(64, play.Slots.AllCount, "bodies");
            Check.True(bodies.Skip(3).All(b => play.WhereIs(b.Id) == Whereabouts.OutOfReach), "the others are out of reach");
            foreach (BodyToSpawn body in new[] { bodies[1], bodies[63] })
            {
                Vector at = new Vector();
                Check.Until(() => play.TryGetPlace(body.Id, out at) && Distance(at, body.PositionM) < 1e-6, body.Slot + ": its place");
            }
            BodyEvent solid = new BodyEvent();
            Check.Until(() => play.TryTakeEvent(out solid) && solid.Kind == BodyEventKind.Solid && solid.Body.Slot == 1001, "an event");
            Check.Equal(1u, solid.Body.Generation, "the game's own generation");
            Check.True(solid.Slot < 64, "in a slot");
            CommandReply again = Ended(play.Client.Spawn(new BodyToSpawn { Slot = 1000, PositionM = Above }));
            Check.Equal(BodyRefusal.SlotTaken, again.Items[0].Refusal, again.Reason);
            var there = new Vector(0.1f, 0.25f, 0.3f);
            Accepted(play.Client.Teleport(new BodyAt(bodies[63].Id, there)));
            Check.Until(() => play.WhereIs(bodies[63].Id) == Whereabouts.InSlot, "it is in reach");
            Accepted(play.Client.Remove(bodies[0].Id, bodies[62].Id));
            Check.Until(() => play.Client.TryGetBodies(play.Slots) && play.Slots.AllCount == 62, "two are gone");
            Check.True(play.Slots.FindInAll(bodies[0].Id) < 0 && play.Slots.FindInAll(bodies[62].Id) < 0, "these");
        }
    }

    public static void RefusedOrders_AreNamedWithTheReason()
    {
        using (var play = new Play(false))
        {
            CommandReply early = Ended(play.Client.SetOwner(new BodyOwnerChange(new BodyId(0, 1), BodyOwner.Loop)));
            Check.True(!early.Accepted && early.Reason != "", "before anything is armed");
            Check.Equal(Refusal.NothingArmed, early.Refusal, early.Reason);
            CommandReply kept = Ended(play.Client.PrepareShapes(0, BodyShape.Ball(RadiusM)));
            Check.True(kept.Accepted && kept.Reason.Contains("kept for the next arming"), "it says what becomes of it: " + kept.Reason);
        }
        using (var play = new Play())
        {
            Vector[] corners = { new Vector(), new Vector(0.05f, 0, 0), new Vector(0, 0.05f, 0), new Vector(0, 0, 0.05f) };
            uint[] faces = { 0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3 };
            Accepted(play.Client.PrepareShapes(1, BodyShape.Mesh(corners, faces)));
            var open = new uint[9];
            Array.Copy(faces, 3, open, 0, 9);
            CommandReply bad = Ended(play.Client.PrepareShapes(0, BodyShape.Mesh(corners, open), BodyShape.Ball(RadiusM)));
            Check.Equal(Refusal.BodiesRefused, bad.Refusal, bad.Reason);
            Check.Equal(1, bad.Items.Length, "items");
            Check.Equal(BodyRefusal.BadShapes, bad.Items[0].Refusal, bad.Items[0].Reason);
            Check.True(bad.Items[0].Slot == -1 && bad.Items[0].Reason.Contains("watertight"), bad.Items[0].Reason);
            CommandReply spawn = Ended(play.Client.Spawn(
                new BodyToSpawn { Slot = 0, ShapeSet = 1, PositionM = Above },
                new BodyToSpawn { Slot = 1, ShapeSet = 1, PositionM = new Vector(9, 0, 0) },
                new BodyToSpawn { Slot = 64, ShapeSet = 1, PositionM = Above }));
            Check.Equal(2, spawn.Items.Length, "items of the spawn");
            Check.Equal(BodyRefusal.BadPose, spawn.Items[0].Refusal, spawn.Items[0].Reason);
            Check.True(spawn.Items[0].Index == 1 && spawn.Items[0].Slot == 1, "which");
            Check.Equal(BodyRefusal.NoSuchSlot, spawn.Items[1].Refusal, spawn.Items[1].Reason);
            Check.True(spawn.Items[1].Index == 2 && spawn.Items[1].Slot == 64, "which");
            play.Becomes(BodyEventKind.Solid, 0); // the valid order
            Accepted(play.Client.Remove(new BodyId(0, 3)));
            Check.Equal(BodyRefusal.WrongGeneration, play.Becomes(BodyEventKind.Refused, 0).Refusal, "of the loop");
            Check.True(Ended(play.Client.Spawn(new BodyToSpawn { Slot = 70000 })).Reason.Contains("70000"), "no such slot");
            Accepted(play.Client.ReleaseControls());
            CommandReply foreign = Ended(play.Client.Remove(new BodyId(0, 1)));
            Check.Equal(Refusal.NotHolder, foreign.Refusal, foreign.Reason);
        }
    }
}
