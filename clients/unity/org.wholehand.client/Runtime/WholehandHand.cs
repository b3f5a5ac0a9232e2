using System;
using System.Collections.Generic;
using UnityEngine;
using wholehand.protocol;

namespace Wholehand.Unity
{
    /// <summary>Draws the hand at the program's pose, from Scene.Links and the joint angles of the newest state. Each
    /// link is an object below this one: add meshes of a game below Link("thumb_ip_flexion"). They stay there while
    /// scenes change, as long as the hand has a link of that name. This object's own transform places the program's
    /// world in the game's; leave its scale at 1.</summary>
    [AddComponentMenu("Wholehand/Wholehand Hand")]
    [DisallowMultipleComponent]
    [DefaultExecutionOrder(-50)]
    public sealed class WholehandHand : MonoBehaviour
    {
        [Tooltip("Empty: the one above this object.")]
        [SerializeField] private WholehandConnection connection;

        [Tooltip("Shows the capsules that touch.")]
        [SerializeField] private bool drawCapsules = true;

        [Tooltip("Gives Unity's physics a kinematic capsule for each of the program's: the hand pushes what only the "
            + "game has. Nothing of it is felt.")]
        [SerializeField] private bool kinematicCapsules;

        [Tooltip("Empty: the render pipeline's default.")]
        [SerializeField] private Material material;

        [Tooltip("For a program on another machine: draws the hand where it is now, by the motion of the last states.")]
        [SerializeField] private bool predictMotion;

        [SerializeField] private Color color = new Color(0.85f, 0.68f, 0.56f);

        private HandKinematics kinematics;
        private readonly List<GameObject> capsules = new List<GameObject>(); // drawn capsules, below the links
        private readonly List<Mesh> meshes = new List<Mesh>();
        private Transform[] links = new Transform[0];
        private Rigidbody[] bodies = new Rigidbody[0]; // rigidbodies of the links, for Unity's physics
        private Transform linkRoot, bodyRoot;
        private float[] predicted = new float[0];
        private int builtScene, joints;

        public WholehandConnection Connection { get { return connection; } set { connection = value; } }

        /// <summary>Whether capsules are drawn. This and the three properties that follow take effect with the next
        /// scene.</summary>
        public bool DrawCapsules { get { return drawCapsules; } set { drawCapsules = value; } }

        public bool KinematicCapsules { get { return kinematicCapsules; } set { kinematicCapsules = value; } }

        public Material Material { get { return material; } set { material = value; } }

        public Color Color { get { return color; } set { color = value; } }

        /// <summary>The hand is drawn at its present pose, predicted from the last states; bodies stay at the newest
        /// state's pose. Takes effect at once.</summary>
        public bool PredictMotion { get { return predictMotion; } set { predictMotion = value; } }

        /// <summary>Raised when the links of a new scene are built, which happens with every arming.</summary>
        public event Action<WholehandHand> Built;

        /// <summary>Number of links; 0 before the first scene.</summary>
        public int LinkCount { get { return links.Length; } }

        /// <summary>Tick of the drawn state.</summary>
        public ulong DrawnTick { get; private set; }

        /// <summary>Session of the drawn state; 0: nothing has been drawn yet.</summary>
        public uint DrawnSession { get; private set; }

        /// <summary>The object that moves with link i of Scene.Links.</summary>
        public Transform Link(int i)
        {
            return links[i];
        }

        /// <summary>A link by its name; null if the hand has no such link.</summary>
        public Transform Link(string link)
        {
            int i = kinematics == null ? -1 : kinematics.Find(link);
            return i < 0 ? null : links[i];
        }

        /// <summary>Position of the drawn link i, in this object's axes.</summary>
        public Vector3 LinkPosition(int i)
        {
            return kinematics.Position(i).ToVector3();
        }

        public Quaternion LinkRotation(int i)
        {
            return kinematics.Orientation(i).ToQuaternion();
        }

        private void Start()
        {
            connection = WholehandConnection.Of(this, connection);
            if (!connection) enabled = false;
        }

        private void FixedUpdate()
        {
            if (bodies.Length == 0 || !Compute()) return;
            for (int i = 0; i < bodies.Length; ++i)
            {
                // The physics engine computes the body's velocity from this step.
                bodies[i].MovePosition(transform.TransformPoint(LinkPosition(i)));
                bodies[i].MoveRotation(transform.rotation * LinkRotation(i));
            }
        }

        private void Update()
        {
            if (connection.SceneNumber != builtScene)
            {
                builtScene = connection.SceneNumber;
                Build(connection.Scene.Value);
            }
            if (!Compute()) return;
            for (int i = 0; i < links.Length; ++i)
            {
                links[i].localPosition = LinkPosition(i);
                links[i].localRotation = LinkRotation(i);
            }
            DrawnTick = connection.State.Tick;
            DrawnSession = connection.State.Session;
        }

