using System;
using System.Threading.Tasks;
using wholehand.protocol;

namespace Wholehand
{
    // Bodies of a game, in a scene with Scene.Budget: docs/protocol.md. The program checks all numbers; its refusals
    // are in CommandReply.Items, and later results of its loop come as a BodyEvent.
    public sealed partial class WholehandClient
    {
        private const int MostItems = 4096, MostInMessage = 64;
        private static readonly string[] BodyEventNames =
            { "appeared", "solid", "letting_go", "left", "quarantined", "refused", "touched" }; // like BodyEventKind

        private int[] bodyEventKinds = new int[0]; // kind by the scene's event type; -1: another event

        /// <summary>The bodies of a game in the world changed. The receiver may keep the argument. TryGetBodies copies
        /// the list.</summary>
        public event Action<GameBodies> BodiesChanged;

        /// <summary>An event of a body of a game.</summary>
        public event Action<BodyEvent> BodyEventReceived;

        /// <summary>Defines the convex pieces of later bodies, as shape set <paramref name="set"/>, below
        /// Scene.Budget.ShapeSets. They last for the session.</summary>
        public Task<CommandReply> PrepareShapes(uint set, params BodyShape[] pieces)
        {
            if (set > ushort.MaxValue) return Refused("there is no shape set " + set);
            return Ask(Order.PrepareShapes, b => BodyWords.PrepareShapes(b, (ushort)set, pieces));
        }

        /// <summary>Puts bodies into empty slots, or registers them by numbers, at most 64. Each is a ghost until it
        /// overlaps nothing.</summary>
        public Task<CommandReply> Spawn(params BodyToSpawn[] bodies)
        {
            foreach (BodyToSpawn body in bodies)
            {
                if (body.Slot > ushort.MaxValue) return Refused("there is no slot " + body.Slot);
                if (body.ShapeSet > ushort.MaxValue) return Refused("there is no shape set " + body.ShapeSet);
            }
            return Ask(Order.Spawn, b => BodyWords.Spawn(b, bodies));
        }

        /// <summary>Removes bodies. A body that the hand presses is released first.</summary>
        public Task<CommandReply> Remove(params BodyId[] bodies)
        {
            return Ask(Order.Remove, b => BodyWords.Remove(b, bodies));
        }

        /// <summary>Moves bodies to other places, where they are ghosts first.</summary>
        public Task<CommandReply> Teleport(params BodyAt[] bodies)
        {
            return Ask(Order.Teleport, b => BodyWords.Teleport(b, bodies));
        }

        public Task<CommandReply> SetOwner(params BodyOwnerChange[] bodies)
        {
            return Ask(Order.SetOwner, b => BodyWords.SetOwner(b, bodies));
        }

        /// <summary>Target poses of any number of bodies of owner Game. Repeat a target within 0.1 s, or its body
        /// halts; a lost message is corrected by the next one. Refusals come through ReplyReceived.</summary>
        public void BodyTargets(params BodyAt[] bodies)
        {
            lock (gate)
            {
                if (!connected) return;
                for (int first = 0; first == 0 || first < bodies.Length; first += MostInMessage)
                {
                    builder.Clear();
                    int targets = BodyWords.BodyTargets(builder, bodies, first, Math.Min(MostInMessage, bodies.Length - first));
                    SendMessage(Words.Command(builder, ++command, Order.BodyTargets, targets));
                }
            }
        }

        /// <summary>Copies the list of a game's bodies in the world; false if there is none newer than
        /// <paramref name="into"/>. Any thread.</summary>
        public bool TryGetBodies(BodySlots into)
        {
            lock (gate)
            {
                if (slots.Number == 0 || slots.Number == into.Number) return false;
                into.CopyFrom(slots);
                return true;
            }
        }

        /// <summary>The shapes of a body in the world, by BodySlots.Shapes. Any thread.</summary>
        public bool TryGetShapes(uint id, out GameShapes found)
        {
            lock (gate) return shapes.TryGetValue(id, out found);
        }

        // The length in a damaged message may be any number, also below 0.
        private static int Believable(int length)
        {
            if (length < 0 || length > MostItems) throw new InvalidOperationException("a length that no message has");
            return length;
        }

        private static Task<CommandReply> Refused(string why)
        {
            return Task.FromResult(new CommandReply(false, why));
        }

        private void RaiseBodyEvents(Events events)
        {
            int count = bodyEventKinds.Length == 0 ? 0 : events.Events_Length;
            for (int i = 0; i < count; ++i)
            {
                Event happened = events.Events_(i).Value;
                int kind = happened.Type < bodyEventKinds.Length ? bodyEventKinds[happened.Type] : -1;
                if (kind < 0) continue;
                if (kind == (int)BodyEventKind.Appeared) generations[happened.Index] = (uint)happened.Value;
                if (BodyEventReceived != null) Raise(BodyEventReceived, BodyEventOf((BodyEventKind)kind, happened));
            }
        }

        // The meaning of the value depends on the kind: a refusal, an impulse, or else the generation.
        private BodyEvent BodyEventOf(BodyEventKind kind, Event happened)
        {
            var body = new BodyEvent { Kind = kind, Tick = happened.Tick, Slot = happened.Index };
            if (kind == BodyEventKind.Refused)
            {
                body.Refusal = (BodyRefusal)happened.Value;
            }
            else if (kind == BodyEventKind.Touched)
            {
                generations.TryGetValue(body.Slot, out body.Generation);
                body.ImpulseNs = happened.Value;
            }
            else
            {
                body.Generation = (uint)happened.Value;
            }
            body.Body = NameOf(body.Slot, body.Generation);
            return body;
        }

        private static RefusedBody[] ItemsOf(Reply reply)
        {
            int count = Believable(reply.ItemsLength);
            if (count == 0) return CommandReply.NoItems;
            var items = new RefusedBody[count];
            for (int i = 0; i < count; ++i)
            {
                RefusedItem item = reply.Items(i).Value;
                items[i] = new RefusedBody
                {
                    Index = item.Item, Slot = item.Slot, Refusal = item.Refusal, Reason = item.Reason ?? ""
                };
            }
            return items;
        }
    }
}
