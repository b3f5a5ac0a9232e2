using System.Collections.Generic;
using UnityEngine;
using wholehand.protocol;

namespace Wholehand.Unity
{
    /// <summary>One body of the scene, or one that the game has spawned. Wholehand World makes them; if one with this
    /// name, or this GameId, is already a child of the world, that one is moved instead and keeps its appearance from
    /// the game.</summary>
    [AddComponentMenu("Wholehand/Wholehand Body")]
    [DisallowMultipleComponent]
    public sealed class WholehandBody : MonoBehaviour
    {
        [Tooltip("Of the scene file of the program: \"cube\".")]
        [SerializeField] private string bodyName = "";

        private readonly List<Mesh> meshes = new List<Mesh>(); // meshes that this component made
        private Rigidbody forPhysics;

        private Vector3 target;
        private Quaternion targetRotation;

        public string BodyName { get { return bodyName; } set { bodyName = value; } }

        /// <summary>Index into WorldSnapshot.BodyPositions, and for a body of the scene into Scene.Bodies; -1: there is
        /// no such body at present, or it stands still beyond the slots.</summary>
        public int Index { get; internal set; } = -1;

        /// <summary>Name of a body that the game spawns; null: a body of the scene.</summary>
        public BodyId? GameId { get; set; }

        /// <summary>State of a body of the game: a ghost is drawn, but touches nothing; Parked: it has no
        /// slot.</summary>
        public SlotState State { get; internal set; }

        /// <summary>Location of a body of the game that has a number instead of a slot.</summary>
        public Whereabouts Whereabouts { get; internal set; }

        /// <summary>Whether a target is set.</summary>
        public bool HasTarget { get; private set; }

        /// <summary>Whether it never moves. Unknown for a body of the game.</summary>
        public bool Fixed { get; private set; }

        /// <summary>Whether it represents a body that is in the world.</summary>
        internal bool Attached { get; private set; }

        /// <summary>True: the world made this object, and removes it with its scene.</summary>
        internal bool Made { get; set; }

        /// <summary>Sets the target of a body of the game with BodyOwner.Game: its centre of mass, in the game's world.
        /// The target holds until another one is set, as long as the game's frames run.</summary>
        public void SetTarget(Vector3 position, Quaternion rotation)
        {
            target = position;
            targetRotation = rotation;
            HasTarget = true;
        }

        /// <summary>Clears the target; the body halts within 0.1 s.</summary>
        public void ClearTarget()
        {
            HasTarget = false;
        }

        /// <summary>The target in the axes of the program and of the world that this body belongs to.</summary>
        internal BodyAt TargetIn(Transform world)
        {
            return new BodyAt(GameId.Value, world.ToProgram(target), world.ToProgram(targetRotation));
        }

        internal void Attach(int index, bool isFixed, Shape[] shapes, bool kinematicColliders)
        {
            Attached = true;
            Index = index;
            Fixed = isFixed;
            if (!kinematicColliders || forPhysics) return;
            // A separate object for physics: a kinematic body whose transform is set has no velocity for Unity's
            // physics.
            GameObject holder = Appearance.AddChild(transform.parent, name + " physics");
            forPhysics = Appearance.AddKinematicRigidbody(holder);
            foreach (Shape shape in shapes) AddCollider(shape);
        }

        internal void AddShapes(Shape[] shapes, Material material, Color color)
        {
            for (int i = 0; i < shapes.Length; ++i)
            {
                Mesh mesh = ShapeMeshes.Of(shapes[i]);
                if (mesh == null)
                {
                    Debug.LogWarning("Wholehand: shape " + i + " of body " + name + " is not drawn: its type "
                        + shapes[i].Type + " is unknown to this package, or its corners are damaged", this);
                    continue;
                }
                meshes.Add(mesh);
                Place(Appearance.AddMesh(transform, mesh.name, mesh, material, color).transform, shapes[i].InBody);
            }
        }

        /// <summary>Sets the drawn pose, in the world's axes.</summary>
        internal void Draw(Vector3 position, Quaternion rotation)
        {
            transform.localPosition = position;
            transform.localRotation = rotation;
        }

        /// <summary>Moves the physics object, in the game's world.</summary>
        internal void MoveForPhysics(Vector3 position, Quaternion rotation)
        {
            if (!forPhysics) return;
            forPhysics.MovePosition(position);
            forPhysics.MoveRotation(rotation);
        }

        internal void Detach()
        {
            Attached = false;
            Index = -1;
            HasTarget = false;
            if (forPhysics) Destroy(forPhysics.gameObject);
            forPhysics = null;
            Appearance.DestroyAll(meshes);
        }

        private void OnDestroy()
        {
            Appearance.DestroyAll(meshes);
        }

        private void AddCollider(Shape shape)
        {
            GameObject part = Appearance.AddChild(forPhysics.transform, shape.Type.ToString());
            Place(part.transform, shape.InBody);
            if (shape.Type == ShapeType.Box && shape.HalfExtentsM.HasValue)
            {
                part.AddComponent<BoxCollider>().size = 2.0f * ShapeMeshes.HalfExtents(shape);
            }
            else if (shape.Type == ShapeType.Sphere)
            {
                part.AddComponent<SphereCollider>().radius = shape.RadiusM;
            }
            else if (shape.Type == ShapeType.Capsule)
            {
                var capsule = part.AddComponent<CapsuleCollider>();
                capsule.direction = 1; // along y
                capsule.radius = shape.RadiusM;
                capsule.height = shape.LengthM + 2.0f * shape.RadiusM;
            }
            else
            {
                Mesh mesh = ShapeMeshes.Of(shape);
                if (mesh == null) return;
                meshes.Add(mesh);
                var collider = part.AddComponent<MeshCollider>();
                collider.convex = true;
                collider.sharedMesh = mesh;
            }
        }

        private static void Place(Transform part, wholehand.protocol.Pose? inBody)
        {
            if (!inBody.HasValue) return;
            part.localPosition = inBody.Value.PositionM.ToVector3();
            part.localRotation = inBody.Value.OrientationXyzw.ToQuaternion();
        }
    }
}
