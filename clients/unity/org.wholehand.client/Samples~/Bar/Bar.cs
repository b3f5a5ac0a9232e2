using System.Threading.Tasks;
using UnityEngine;

namespace Wholehand.Unity.Samples
{
    /// <summary>Put it on an empty object and press Play, with `wholehand run --udp 8091` in a terminal: the bar, its
    /// bodies and the hand, and buttons that take the controls, arm and stop.</summary>
    [DefaultExecutionOrder(100)]
    public sealed class Bar : MonoBehaviour
    {
        [SerializeField] private int port = 8080;

        private WholehandConnection connection;
        private Task<CommandReply> asked;
        private string answer = "";

        public int Port { get { return port; } set { port = connection.Port = value; } }

        public WholehandConnection Connection { get { return connection; } }

        /// <summary>What the program said to the last press; empty: accepted, or nothing was pressed.</summary>
        public string Answer { get { return answer; } }

        private void Awake()
        {
            var root = new GameObject("Wholehand");
            root.transform.SetParent(transform, false);
            connection = root.AddComponent<WholehandConnection>();
            connection.Port = port;
            AddBelow<WholehandHand>("Hand").AddComponent<WholehandGizmos>();
            AddBelow<WholehandWorld>("World");
        }

        private void Update()
        {
            if (asked == null || !asked.IsCompleted) return;
            answer = asked.Result.Reason;
            asked = null;
        }

        public void TakeControls()
        {
            asked = connection.Client.TakeControls();
        }

        /// <param name="endingsShown">HandState.Endings of the frame that the person pressed in.</param>
        public void Arm(uint endingsShown)
        {
            asked = connection.Client.Arm(endingsShown);
        }

        public void Stop()
        {
            asked = connection.Client.Stop();
        }

        public void EmergencyStop()
        {
            asked = connection.Client.EmergencyStop();
        }

        private void OnGUI()
        {
            GUILayout.Label(connection.Message);
            if (!connection.HasState) return;
            HandState state = connection.State;
            GUILayout.Label(state.RunState + (connection.Client.HoldsControls ? ", you hold the controls" : ""));
            if (answer != "") GUILayout.Label(answer);
            if (GUILayout.Button("EMERGENCY STOP")) EmergencyStop();
            if (GUILayout.Button("Take the controls")) TakeControls();
            if (GUILayout.Button("Arm")) Arm(state.Endings);
            if (GUILayout.Button("Stop")) Stop();
        }

        private GameObject AddBelow<T>(string name) where T : Component
        {
            var below = new GameObject(name);
            below.transform.SetParent(connection.transform, false);
            below.AddComponent<T>();
            return below;
        }
    }
}
