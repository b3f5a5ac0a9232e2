using System.Collections.Generic;
using UnityEngine;
using wholehand.protocol;

namespace Wholehand.Unity
{
    /// <summary>Draws the bodies of the program's scene, which are what the hand feels: one Wholehand Body each, below
    /// this object. This object's transform places the program's world in the game's; leave its scale at 1, and put it
    /// where the hand's is.</summary>
    [AddComponentMenu("Wholehand/Wholehand World")]
    [DisallowMultipleComponent]
    [DefaultExecutionOrder(-50)]
    public sealed class WholehandWorld : MonoBehaviour
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

        /// <summary>Takes effect with the next scene, as does the material.</summary>
        public bool KinematicColliders { get { return kinematicColliders; } set { kinematicColliders = value; } }

        public Material Material { get { return material; } set { material = value; } }

        public int BodyCount { get { return bodies.Count; } }

        /// <summary>Of the state that is drawn; 60 a second.</summary>
        public ulong DrawnTick { get; private set; }

        /// <summary>Body i of Scene.Bodies.</summary>
        public WholehandBody Body(int i)
        {
            return bodies[i];
        }

        /// <summary>Null where the scene has no such body.</summary>
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
            for (int i = 0; i < bodies.Count && i < world.BodyCount; ++i)
            {
                bodies[i].MoveForPhysics(transform.TransformPoint(world.BodyPositions[i].ToVector3()),
                    transform.rotation * world.BodyOrientations[i].ToQuaternion());
            }
        }

        private void Update()
        {
            if (connection.SceneNumber != builtScene)
            {
                builtScene = connection.SceneNumber;
                Build(connection.Scene.Value);
            }
            WorldSnapshot world = connection.World;
            if (!IsOfThisScene(world) || world.Tick == DrawnTick) return;
            for (int i = 0; i < bodies.Count && i < world.BodyCount; ++i)
            {
                bodies[i].Draw(world.BodyPositions[i].ToVector3(), world.BodyOrientations[i].ToQuaternion());
            }
            DrawnTick = world.Tick;
        }

        // A program tells where the first 128 bodies of a scene are.
        private bool IsOfThisScene(WorldSnapshot world)
        {
            return connection.HasState && world.BodyCount > 0 && world.Session == connection.Scene.Value.Session;
        }

        private void Build(Scene scene)
        {
            var placed = new Dictionary<string, WholehandBody>();
            foreach (WholehandBody body in GetComponentsInChildren<WholehandBody>(true))
            {
                body.Detach();
                if (body.Made) Destroy(body.gameObject);
                else placed[body.BodyName] = body;
            }
            bodies.Clear();
            DrawnTick = ulong.MaxValue;
            for (int i = 0; i < scene.BodiesLength; ++i)
            {
                Body body = scene.Bodies(i).Value;
                WholehandBody drawn;
                if (!placed.TryGetValue(body.Name, out drawn)) drawn = Make(body);
                drawn.Attach(i, body, kinematicColliders);
                bodies.Add(drawn);
            }
        }

        private WholehandBody Make(Body body)
        {
            var made = Appearance.AddChild(transform, body.Name).AddComponent<WholehandBody>();
            made.BodyName = body.Name;
            made.Made = true;
            made.AddShapes(body, material);
            return made;
        }
    }
}
