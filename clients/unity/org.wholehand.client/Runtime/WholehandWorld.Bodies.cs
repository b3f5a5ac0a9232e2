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
        private const long TargetPauseNs = 15000000; // a body halts after 0.1 s without one

        [Tooltip("Of bodies that the game spawns.")]
        [SerializeField] private Color gameBodyColor = new Color(0.23f, 0.44f, 0.82f);

        private readonly List<WholehandBody> gameBodies = new List<WholehandBody>(); // in the order of the slots
        private BodyAt[] targets = new BodyAt[0];
        private long targetsNs;
        private int builtBodies = -1;

        /// <summary>Of bodies that appear from now on.</summary>
        public Color GameBodyColor { get { return gameBodyColor; } set { gameBodyColor = value; } }

        /// <summary>Bodies of the game that are in the world.</summary>
        public int GameBodyCount { get { return gameBodies.Count; } }

        public WholehandBody GameBody(int i)
        {
            return gameBodies[i];
        }

        /// <summary>Null where no such body is in the world, or is not drawn yet.</summary>
        public WholehandBody GameBody(BodyId body)
        {
            for (int i = 0; i < gameBodies.Count; ++i) if (Is(gameBodies[i], body)) return gameBodies[i];
            return null;
        }

        /// <summary>Gives the pieces of bodies to come: BodyShapes makes them in Unity's axes.</summary>
        public Task<CommandReply> PrepareShapes(uint set, params BodyShape[] pieces)
        {
            return connection && connection.Client != null ? connection.Client.PrepareShapes(set, pieces) : NotConnected();
        }

        /// <summary>Puts a body into its slot, which must be empty. Its pose is set from position and rotation; its velocity
        /// stays as it is, in the program's axes.</summary>
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

        /// <summary>Puts a body elsewhere; it is a ghost there until it overlaps nothing.</summary>
        public Task<CommandReply> Teleport(BodyId body, Vector3 position, Quaternion rotation)
        {
            if (!connection || connection.Client == null) return NotConnected();
            return connection.Client.Teleport(new BodyAt(body, transform.ToProgram(position), transform.ToProgram(rotation)));
        }

        /// <summary>Who moves it from now on; WholehandBody.SetTarget says where to, for BodyOwner.Game.</summary>
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

        // After the game has set its targets.
        private void LateUpdate()
        {
            int count = 0;
            for (int i = 0; i < gameBodies.Count; ++i) if (gameBodies[i].HasTarget) ++count;
            long nowNs = MonotonicClock.NowNs();
            if (count == 0 || connection.Client == null || nowNs - targetsNs < TargetPauseNs) return;
            targetsNs = nowNs;
            if (targets.Length != count) targets = new BodyAt[count];
            count = 0;
            for (int i = 0; i < gameBodies.Count; ++i)
            {
                if (gameBodies[i].HasTarget) targets[count++] = gameBodies[i].TargetIn(transform);
            }
            connection.Client.BodyTargets(targets);
        }

        private void BuildGameBodies(BodySlots slots)
        {
            builtBodies = connection.BodiesNumber;
            bool inWorld = slots.Session == connection.Scene.Value.Session;
            for (int i = gameBodies.Count - 1; i >= 0; --i)
            {
                if (inWorld && slots.Find(gameBodies[i].GameId.Value) >= 0) continue;
                gameBodies[i].Detach();
                if (gameBodies[i].Made) Destroy(gameBodies[i].gameObject);
                gameBodies.RemoveAt(i);
            }
            for (int i = 0; inWorld && i < slots.Count; ++i)
            {
                WholehandBody drawn = GameBody(slots.Bodies[i]) ?? Appear(slots, i);
                if (drawn) drawn.State = slots.States[i];
            }
        }

        // Null where its shapes are not known: then a newer list of bodies is on its way.
        private WholehandBody Appear(BodySlots slots, int i)
        {
            GameShapes told;
            if (!connection.Client.TryGetShapes(slots.Shapes[i], out told)) return null;
            var shapes = new Shape[told.PiecesLength];
            for (int s = 0; s < shapes.Length; ++s) shapes[s] = told.Pieces(s).Value;
            WholehandBody drawn = Placed(slots.Bodies[i]);
            if (!drawn)
            {
                drawn = Make("body " + slots.Bodies[i].Slot, shapes, gameBodyColor);
                drawn.GameId = slots.Bodies[i];
            }
            drawn.Attach(slots.PoseOf(slots.Bodies[i].Slot), false, shapes, kinematicColliders);
            gameBodies.Add(drawn);
            return drawn;
        }

        // One of the game's own.
        private WholehandBody Placed(BodyId body)
        {
            foreach (WholehandBody own in GetComponentsInChildren<WholehandBody>(true))
            {
                if (own.GameId.HasValue && own.Index < 0 && !own.Made && Is(own, body)) return own;
            }
            return null;
        }
    }
}
