using System.Collections.Generic;
using UnityEngine;
using wholehand.protocol;

namespace Wholehand.Unity
{
    /// <summary>Draws the bodies of the program's scene and those that a game has spawned, which are those that the
    /// hand can touch: one Wholehand Body each, below this object. It also sends orders for bodies of a game. This
    /// object's transform places the program's world in the game's; leave its scale at 1, and use the same pose as the
    /// hand's.</summary>
    [AddComponentMenu("Wholehand/Wholehand World")]
    [DisallowMultipleComponent]
    [DefaultExecutionOrder(-50)]
    public sealed partial class WholehandWorld : MonoBehaviour
    {
        [Tooltip("Empty: the one above this object.")]
        [SerializeField] private WholehandConnection connection;

        [Tooltip("Gives Unity's physics a kinematic collider for each shape.")]
        [SerializeField] private bool kinematicColliders;

        [Tooltip("Empty: the render pipeline's default.")]
        [SerializeField] private Material material;

        private readonly List<WholehandBody> bodies = new List<WholehandBody>(); // in the order of Scene.Bodies
        private int builtScene;

        public WholehandConnection Connection { get { return connection; } set { connection = value; } }

        /// <summary>Whether bodies have colliders. This and the material take effect with the next scene.</summary>
        public bool KinematicColliders { get { return kinematicColliders; } set { kinematicColliders = value; } }

        public Material Material { get { return material; } set { material = value; } }

        public int BodyCount { get { return bodies.Count; } }

        /// <summary>Tick of the drawn state; 60 states a second.</summary>
        public ulong DrawnTick { get; private set; }

        /// <summary>Body i of Scene.Bodies.</summary>
        public WholehandBody Body(int i)
        {
            return bodies[i];
        }

        /// <summary>A body by its name; null if the scene has none of that name.</summary>
        public WholehandBody Body(string bodyName)
        {
            for (int i = 0; i < bodies.Count; ++i) if (bodies[i].BodyName == bodyName) return bodies[i];
            return null;
        }

        private void Start()
        {
            connection = WholehandConnection.Of(this, connection);
            if (!connection) enabled = false;
        }

        private void FixedUpdate()
        {
            if (!kinematicColliders || !IsOfThisScene(connection.World)) return;
            WorldSnapshot world = connection.World;
            for (int i = 0; i < bodies.Count; ++i) MoveForPhysics(bodies[i], world);
            for (int i = 0; i < gameBodies.Count; ++i) MoveForPhysics(gameBodies[i], world);
        }

        private void Update()
        {
            if (connection.SceneNumber != builtScene)
            {
                builtScene = connection.SceneNumber;
                Build(connection.Scene.Value);
            }
            bool others = connection.HasState && connection.Scene.HasValue && connection.BodiesNumber != builtBodies;
            if (others) BuildGameBodies(connection.Bodies);
            WorldSnapshot world = connection.World;
            if (!IsOfThisScene(world) || (world.Tick == DrawnTick && !others)) return;
            for (int i = 0; i < bodies.Count; ++i) Draw(bodies[i], world);
            for (int i = 0; i < gameBodies.Count; ++i) Draw(gameBodies[i], world);
            DrawnTick = world.Tick;
        }

        private void MoveForPhysics(WholehandBody body, WorldSnapshot world)
        {
            if (!world.Has(body.Index)) return;
            MoveForPhysics(body, world.BodyPositions[body.Index], world.BodyOrientations[body.Index]);
        }

        private void MoveForPhysics(WholehandBody body, Vector position, Rotation orientation)
        {
            body.MoveForPhysics(transform.TransformPoint(position.ToVector3()), transform.rotation * orientation.ToQuaternion());
        }

        private static void Draw(WholehandBody body, WorldSnapshot world)
        {
            if (!world.Has(body.Index)) return;
            body.Draw(world.BodyPositions[body.Index].ToVector3(), world.BodyOrientations[body.Index].ToQuaternion());
        }

        // A program reports the poses of a scene's first 128 bodies. A state may come before its scene.
        private bool IsOfThisScene(WorldSnapshot world)
        {
            return connection.HasState && connection.Scene.HasValue && world.BodyCount > 0 &&
                world.Session == connection.Scene.Value.Session;
        }

        private void Build(Scene scene)
        {
            var placed = new Dictionary<string, WholehandBody>();
            foreach (WholehandBody body in GetComponentsInChildren<WholehandBody>(true))
            {
                body.Detach();
                if (body.Made) Destroy(body.gameObject);
                else if (!body.GameId.HasValue) placed[body.BodyName] = body;
            }
            bodies.Clear();
            gameBodies.Clear();
            byName.Clear();
            builtBodies = -1;
            DrawnTick = ulong.MaxValue;
            for (int i = 0; i < scene.BodiesLength; ++i)
            {
                Body body = scene.Bodies(i).Value;
                WholehandBody drawn;
                var shapes = new Shape[body.ShapesLength];
                for (int s = 0; s < shapes.Length; ++s) shapes[s] = body.Shapes(s).Value;
                if (!placed.TryGetValue(body.Name, out drawn))
                {
                    drawn = Make(body.Name, shapes, Appearance.ColorOf(body.Color));
                    drawn.BodyName = body.Name;
                }
                drawn.Attach(i, body.Fixed, shapes, kinematicColliders);
                bodies.Add(drawn);
            }
        }

        private WholehandBody Make(string called, Shape[] shapes, Color color)
        {
            var made = Appearance.AddChild(transform, called).AddComponent<WholehandBody>();
            made.Made = true;
            made.AddShapes(shapes, material, color);
            return made;
        }
    }
}
