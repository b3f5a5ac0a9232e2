using System.Collections.Generic;
using UnityEngine;
using wholehand.protocol;

namespace Wholehand.Unity
{
    /// <summary>One body of the scene. Wholehand World makes them; where one with this name is a child of the world
    /// already, that one is moved instead and keeps the look that the game gave it.</summary>
    [AddComponentMenu("Wholehand/Wholehand Body")]
    [DisallowMultipleComponent]
    public sealed class WholehandBody : MonoBehaviour
    {
        [Tooltip("Of the scene file of the program: \"cube\".")]
        [SerializeField] private string bodyName = "";

        private readonly List<Mesh> meshes = new List<Mesh>(); // that this component made
        private Rigidbody forPhysics;

        public string BodyName { get { return bodyName; } set { bodyName = value; } }

        /// <summary>Index into Scene.Bodies; -1: the present scene has no body of this name.</summary>
        public int Index { get; internal set; } = -1;

        /// <summary>Never moves.</summary>
        public bool Fixed { get; private set; }

        /// <summary>True: the world made it, and removes it with its scene.</summary>
        internal bool Made { get; set; }

        internal void Attach(int index, Body body, bool kinematicColliders)
        {
            Index = index;
            Fixed = body.Fixed;
            if (!kinematicColliders || forPhysics) return;
            // Beside the drawn object: a kinematic body whose transform is set has no speed for Unity's physics.
            GameObject holder = Appearance.AddChild(transform.parent, name + " physics");
            forPhysics = Appearance.AddKinematicRigidbody(holder);
            for (int i = 0; i < body.ShapesLength; ++i) AddCollider(body.Shapes(i).Value);
        }

        internal void AddShapes(Body body, Material material)
        {
            Color color = Appearance.ColorOf(body.Color);
            for (int i = 0; i < body.ShapesLength; ++i)
            {
                Shape shape = body.Shapes(i).Value;
                Mesh mesh = ShapeMeshes.Of(shape);
                if (mesh == null)
                {
                    Debug.LogWarning("Wholehand: shape " + i + " of body " + bodyName + " is not drawn: its type "
                        + shape.Type + " is unknown to this package, or its corners are damaged", this);
                    continue;
                }
                meshes.Add(mesh);
                Place(Appearance.AddMesh(transform, mesh.name, mesh, material, color).transform, shape.InBody);
            }
        }

        /// <summary>In the world's axes.</summary>
        internal void Draw(Vector3 position, Quaternion rotation)
        {
            transform.localPosition = position;
            transform.localRotation = rotation;
        }

        /// <summary>In the game's world.</summary>
        internal void MoveForPhysics(Vector3 position, Quaternion rotation)
        {
            if (!forPhysics) return;
            forPhysics.MovePosition(position);
            forPhysics.MoveRotation(rotation);
        }

        internal void Detach()
        {
            Index = -1;
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
