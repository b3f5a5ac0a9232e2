using System;
using System.Collections.Generic;
using FlatBuffers;
using Wholehand;
using wholehand.protocol;

/// <summary>Registered bodies of a game, with messages made by the test.</summary>
[Tests]
public static class BodyListTests
{
    private struct Reported
    {
        public uint Number, Generation;
        public int Slot;
        public Whereabouts Where;
        public float X;
    }

    private static Reported Stands(uint number, float x, uint generation = 5)
    {
        return new Reported { Number = number, Generation = generation, Slot = -1, Where = Whereabouts.OutOfReach, X = x };
    }

    private static Reported InSlot(uint number, int slot, float x)
    {
        return new Reported { Number = number, Generation = 5, Slot = slot, Where = Whereabouts.InSlot, X = x };
    }

    private static Reported Gone(uint number)
    {
        return new Reported { Number = number, Slot = -1, Where = Whereabouts.Gone };
    }

    /// <summary>Bodies in slots have generation 70 + slot and shapes 3, which the message contains if <paramref
    /// name="shapes"/>.</summary>
    private static byte[] Message(uint[] inSlots, Reported[] registered, bool shapes = false)
    {
        var b = new FlatBufferBuilder(4096);
        VectorOffset set = new VectorOffset();
        if (shapes)
        {
            GameShapes.StartGameShapes(b);
            GameShapes.AddId(b, 3);
            set = GameBodies.CreateNewShapesVector(b, new[] { GameShapes.EndGameShapes(b) });
        }
        GameBodies.StartBodiesVector(b, inSlots.Length);
        for (int i = inSlots.Length - 1; i >= 0; --i) GameBody.CreateGameBody(b, inSlots[i], 70 + inSlots[i], 3, SlotState.Solid);
        VectorOffset bodies = b.EndVector();
        GameBodies.StartRegisteredVector(b, registered.Length);
        for (int i = registered.Length - 1; i >= 0; --i)
        {
            Reported body = registered[i];
            RegisteredBody.CreateRegisteredBody(b, body.Number, body.Generation, 3, body.Slot, body.Where, body.X, 0, 0, 0, 0, 0, 1);
        }
        VectorOffset numbers = b.EndVector();
        return MadeUpProgram.Finished(b, Payload.GameBodies, GameBodies.CreateGameBodies(b, 1, bodies, set, numbers).Value);
    }

    /// <summary>A state whose bodies have these x; -1: the slot is empty, and its body far below.</summary>
    private static byte[] State(params int[] x)
    {
        var b = new FlatBufferBuilder(4096);
        WorldState.StartBodiesVector(b, x.Length);
        for (int i = x.Length - 1; i >= 0; --i) Pose.CreatePose(b, x[i], 0, x[i] < 0 ? -10 : 0, 0, 0, 0, 1);
        VectorOffset poses = b.EndVector();
        WorldState.StartWorldState(b);
        WorldState.AddSession(b, 1);
        WorldState.AddTick(b, ++tick);
        WorldState.AddBodies(b, poses);
        return MadeUpProgram.Finished(b, Payload.WorldState, WorldState.EndWorldState(b).Value);
    }

    private static ulong tick;

    private sealed class Game : IDisposable
    {
        public readonly WholehandClient Client = new WholehandClient(new ClientOptions { RateHz = 0 });
        public readonly BodySlots Slots = new BodySlots();
        public readonly WorldSnapshot World = new WorldSnapshot();

        public void Hear(byte[] message)
        {
            Client.Hear(message, message.Length, 1);
            Client.TryGetBodies(Slots);
            Client.TryGetWorld(World);
        }

        /// <summary>"name generation: x" of each body; "?" if its place is not known.</summary>
        public string Bodies()
        {
            var all = new List<string>();
            for (int i = 0; i < Slots.AllCount; ++i)
            {
                string where = Slots.TryGetPlace(i, World, out Vector at, out Rotation turn) ? ((int)at.X).ToString() : "?";
                all.Add(Slots.All[i].Id.Slot + " " + Slots.All[i].Id.Generation + ": " + where);
            }
            return string.Join(", ", all.ToArray());
        }

