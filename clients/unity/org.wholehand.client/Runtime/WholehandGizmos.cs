using UnityEngine;
using wholehand.protocol;

namespace Wholehand.Unity
{
    /// <summary>Shows contacts and limits in the scene view: a ball and a line of force at each
    /// contact, the range of the axes x, y and z as a box, and for each axis a gauge of its position between its limits
    /// and of its effort. Add it to the object of the Wholehand Hand. In a built game it does nothing.</summary>
    [AddComponentMenu("Wholehand/Wholehand Gizmos")]
    [DisallowMultipleComponent]
    public sealed class WholehandGizmos : MonoBehaviour
    {
        private const float ContactRadius = 0.002f, GaugeSpace = 0.012f, GaugeHeight = 0.06f;

        [Tooltip("Empty: the one above this object.")]
        [SerializeField] private WholehandConnection connection;

        [Tooltip("Length of the line that stands for 1 N [m].")]
        [SerializeField] private float metresPerNewton = 0.01f;

        [SerializeField] private bool contacts = true;
        [SerializeField] private bool limits = true;

        private static readonly Color AtLimit = Color.red, Inside = Color.green, Force = Color.yellow;

        private Axis[] axes = new Axis[0];
        private bool hasRoom; // the first three axes are x, y, z
        private int knownScene;

        public WholehandConnection Connection { get { return connection; } set { connection = value; } }

        private void Start()
        {
            connection = WholehandConnection.Of(this, connection);
            if (!connection) enabled = false;
        }

        private void OnDrawGizmos()
        {
            if (!Application.isPlaying || !enabled || !connection || !connection.HasState) return;
            if (connection.SceneNumber != knownScene) ReadAxes();
            Gizmos.matrix = transform.localToWorldMatrix;
            if (contacts) DrawContacts(connection.World);
            if (limits) DrawLimits(connection.State);
        }

        private void ReadAxes()
        {
            knownScene = connection.SceneNumber;
            Scene scene = connection.Scene.Value;
            axes = new Axis[scene.AxesLength];
            for (int i = 0; i < axes.Length; ++i) axes[i] = scene.Axes(i).Value;
            hasRoom = axes.Length >= 3 && axes[0].Name == "x" && axes[1].Name == "y" && axes[2].Name == "z";
        }

        private void DrawContacts(WorldSnapshot world)
        {
            Gizmos.color = Force;
            for (int i = 0; i < world.ContactCount; ++i)
            {
                Vector3 at = world.ContactPoints[i].ToVector3();
                Gizmos.DrawSphere(at, ContactRadius);
                Gizmos.DrawLine(at, at + metresPerNewton * world.ContactForces[i].ToVector3());
            }
        }

        private void DrawLimits(HandState state)
        {
            if (state.HandPosition.Length != axes.Length || state.Sent.Length != axes.Length) return;
            if (hasRoom) DrawRoom(state);
            for (int i = 0; i < axes.Length; ++i) DrawGauge(i, state.HandPosition[i], state.Sent[i]);
        }

        private void DrawRoom(HandState state)
        {
            Vector3 lower = new Vector(axes[0].Lower, axes[1].Lower, axes[2].Lower).ToVector3();
            Vector3 upper = new Vector(axes[0].Upper, axes[1].Upper, axes[2].Upper).ToVector3();
            bool outside = false;
            for (int i = 0; i < 3; ++i) outside |= !IsWithin(i, state.HandPosition[i]);
            Gizmos.color = outside ? AtLimit : Inside;
            Gizmos.DrawWireCube(0.5f * (lower + upper), upper - lower);
        }

        // Drawn to the right of the hand's world; the mark on it is the position, the bar beside it the effort.
        private void DrawGauge(int axis, float position, float effort)
        {
            var foot = new Vector3(0.2f + axis * GaugeSpace, 0.0f, 0.0f);
            float range = axes[axis].Upper - axes[axis].Lower, most = axes[axis].EffortLimit;
            Gizmos.color = IsWithin(axis, position) ? Inside : AtLimit;
            Gizmos.DrawLine(foot, foot + GaugeHeight * Vector3.up);
            float share = range > 0.0f ? Mathf.Clamp01((position - axes[axis].Lower) / range) : 0.0f;
            Gizmos.DrawSphere(foot + share * GaugeHeight * Vector3.up, ContactRadius);
            float pushed = most > 0.0f ? Mathf.Clamp(effort / most, -1.0f, 1.0f) : 0.0f;
            Gizmos.color = Mathf.Abs(pushed) < 0.99f ? Force : AtLimit;
            Vector3 middle = foot + new Vector3(0.3f * GaugeSpace, 0.5f * GaugeHeight, 0.0f);
            Gizmos.DrawLine(middle, middle + 0.5f * pushed * GaugeHeight * Vector3.up);
        }

        private bool IsWithin(int axis, float position)
        {
            return position > axes[axis].Lower && position < axes[axis].Upper;
        }
    }
}
