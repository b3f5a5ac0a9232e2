using System;
using System.Collections.Generic;

namespace UnityEngine
{
    public class Object
    {
        internal bool Destroyed;

        public virtual string name { get; set; }

        public static void Destroy(Object o)
        {
            Headless.Player.DestroyAfterFrame(o);
        }

        public static implicit operator bool(Object o)
        {
            return !ReferenceEquals(o, null) && !o.Destroyed;
        }

        public static bool operator ==(Object a, Object b)
        {
            return ReferenceEquals(a, b) || (!(bool)a && !(bool)b);
        }

        public static bool operator !=(Object a, Object b)
        {
            return !(a == b);
        }

        public override bool Equals(object other) { return ReferenceEquals(this, other); }
        public override int GetHashCode() { return base.GetHashCode(); }
    }

    public sealed class GameObject : Object
    {
        internal readonly List<Component> Components = new List<Component>();

        public GameObject(string name)
        {
            this.name = name;
            transform = new Transform { gameObject = this };
        }

        public GameObject(string name, params Type[] components) : this(name)
        {
            foreach (Type type in components) Add(type);
        }

        public Transform transform { get; private set; }
        public int layer { get; set; }

        public T AddComponent<T>() where T : Component
        {
            return (T)Add(typeof(T));
        }

        private Component Add(Type type)
        {
            var component = (Component)Activator.CreateInstance(type);
            component.gameObject = this;
            Components.Add(component);
            var behaviour = component as MonoBehaviour;
            if (behaviour != null) Headless.Player.Begin(behaviour);
            return component;
        }
    }

    public class Component : Object
    {
        public GameObject gameObject { get; internal set; }
        public Transform transform { get { return gameObject.transform; } }
        public override string name { get { return gameObject.name; } set { gameObject.name = value; } }

        public T GetComponent<T>() where T : Component
        {
            foreach (Component c in gameObject.Components) if (c is T) return (T)c;
            return null;
        }

        public T GetComponentInParent<T>() where T : Component
        {
            for (Transform t = transform; t != null; t = t.parent)
            {
                T found = t.GetComponent<T>();
                if (found) return found;
            }
            return null;
        }

        public T[] GetComponentsInChildren<T>(bool includeInactive) where T : Component
        {
            var found = new List<T>();
            Collect(transform, found);
            return found.ToArray();
        }

        private static void Collect<T>(Transform at, List<T> found) where T : Component
        {
            foreach (Component c in at.gameObject.Components) if (c is T && c) found.Add((T)c);
            foreach (Transform child in at.Children) Collect(child, found);
        }
    }

    /// <summary>A transform without scale.</summary>
    public sealed class Transform : Component
    {
        internal readonly List<Transform> Children = new List<Transform>();

        public Transform parent { get; private set; }
        public Vector3 localPosition { get; set; }
        public Quaternion localRotation { get; set; } = Quaternion.identity;

        public Vector3 position { get { return parent == null ? localPosition : parent.TransformPoint(localPosition); } }
        public Quaternion rotation { get { return parent == null ? localRotation : parent.rotation * localRotation; } }
        public Matrix4x4 localToWorldMatrix { get { return new Matrix4x4 { Position = position, Rotation = rotation }; } }

        public void SetParent(Transform newParent, bool worldPositionStays)
        {
            if (worldPositionStays) throw new NotSupportedException("the stub keeps local poses only");
            parent?.Children.Remove(this);
            parent = newParent;
            parent?.Children.Add(this);
        }

        public Vector3 TransformPoint(Vector3 v)
        {
            return position + rotation * v;
        }

        public Vector3 InverseTransformPoint(Vector3 v)
        {
            return Quaternion.Inverse(rotation) * (v - position);
        }
    }

    public class Behaviour : Component
    {
        private bool isEnabled = true;

        public bool enabled
        {
            get { return isEnabled; }
            set
            {
                if (value == isEnabled) return;
                isEnabled = value;
                Headless.Player.Call((MonoBehaviour)this, value ? "OnEnable" : "OnDisable");
            }
        }
    }

    public class MonoBehaviour : Behaviour
    {
    }

    public sealed class Mesh : Object
    {
        internal static int Alive; // Unity does not collect meshes: the code that makes one must destroy it
        public Mesh() { ++Alive; }
        public Vector3[] vertices { get; private set; }
        public int[] triangles { get; private set; }
        public void SetVertices(List<Vector3> v) { vertices = v.ToArray(); }