        public bool HasShapes()
        {
            return Client.TryGetShapes(3, out GameShapes found);
        }

        public void Dispose()
        {
            Client.Dispose();
        }
    }

    private static readonly Reported[] NoNews = new Reported[0];

    public static void RegisteredBody_IsTheSameInAndOutOfASlot()
    {
        using (var game = new Game())
        {
            game.Hear(State(0, 11, -1, -1, 14));
            game.Hear(Message(new uint[] { 1 }, new[] { Stands(1000, 30), Stands(1001, 40) }, true));
            Check.Equal("1 71: 11, 1000 5: 30, 1001 5: 40", game.Bodies(), "at first");
            Check.Equal(Whereabouts.OutOfReach, game.Slots.All[1].Whereabouts, "where");
            game.Hear(Message(new uint[] { 1 }, new[] { InSlot(1001, 4, 41) }));
            Check.Equal("1 71: 11, 1000 5: 30, 1001 5: 41", game.Bodies(), "on its way into the slot");
            Check.Equal(SlotState.Parked, game.Slots.All[2].State, "not there yet");
            game.Hear(Message(new uint[] { 1, 4 }, NoNews));
            Check.Equal("1 71: 11, 1000 5: 30, 1001 5: 14", game.Bodies(), "in the slot, and there but once");
            Check.Equal(SlotState.Solid, game.Slots.All[2].State, "its state");
            Check.Equal(4, game.Slots.All[2].LoopSlot, "its slot");
            Check.Equal(2, game.Slots.Count, "both slots");
            game.Hear(State(0, 11, -1, -1, -1));
            Check.Equal("1 71: 11, 1000 5: 30, 1001 5: ?", game.Bodies(), "a state of before it came");
            game.Hear(State(0, 12, -1, -1, 15));
            Check.Equal("1 71: 12, 1000 5: 30, 1001 5: 15", game.Bodies(), "it moves");
            game.Hear(Message(new uint[] { 1 }, NoNews));
            Check.Equal("1 71: 12, 1000 5: 30, 1001 5: ?", game.Bodies(), "its last reported pose is out of date");
            game.Hear(Message(new uint[] { 1 }, new[] { Stands(1001, 16) }));
            Check.Equal("1 71: 12, 1000 5: 30, 1001 5: 16", game.Bodies(), "out of the slot");
            game.Hear(Message(new uint[0], new[] { Gone(1000) }));
            Check.Equal("1001 5: 16", game.Bodies(), "one is left");
            Check.True(game.HasShapes(), "and its shapes");
            game.Hear(Message(new uint[0], new[] { Stands(1000, 30, 6), Gone(1001) }));
            Check.Equal("1000 6: 30", game.Bodies(), "another of that number");
            Check.Equal(0, game.Slots.FindInAll(new BodyId(1000, 6)), "it is found");
            Check.Equal(-1, game.Slots.FindInAll(new BodyId(1000, 5)), "and no other");
            game.Hear(Message(new uint[0], new[] { Gone(1000) }));
            Check.Equal("", game.Bodies(), "none");
            Check.True(!game.HasShapes(), "the shapes are forgotten");
        }
    }

    public static void NewSession_KeepsRegisteredBodies()
    {
        using (var game = new Game())
        {
            game.Hear(Message(new uint[] { 1 }, new[] { Stands(1000, 30) }, true));
            game.Hear(SceneWithEvents(2, "touched"));
            Check.Equal("1000 5: 30", game.Bodies(), "what was in slots has ended");
            Check.True(game.HasShapes(), "shapes");
        }
    }

