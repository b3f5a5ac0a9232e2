using System;
using UnityEngine;
using wholehand.protocol;

namespace Wholehand.Unity
{
    /// <summary>The connection to a running Wholehand program; one is enough for a scene. It connects in its first
    /// frame, reconnects after the program was absent, and ends when it is disabled. In every frame it takes the newest
    /// state and raises the client's events on the main thread. When the game is paused or hangs for 1 s, the program
    /// takes the controls back.</summary>
    [AddComponentMenu("Wholehand/Wholehand Connection")]
    [DisallowMultipleComponent]
    [DefaultExecutionOrder(-100)]
    public sealed class WholehandConnection : MonoBehaviour
    {
        /// <summary>Environment variable with the token that a program on another machine requires. The token is not
        /// serialized: a scene file is no place for a secret.</summary>
        public const string TokenVariable = "WHOLEHAND_TOKEN";

        [Tooltip("Machine of the program.")]
        [SerializeField] private string host = "127.0.0.1";

        [Tooltip("Port of the program's pages.")]
        [SerializeField] private int port = 8080;

        [Tooltip("States a second by datagram, where the program runs with --udp; otherwise 60 come by WebSocket.")]
        [Range(0, 1000)]
        [SerializeField] private int rateHz = 1000;

        private readonly HandState state = new HandState();
        private readonly WorldSnapshot world = new WorldSnapshot();
        private readonly BodySlots bodies = new BodySlots();
        private readonly MotionPredictor motion = new MotionPredictor();
        private WholehandClient client;

        /// <summary>Host of the program. A change of this and the next three takes effect when the component is enabled
        /// next.</summary>
        public string Host { get { return host; } set { host = value; } }

        public int Port { get { return port; } set { port = value; } }

        public int RateHz { get { return rateHz; } set { rateHz = value; } }

        /// <summary>Whether it is connected, and a description of the reason. This event and the next four are raised
        /// on the main thread, in Update.</summary>
        public event Action<bool, string> ConnectionChanged;

        public event Action<Scene> SceneChanged;

        /// <summary>Events of the exercise: Scene.EventNames.</summary>
        public event Action<Events> EventsReceived;

        /// <summary>The holder of the controls changed.</summary>
        public event Action<Controls> ControlsChanged;

        /// <summary>An event of a body of the game: docs/protocol.md of Wholehand, "Bodies of a game".</summary>
        public event Action<BodyEvent> BodyEventReceived;

        /// <summary>The token. Null: the environment variable WHOLEHAND_TOKEN, if it is set.</summary>
        public string Token { get; set; }

        /// <summary>The client, for commands and statistics. Null before the first frame and while the component is
        /// disabled.</summary>
        public WholehandClient Client { get { return client; } }

        public bool Connected { get { return client != null && client.Connected; } }

        /// <summary>Description of the connection's state.</summary>
        public string Message { get; private set; }

        /// <summary>The newest state; valid if HasState.</summary>
        public HandState State { get { return state; } }

        /// <summary>Bodies and contacts of the newest state by WebSocket; 60 a second.</summary>
        public WorldSnapshot World { get { return world; } }

        /// <summary>Predicted motion of the joints between and after states.</summary>
        public MotionPredictor Motion { get { return motion; } }

        /// <summary>The bodies of a game.</summary>
        public BodySlots Bodies { get { return bodies; } }

        /// <summary>Increases whenever Bodies has changed.</summary>
        public int BodiesNumber { get; private set; }

        public bool HasState { get; private set; }

        /// <summary>The newest scene; null before the first one.</summary>
        public Scene? Scene { get; private set; }

        /// <summary>Increases with every scene: components compare it with the number of the scene that they were built
        /// for.</summary>
        public int SceneNumber { get; private set; }

        /// <summary>Time since the newest state came [s]; infinite before the first. Above 1 something is
        /// wrong.</summary>
        public double SecondsSinceState
        {
            get { return HasState ? (MonotonicClock.NowNs() - state.ReceivedNs) * 1e-9 : double.PositiveInfinity; }
        }

        // Not in OnEnable: a script that adds this component sets its port right after.
        private bool Open()
        {
            if (client != null) return true;
            Message = "connecting to " + host + ":" + port;
            try
            {
                client = new WholehandClient(new ClientOptions
                {
                    Host = host, Port = port, RateHz = rateHz, Polled = true,
                    Token = Token ?? Environment.GetEnvironmentVariable(TokenVariable) ?? ""
                });
            }
            catch (ArgumentException e)
            {
                Message = e.Message;
                Debug.LogError("Wholehand Connection on " + name + ": " + e.Message, this);
                enabled = false;
                return false;
            }
            client.ConnectionChanged += OnConnectionChanged;
            client.SceneReceived += OnScene;
            client.EventsReceived += events => { if (EventsReceived != null) EventsReceived(events); };
            client.ControlsChanged += controls => { if (ControlsChanged != null) ControlsChanged(controls); };
            client.BodyEventReceived += e => { if (BodyEventReceived != null) BodyEventReceived(e); };
            client.HandlerThrew += Debug.LogException;
            client.Connect();
            return true;
        }

        private void OnDisable()
        {
            if (client == null) return;
            client.Dispose();
            client = null;
            HasState = false;
            Message = "not connected: the component is disabled";
        }

        // Runs before all other components of this package, so that they use the newest state in this step.
        private void FixedUpdate()
        {
            if (Open()) TakeNewest();
        }

        private void Update()
        {
            if (!Open()) return;
            client.Poll();
            if (client == null) return; // a handler has disabled this component
            TakeNewest();
            if (!client.Connected) HasState = false;
        }

        private void TakeNewest()
        {
            if (client.TryGetState(state))
            {
                motion.Add(state);
                HasState = true;
            }
            if (client.TryGetBodies(bodies)) ++BodiesNumber;
            client.TryGetWorld(world);
        }

        private void OnConnectionChanged(bool connected, string why)
        {
            Message = why;
            motion.Clear();
            if (connected) Debug.Log("Wholehand: " + why, this);
            else Debug.LogWarning("Wholehand: " + why + ". Is the program running (wholehand run --udp 8091)?", this);
            if (ConnectionChanged != null) ConnectionChanged(connected, why);
        }

        private void OnScene(Scene scene)
        {
            Scene = scene;
            ++SceneNumber;
            if (SceneChanged != null) SceneChanged(scene);
        }

        /// <summary>The connection of a component: the one that it names, or the one above it. Null, with an error
        /// message that explains the remedy, if there is none.</summary>
        internal static WholehandConnection Of(MonoBehaviour user, WholehandConnection named)
        {
            WholehandConnection found = named ? named : user.GetComponentInParent<WholehandConnection>();
            if (found) return found;
            Debug.LogError(user.GetType().Name + " on " + user.name + " has no connection: set its field Connection, or "
                + "put it below an object with a Wholehand Connection", user);
            return null;
        }
    }
}
