using UnityEditor;
using UnityEngine;

namespace Wholehand.Unity.Editor
{
    /// <summary>Adds the state of the connection and the statistics of received states to the inspector.</summary>
    [CustomEditor(typeof(WholehandConnection))]
    public sealed class WholehandConnectionEditor : UnityEditor.Editor
    {
        public override void OnInspectorGUI()
        {
            DrawDefaultInspector();
            var connection = (WholehandConnection)target;
            if (!Application.isPlaying || connection.Client == null) return;
            EditorGUILayout.HelpBox(Describe(connection), connection.Connected ? MessageType.Info : MessageType.Warning);
        }

        public override bool RequiresConstantRepaint()
        {
            return Application.isPlaying;
        }

        /// <summary>A description in a few lines.</summary>
        public static string Describe(WholehandConnection connection)
        {
            ClientStatistics s = connection.Client.Statistics;
            string text = connection.Message;
            if (!connection.HasState) return text + "\nNo state has come yet.";
            text += "\n" + connection.State.RunState + ", tick " + connection.State.Tick
                + (connection.Client.HoldsControls ? ", this game holds the controls" : "");
            if (s.Received == 0) return text + "\nStates come by WebSocket, 60 a second.";
            return text + string.Format(System.Globalization.CultureInfo.InvariantCulture,
                "\n{0} states by datagram, {1} lost; latency p50 {2:0.00} ms, p99 {3:0.00} ms (one machine only)",
                s.Received, s.Lost, s.LatencyMs(50), s.LatencyMs(99));
        }
    }
}