    private static byte[] SceneWithEvents(uint session, params string[] names)
    {
        var b = new FlatBufferBuilder(1024);
        var offsets = new StringOffset[names.Length];
        for (int i = 0; i < names.Length; ++i) offsets[i] = b.CreateString(names[i]);
        VectorOffset all = Scene.CreateEventNamesVector(b, offsets);
        BodyBudget.StartBodyBudget(b);
        Offset<BodyBudget> budget = BodyBudget.EndBodyBudget(b);
        Scene.StartScene(b);
        Scene.AddSession(b, session);
        Scene.AddEventNames(b, all);
        Scene.AddBudget(b, budget);
        return MadeUpProgram.Finished(b, Payload.Scene, Scene.EndScene(b).Value);
    }

    private static byte[] EventOf(ushort type, short slot, float value)
    {
        var b = new FlatBufferBuilder(256);
        Events.StartEventsVector(b, 1);
        Event.CreateEvent(b, 9, type, slot, value);
        return MadeUpProgram.Finished(b, Payload.Events, Events.CreateEvents(b, b.EndVector()).Value);
    }

    public static void EventsOfASlot_CarryTheGamesNumberOfTheBody()
    {
        using (var game = new Game())
        {
            var events = new List<BodyEvent>();
            game.Client.BodyEventReceived += events.Add;
            game.Hear(SceneWithEvents(1, "touched", "left"));
            game.Hear(Message(new uint[] { 1, 4 }, new[] { InSlot(1001, 4, 41) }, true));
            game.Hear(EventOf(0, 4, 0.25f));
            game.Hear(EventOf(0, 1, 0.5f));
            game.Hear(Message(new uint[] { 1 }, new[] { Gone(1001) }));
            game.Hear(EventOf(1, 4, 74));          // the event is reported last
            game.Hear(Message(new uint[] { 1, 4 }, NoNews)); // a body that the game spawned there
            game.Hear(EventOf(0, 4, 0.125f));
            Check.Equal(4, events.Count, "events");
            Check.Equal("1001 5, 1 71, 1001 5, 4 74",
                string.Join(", ", events.ConvertAll(e => e.Body.Slot + " " + e.Body.Generation).ToArray()), "bodies");
            Check.Equal("4 74, 1 71, 4 74, 4 74",
                string.Join(", ", events.ConvertAll(e => e.Slot + " " + e.Generation).ToArray()), "slots");
            Check.Near(0.25, events[0].ImpulseNs, 0, "impulse");
        }
    }

    public static void CopyOfAThousandBodies_AllocatesNothing()
    {
        using (var game = new Game())
        {
            var all = new Reported[1000];
            for (uint i = 0; i < 1000; ++i) all[i] = Stands(1000 + i, i);
            game.Hear(Message(new uint[0], all, true));
            long allocated = 0;
            for (int round = 0; round < 110; ++round)
            {
                if (round == 10) allocated = GC.GetAllocatedBytesForCurrentThread();
                game.Slots.Number = 0; // forces a new copy, as if the list had changed
                double sum = 0;
                Check.True(game.Client.TryGetBodies(game.Slots), "a list");
                for (int i = 0; i < game.Slots.AllCount; ++i)
                {
                    if (game.Slots.TryGetPlace(i, game.World, out Vector at, out Rotation turn)) sum += at.X;
                }
                if (sum != 1000 * 999 / 2) throw new Failure("places: " + sum);
            }
            Check.Equal(0L, GC.GetAllocatedBytesForCurrentThread() - allocated, "bytes allocated by 100 lists of 1,000 bodies");
        }
    }

    public static void NumberWithoutABody_IsNotKept()
    {
        using (var game = new Game())
        {
            game.Hear(Message(new uint[0], new[] { Stands(999, 1), Stands(1000, 2), Stands(32767, 3), Stands(32768, 4) }));
            Check.Equal("1000 5: 2, 32767 5: 3", game.Bodies(), "bodies");
        }
    }
}