        public void SetTriangles(List<int> t, int submesh)
        {
            foreach (int i in t) if (i < 0 || i >= vertices.Length) throw new ArgumentException("a corner that is not there");
            triangles = t.ToArray();
        }

        public void RecalculateNormals() { }
        public void RecalculateBounds() { }
    }

    public sealed class Shader : Object
    {
        public static Shader Find(string name) { return new Shader { name = name }; }
    }

    public class Material : Object
    {
        public Material(Shader shader) { }
    }

    public sealed class MaterialPropertyBlock
    {
        internal Color Color;
        public void SetColor(string name, Color value) { Color = value; }
    }

    public class Renderer : Component
    {
        internal MaterialPropertyBlock Block;
        public Material sharedMaterial { get; set; }
        public void SetPropertyBlock(MaterialPropertyBlock block) { Block = block; }
    }

    public sealed class MeshRenderer : Renderer { }

    public sealed class MeshFilter : Component
    {
        public Mesh sharedMesh { get; set; }
    }

    /// <summary>A kinematic body: it is at the position of MovePosition after the next physics step.</summary>
    public sealed class Rigidbody : Component
    {
        internal Vector3 NextPosition, Velocity;
        internal Quaternion NextRotation = Quaternion.identity;
        internal bool Moved;

        public Rigidbody() { Headless.Player.Rigidbodies.Add(this); }
        public bool isKinematic { get; set; }
        public bool useGravity { get; set; }

        public void MovePosition(Vector3 position)
        {
            NextPosition = position;
            Moved = true;
        }

        public void MoveRotation(Quaternion rotation)
        {
            NextRotation = rotation;
        }
    }

    public class Collider : Component { }

    public sealed class CapsuleCollider : Collider
    {
        public int direction { get; set; }
        public float radius { get; set; }
        public float height { get; set; }
    }

    public sealed class SphereCollider : Collider
    {
        public float radius { get; set; }
    }

    public sealed class BoxCollider : Collider
    {
        public Vector3 size { get; set; }
    }

    public sealed class MeshCollider : Collider
    {
        public bool convex { get; set; }
        public Mesh sharedMesh { get; set; }
    }

    public static class Gizmos
    {
        internal static int Spheres, Lines, Cubes;
        internal static Vector3 LastCubeSize;
        public static Color color { get; set; }
        public static Matrix4x4 matrix { get; set; }
        public static void DrawSphere(Vector3 center, float radius) { ++Spheres; }
        public static void DrawLine(Vector3 from, Vector3 to) { ++Lines; }

        public static void DrawWireCube(Vector3 center, Vector3 size)
        {
            ++Cubes;
            LastCubeSize = size;
        }
    }

    public static class GUILayout
    {
        internal static string Press = ""; // the button that is pressed
        internal static readonly List<string> Labels = new List<string>(); // labels of the newest frame
        public static void Label(string text) { Labels.Add(text); }
        public static bool Button(string text) { return text == Press; }
    }

    public static class Debug
    {
        internal static readonly List<string> Errors = new List<string>();
        public static void Log(object message) { }
        public static void Log(object message, Object context) { }
        public static void LogWarning(object message) { }
        public static void LogWarning(object message, Object context) { }
        public static void LogError(object message, Object context) { Errors.Add((string)message); }
        public static void LogException(Exception e) { Errors.Add(e.ToString()); }
    }

    public static class Application
    {
        public static bool isPlaying { get { return true; } }
    }

    [AttributeUsage(AttributeTargets.Field)]
    public sealed class SerializeField : Attribute { }

    public sealed class TooltipAttribute : Attribute { public TooltipAttribute(string tooltip) { } }
    public sealed class RangeAttribute : Attribute { public RangeAttribute(float min, float max) { } }
    public sealed class AddComponentMenu : Attribute { public AddComponentMenu(string menu) { } }
    public sealed class DisallowMultipleComponent : Attribute { }

    public sealed class DefaultExecutionOrder : Attribute
    {
        public readonly int order;
        public DefaultExecutionOrder(int order) { this.order = order; }
    }
}

namespace UnityEngine.Rendering
{
    public class RenderPipelineAsset : Object
    {
        public virtual Material defaultMaterial { get { return null; } }
    }

    public static class GraphicsSettings
    {
        public static RenderPipelineAsset currentRenderPipeline { get { return null; } }
    }
}
