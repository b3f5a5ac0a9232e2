using System;
using System.Collections.Generic;
using System.Threading.Tasks;
using UnityEngine;
using wholehand.protocol;

namespace Wholehand.Unity
{
    // Bodies of a game: docs/protocol.md of Wholehand. Positions and rotations are those of the centre of mass in the
    // game's world. The tasks of orders end on another thread than the main one, unless they are awaited there.
    public sealed partial class WholehandWorld
    {
        // A body halts after 0.1 s without a target. The program takes 400 messages a second, of 64 targets each.
        private const long TargetPauseNs = 15000000, PauseOf64Ns = 5000000;

        [Tooltip("Of bodies that the game spawns.")]
        [SerializeField] private Color gameBodyColor = new Color(0.23f, 0.44f, 0.82f);

        private readonly List<WholehandBody> gameBodies = new List<WholehandBody>();
        private readonly Dictionary<uint, WholehandBody> byName = new Dictionary<uint, WholehandBody>(); // slot or number
        private BodyAt[] targets = new BodyAt[0];
        private long targetsNs;
        private int builtBodies = -1;

        /// <summary>Colour of bodies that appear from now on.</summary>
        public Color GameBodyColor { get { return gameBodyColor; } set { gameBodyColor = value; } }

        /// <summary>Number of the game's bodies in the world.</summary>
        public int GameBodyCount { get { return gameBodies.Count; } }

        public WholehandBody GameBody(int i)
        {
            return gameBodies[i];
        }

        /// <summary>A body of the game; null if it is not in the world, or is not drawn yet.</summary>
        public WholehandBody GameBody(BodyId body)
        {
            WholehandBody found;
            return byName.TryGetValue(body.Slot, out found) && Is(found, body) ? found : null;
        }

        /// <summary>Defines the pieces of later bodies: BodyShapes makes them in Unity's axes.</summary>
        public Task<CommandReply> PrepareShapes(uint set, params BodyShape[] pieces)
        {
            return connection && connection.Client != null ? connection.Client.PrepareShapes(set, pieces) : NotConnected();
        }

        /// <summary>Puts a body into its slot, which must be empty, or registers it by its number (BodyId). Position
        /// and rotation set its pose; its velocity is unchanged, in the program's axes.</summary>
        public Task<CommandReply> Spawn(BodyToSpawn body, Vector3 position, Quaternion rotation)
        {
            body.PositionM = transform.ToProgram(position);
            body.Orientation = transform.ToProgram(rotation);
            return connection && connection.Client != null ? connection.Client.Spawn(body) : NotConnected();
        }

        public Task<CommandReply> Remove(BodyId body)
        {
            return connection && connection.Client != null ? connection.Client.Remove(body) : NotConnected();
        }

        /// <summary>Moves a body to another place; it is a ghost there until it overlaps nothing.</summary>
        public Task<CommandReply> Teleport(BodyId body, Vector3 position, Quaternion rotation)
        {
            if (!connection || connection.Client == null) return NotConnected();
            return connection.Client.Teleport(new BodyAt(body, transform.ToProgram(position), transform.ToProgram(rotation)));
        }

        /// <summary>Changes the owner that moves it; WholehandBody.SetTarget sets the target for
        /// BodyOwner.Game.</summary>
        public Task<CommandReply> SetOwner(BodyId body, BodyOwner owner)
        {
            if (!connection || connection.Client == null) return NotConnected();
            return connection.Client.SetOwner(new BodyOwnerChange(body, owner));
        }

        private static Task<CommandReply> NotConnected()
        {
            return Task.FromResult(new CommandReply(false, "not connected"));
        }

        private static bool Is(WholehandBody drawn, BodyId body)
        {
            return drawn.GameId.Value.Slot == body.Slot && drawn.GameId.Value.Generation == body.Generation;
        }

        // Runs after the game has set its targets.
        private void LateUpdate()
        {
            int count = 0;
            for (int i = 0; i < gameBodies.Count; ++i) if (gameBodies[i].HasTarget) ++count;
            long nowNs = MonotonicClock.NowNs();
            if (count == 0 || connection.Client == null || nowNs - targetsNs < PauseFor(count)) return;
            targetsNs = nowNs;
            if (targets.Length != count) targets = new BodyAt[count];
            count = 0;
            for (int i = 0; i < gameBodies.Count; ++i)
            {
                if (gameBodies[i].HasTarget) targets[count++] = gameBodies[i].TargetIn(transform);
            }
            connection.Client.BodyTargets(targets);
        }

        private static long PauseFor(int bodies)
        {
            return Math.Max(TargetPauseNs, PauseOf64Ns * ((bodies + 63) / 64));
        }

        private void BuildGameBodies(BodySlots slots)
        {
            builtBodies = connection.BodiesNumber;
            bool ofScene = slots.Session == connection.Scene.Value.Session;
            for (int i = gameBodies.Count - 1; i >= 0; --i)
            {
                BodyId name = gameBodies[i].GameId.Value;
                if ((ofScene || name.IsNumber) && slots.FindInAll(name) >= 0) continue;
                gameBodies[i].Detach();
                if (gameBodies[i].Made) Destroy(gameBodies[i].gameObject);
                gameBodies.RemoveAt(i);
                byName.Remove(name.Slot);
            }
            WholehandBody[] placed = null;
            for (int i = 0; i < slots.AllCount; ++i)
            {
                if (!ofScene && !slots.All[i].Id.IsNumber) continue;
                WholehandBody drawn = GameBody(slots.All[i].Id) ?? Appear(slots.All[i], ref placed);
                if (drawn) Follow(drawn, slots, i);
            }
        }

        private void Follow(WholehandBody drawn, BodySlots slots, int i)
        {
            Vector position;
            Rotation orientation;
            drawn.State = slots.All[i].State;
            drawn.Whereabouts = slots.All[i].Whereabouts;
            drawn.Index = drawn.State == SlotState.Parked ? -1 : slots.PoseOf((uint)slots.All[i].LoopSlot);
            // The pose of a body in a slot comes from states.
            if (drawn.Index >= 0 || !slots.TryGetPlace(i, connection.World, out position, out orientation)) return;
            drawn.Draw(position.ToVector3(), orientation.ToQuaternion());
            MoveForPhysics(drawn, position, orientation);
        }

        // Null if its shapes are unknown: then a newer list of bodies is under way. `placed`: existing children of this
        // object, some of which may be the game's own; null: not yet searched.
        private WholehandBody Appear(BodyInWorld body, ref WholehandBody[] placed)
        {
            GameShapes reported;
            if (!connection.Client.TryGetShapes(body.Shapes, out reported)) return null;
            var shapes = new Shape[reported.PiecesLength];
            for (int s = 0; s < shapes.Length; ++s) shapes[s] = reported.Pieces(s).Value;
            WholehandBody drawn = null;
            if (placed == null) placed = GetComponentsInChildren<WholehandBody>(true);
            foreach (WholehandBody own in placed)
            {
                if (own.GameId.HasValue && !own.Attached && !own.Made && Is(own, body.Id)) drawn = own;
            }
            if (!drawn)
            {
                drawn = Make("body " + body.Id.Slot, shapes, gameBodyColor);
                drawn.GameId = body.Id;
            }
            drawn.Attach(-1, false, shapes, kinematicColliders);
            gameBodies.Add(drawn);
            byName[body.Id.Slot] = drawn;
            return drawn;
        }
    }
}