        private void OnDestroy()
        {
            Appearance.DestroyAll(meshes);
        }

        // False if the newest state has no pose of this hand: before the first tick, and while a scene changes.
        private bool Compute()
        {
            if (kinematics == null || !connection.HasState || connection.State.JointAngles.Length != joints) return false;
            if (predicted.Length != joints) predicted = new float[joints];
            bool ahead = predictMotion && connection.Motion.TryPredict(MonotonicClock.NowNs(), predicted);
            kinematics.Update(ahead ? predicted : connection.State.JointAngles);
            return true;
        }

        private void Build(Scene scene)
        {
            Clear();
            try
            {
                kinematics = new HandKinematics(scene);
                for (int i = 0; i < scene.LinksLength; ++i)
                {
                    if (scene.Links(i).Value.Joint >= scene.JointNamesLength)
                    {
                        throw new ArgumentException("link " + i + " moves with a joint that the scene does not have");
                    }
                }
            }
            catch (ArgumentException e)
            {
                kinematics = null;
                Debug.LogError("Wholehand Hand on " + name + " is not drawn: " + e.Message
                    + ". Bring the package and the program to the same version.", this);
                return;
            }
            joints = scene.JointNamesLength;
            MakeLinks(scene);
            if (kinematicCapsules) AddBodies(scene);
            for (int i = 0; i < scene.CapsulesLength; ++i) AddCapsule(scene.Capsules(i).Value);
            if (Built != null) Built(this);
        }

        // Existing links are kept, with the game's objects below them.
        private void MakeLinks(Scene scene)
        {
            if (!linkRoot) linkRoot = Appearance.AddChild(transform, "Links").transform;
            Transform[] before = links;
            links = new Transform[scene.LinksLength];
            for (int i = 0; i < links.Length; ++i)
            {
                string link = scene.Links(i).Value.Name;
                links[i] = Array.Find(before, l => l && l.name == link);
                if (!links[i]) links[i] = Appearance.AddChild(linkRoot, link).transform;
            }
            foreach (Transform link in before)
            {
                if (!link || Array.IndexOf(links, link) >= 0) continue;
                Debug.LogWarning("Wholehand Hand on " + name + ": this scene's hand has no link " + link.name
                    + "; what hangs below it is removed with it", this);
                Destroy(link.gameObject);
            }
        }

        private void AddBodies(Scene scene)
        {
            bodyRoot = Appearance.AddChild(transform, "Physics").transform;
            bodies = new Rigidbody[links.Length];
            for (int i = 0; i < bodies.Length; ++i)
            {
                bodies[i] = Appearance.AddKinematicRigidbody(Appearance.AddChild(bodyRoot, scene.Links(i).Value.Name));
            }
        }

        private void AddCapsule(Capsule capsule)
        {
            if (capsule.Link < 0 || capsule.Link >= links.Length || !capsule.AM.HasValue || !capsule.BM.HasValue) return;
            Vector3 a = capsule.AM.Value.ToVector3(), b = capsule.BM.Value.ToVector3();
            float length = (b - a).magnitude;
            Quaternion turn = length > 0.0f ? Quaternion.FromToRotation(Vector3.up, b - a) : Quaternion.identity;
            if (drawCapsules)
            {
                Mesh mesh = ShapeMeshes.Capsule(capsule.RadiusM, length);
                GameObject drawn = Appearance.AddMesh(links[capsule.Link], capsule.Name, mesh, material, color);
                Place(drawn, 0.5f * (a + b), turn);
                capsules.Add(drawn);
                meshes.Add(mesh);
            }
            if (bodies.Length == 0) return;
            GameObject part = Appearance.AddChild(bodies[capsule.Link].transform, capsule.Name);
            Place(part, 0.5f * (a + b), turn);
            var collider = part.AddComponent<CapsuleCollider>();
            collider.direction = 1; // along y
            collider.radius = capsule.RadiusM;
            collider.height = length + 2.0f * capsule.RadiusM;
        }

        private static void Place(GameObject part, Vector3 position, Quaternion rotation)
        {
            part.transform.localPosition = position;
            part.transform.localRotation = rotation;
        }

        private void Clear()
        {
            foreach (GameObject capsule in capsules) if (capsule) Destroy(capsule);
            capsules.Clear();
            Appearance.DestroyAll(meshes);
            if (bodyRoot) Destroy(bodyRoot.gameObject);
            bodyRoot = null;
            bodies = new Rigidbody[0];
            kinematics = null;
            DrawnSession = 0;
        }
    }
}
