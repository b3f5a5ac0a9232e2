using System;
using System.Collections.Generic;
using wholehand.protocol;

namespace Wholehand
{
    // The list of a game's bodies in the world, assembled from the program's messages.
    public sealed partial class WholehandClient
    {
        private readonly BodySlots slots = new BodySlots();
        private readonly Dictionary<uint, GameShapes> shapes = new Dictionary<uint, GameShapes>();
        private readonly SortedList<uint, BodyInWorld> registered = new SortedList<uint, BodyInWorld>(); // by number

        // Generations by slot, also of bodies that have left it: their last event may come after the list without them.
        private readonly Dictionary<int, uint> generations = new Dictionary<int, uint>(); // of the receiving thread
        private readonly Dictionary<int, BodyId> numbered = new Dictionary<int, BodyId>();

        // Throws if the message is damaged; then nothing has changed.
        private void Take(GameBodies reported)
        {
            BodySlots read = SlotsOf(reported);
            BodyInWorld[] changed = RegisteredOf(reported);
            var news = new Dictionary<uint, GameShapes>();
            for (int i = 0; i < Believable(reported.NewShapesLength); ++i)
            {
                GameShapes made = reported.NewShapes(i).Value;
                news[made.Id] = made;
            }
            lock (gate)
            {
                foreach (BodyInWorld body in changed)
                {
                    if (body.Whereabouts == Whereabouts.Gone) registered.Remove(body.Id.Slot);
                    else if (body.Id.IsNumber) registered[body.Id.Slot] = body;
                }
                for (int i = 0; i < read.Count; ++i) generations[(int)read.Bodies[i].Slot] = read.Bodies[i].Generation;
                read.SceneBodies = scene.HasValue ? scene.Value.BodiesLength : 0;
                read.Number = slots.Number + 1;
                slots.CopyFrom(read);
                GatherAll();
                KeepShapes(news);
            }
        }

        private static BodySlots SlotsOf(GameBodies reported)
        {
            var read = new BodySlots { Session = reported.Session };
            read.Resize(Believable(reported.BodiesLength));
            for (int i = 0; i < read.Count; ++i)
            {
                GameBody body = reported.Bodies(i).Value;
                read.Bodies[i] = new BodyId(body.Slot, body.Generation);
                read.States[i] = body.State;
                read.Shapes[i] = body.Shapes;
            }
            return read;
        }

        private static BodyInWorld[] RegisteredOf(GameBodies reported)
        {
            var read = new BodyInWorld[Believable(reported.RegisteredLength)];
            for (int i = 0; i < read.Length; ++i)
            {
                RegisteredBody body = reported.Registered(i).Value;
                Vec3 p = body.Pose.PositionM;
                QuatXyzw q = body.Pose.OrientationXyzw;
                read[i] = new BodyInWorld
                {
                    Id = new BodyId(body.Number, body.Generation), Shapes = body.Shapes, LoopSlot = body.Slot,
                    Whereabouts = body.Whereabouts, PositionM = new Vector(p.X, p.Y, p.Z),
                    Orientation = new Rotation(q.X, q.Y, q.Z, q.W), Stands = true
                };
            }
            return read;
        }

        // Lists every body once: a body in a slot that has a number is listed by its number. gate is held.
        private void GatherAll()
        {
            var owners = new Dictionary<uint, uint>(); // slot -> number
            foreach (BodyInWorld body in registered.Values)
            {
                if (body.LoopSlot < 0) continue;
                owners[(uint)body.LoopSlot] = body.Id.Slot;
                numbered[body.LoopSlot] = body.Id;
            }
            slots.ResizeAll(slots.Count + registered.Count);
            int all = 0;
            for (int i = 0; i < slots.Count; ++i)
            {
                uint number, slot = slots.Bodies[i].Slot;
                if (owners.TryGetValue(slot, out number))
                {
                    BodyInWorld there = registered[number];
                    there.State = slots.States[i];
                    registered[number] = there;
                    continue;
                }
                numbered.Remove((int)slot);
                slots.All[all++] = new BodyInWorld
                {
                    Id = slots.Bodies[i], Shapes = slots.Shapes[i], LoopSlot = (int)slot, State = slots.States[i],
                    Whereabouts = Whereabouts.InSlot, Orientation = new Rotation(0, 0, 0, 1)
                };
            }
            for (int i = 0; i < registered.Count; ++i)
            {
                BodyInWorld body = registered.Values[i];
                slots.All[all++] = body;
                if (body.State == SlotState.Parked) continue;
                // The next list contains its state; if it does not contain the body, its last reported pose is
                // outdated.
                body.State = SlotState.Parked;
                body.Stands = false;
                registered[body.Id.Slot] = body;
            }
            slots.AllCount = all;
            slots.InOrder = true;
            for (int i = 1; i < all; ++i) slots.InOrder &= slots.All[i - 1].Id.Slot < slots.All[i].Id.Slot;
        }

        // Keeps the shapes of bodies in the world. gate is held.
        private void KeepShapes(Dictionary<uint, GameShapes> news)
        {
            var kept = new Dictionary<uint, GameShapes>();
            for (int i = 0; i < slots.AllCount; ++i)
            {
                GameShapes of;
                uint id = slots.All[i].Shapes;
                if (news.TryGetValue(id, out of) || shapes.TryGetValue(id, out of)) kept[id] = of;
            }
            shapes.Clear();
            foreach (KeyValuePair<uint, GameShapes> of in kept) shapes[of.Key] = of.Value;
        }

        // Called before the game gets the scene. The bodies in slots end with the session; registered ones, when the
        // program reports it.
        private void TakeBodyEventsOf(Scene newScene)
        {
            var kinds = new int[newScene.Budget.HasValue ? Believable(newScene.EventNamesLength) : 0];
            for (int i = 0; i < kinds.Length; ++i) kinds[i] = Array.IndexOf(BodyEventNames, newScene.EventNames(i));
            bodyEventKinds = kinds;
            lock (gate)
            {
                if (slots.Session != newScene.Session || kinds.Length == 0)
                {
                    slots.Resize(0);
                    GatherAll();
                    KeepShapes(shapes);
                }
                slots.SceneBodies = newScene.BodiesLength;
                if (slots.Number > 0) ++slots.Number;
            }
        }

        // gate is held.
        private void DropBodies()
        {
            shapes.Clear();
            registered.Clear();
            slots.Resize(0);
            slots.ResizeAll(0);
            if (slots.Number > 0) ++slots.Number;
        }

        private BodyId NameOf(int slot, uint generation)
        {
            BodyId name;
            lock (gate) return numbered.TryGetValue(slot, out name) ? name : new BodyId((uint)slot, generation);
        }
    }
}
