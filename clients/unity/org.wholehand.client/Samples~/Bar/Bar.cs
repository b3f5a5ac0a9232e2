using System.Collections.Generic;
using System.Globalization;
using System.Threading.Tasks;
using UnityEngine;
using wholehand.protocol;

namespace Wholehand.Unity.Samples
{
    /// <summary>Add it to an empty object and press Play, with `wholehand run --udp 8091` in a terminal: the bar, its
    /// bodies and the hand, the exercise's instruction and values, and buttons that take the controls, arm and
    /// stop.</summary>
    [DefaultExecutionOrder(100)]
    public sealed class Bar : MonoBehaviour
    {
        [SerializeField] private int port = 8080;

        private struct ShownValue
        {
            public int Index; // index of HandState.Values
            public string Label, Unit, Format;
            public double Factor;
        }

        private readonly List<ShownValue> shown = new List<ShownValue>();
        private readonly List<string> instructions = new List<string>();
        private WholehandConnection connection;
        private int instruction = -1; // index of HandState.Values
        private Task<CommandReply> asked;
        private string answer = "";

        public int Port { get { return port; } set { port = connection.Port = value; } }

        public WholehandConnection Connection { get { return connection; } }

        /// <summary>The program's answer to the last press; empty: accepted, or nothing was pressed.</summary>
        public string Answer { get { return answer; } }

        private void Awake()
        {
            var root = new GameObject("Wholehand");
            root.transform.SetParent(transform, false);
            connection = root.AddComponent<WholehandConnection>();
            connection.Port = port;
            connection.SceneChanged += ReadPanel;
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
        /// <param name="basisShown">HandState.Basis of that frame.</param>
        public void Arm(uint endingsShown, uint basisShown)
        {
            asked = connection.Client.Arm(endingsShown, basisShown);
        }

        public void Stop()
        {
            asked = connection.Client.Stop();
        }

        public void EmergencyStop()
        {
            asked = connection.Client.EmergencyStop();
        }

        // Reads the panel that pages show for any exercise: docs/exercises.md of Wholehand.
        private void ReadPanel(Scene scene)
        {
            shown.Clear();
            instructions.Clear();
            instruction = -1;
            var names = new List<string>();
            for (int i = 0; i < scene.ValueNamesLength; ++i) names.Add(scene.ValueNames(i));
            if (!scene.Panel.HasValue) return;
            Panel panel = scene.Panel.Value;
            instruction = names.IndexOf("instruction");
            for (int i = 0; i < panel.InstructionsLength; ++i) instructions.Add(panel.Instructions(i).Value.En);
            for (int i = 0; i < panel.ValuesLength; ++i)
            {
                PanelValue value = panel.Values(i).Value;
                int index = names.IndexOf(value.Name);
                if (index < 0 || !value.Label.HasValue) continue;
                shown.Add(new ShownValue { Index = index, Label = value.Label.Value.En, Unit = value.Unit,
                    Format = "F" + value.Decimals, Factor = value.Factor });
            }
        }

        private void ShowPanel(double[] values)
        {
            if (instruction >= 0 && instruction < values.Length)
            {
                int now = (int)values[instruction];
                if (now >= 0 && now < instructions.Count) GUILayout.Label(instructions[now]);
            }
            foreach (ShownValue value in shown)
            {
                if (value.Index >= values.Length) continue;
                string number = (value.Factor * values[value.Index]).ToString(value.Format, CultureInfo.InvariantCulture);
                GUILayout.Label(value.Label + ": " + number + " " + value.Unit);
            }
        }

        private void OnGUI()
        {
            GUILayout.Label(connection.Message);
            if (!connection.HasState) return;
            HandState state = connection.State;
            GUILayout.Label(state.RunState + (connection.Client.HoldsControls ? ", you hold the controls" : ""));
            if (answer != "") GUILayout.Label(answer);
            ShowPanel(state.Values);
            if (GUILayout.Button("EMERGENCY STOP")) EmergencyStop();
            if (GUILayout.Button("Take the controls")) TakeControls();
            if (GUILayout.Button("Arm")) Arm(state.Endings, state.Basis);
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
