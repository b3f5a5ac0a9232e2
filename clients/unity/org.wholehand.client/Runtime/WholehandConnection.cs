using System;
using UnityEngine;
using wholehand.protocol;

namespace Wholehand.Unity
{
    /// <summary>The connection to a running Wholehand program; one a scene is enough. It connects in its first frame,
    /// again after the program was gone, and ends when it is disabled. Every frame it takes the newest state and
    /// raises the client's events on the main thread. When the game is paused or hangs for 1 s, the program takes
    /// the controls back.</summary>
    [AddComponentMenu("Wholehand/Wholehand Connection")]
    [DisallowMultipleComponent]
    [DefaultExecutionOrder(-100)]
    public sealed class WholehandConnection : MonoBehaviour
    {
        /// <summary>Environment variable with the token that a program on another machine asks for. It is not
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

        /// <summary>Of the program. A change of this and the next three takes effect when the component is enabled
        /// next.</summary>
        public string Host { get { return host; } set { host = value; } }

        public int Port { get { return port; } set { port = value; } }

        public int RateHz { get { return rateHz; } set { rateHz = value; } }

        /// <summary>Connected or not, and in words why. This event and the next four are raised on the main thread, in
        /// Update.</summary>
        public event Action<bool, string> ConnectionChanged;

        public event Action<Scene> SceneChanged;

        /// <summary>Of the exercise: Scene.EventNames.</summary>
        public event Action<Events> EventsReceived;

        /// <summary>Who holds the controls.</summary>
        public event Action<Controls> ControlsChanged;

        /// <summary>What became of a body of the game: docs/protocol.md of Wholehand, "Bodies of a game".</summary>
        public event Action<BodyEvent> BodyEventReceived;

        /// <summary>Null: the environment variable WHOLEHAND_TOKEN, where there is one.</summary>
        public string Token { get; set; }

        /// <summary>For commands and statistics. Null before the first frame and while the component is
        /// disabled.</summary>
        public WholehandClient Client { get { return client; } }

        public bool Connected { get { return client != null && client.Connected; } }

        /// <summary>Connected or not, and in words why.</summary>
        public string Message { get; private set; }

        /// <summary>The newest; valid where HasState.</summary>
        public HandState State { get { return state; } }

        /// <summary>Bodies and contacts of the newest state by WebSocket; 60 a second.</summary>
        public WorldSnapshot World { get { return world; } }

        /// <summary>Where the joints are between states and beyond the newest.</summary>
        public MotionPredictor Motion { get { return motion; } }

        /// <summary>Which slots hold bodies of a game.</summary>
        public BodySlots Bodies { get { return bodies; } }

        /// <summary>Rises whenever Bodies has changed.</summary>
        public int BodiesNumber { get; private set; }

        public bool HasState { get; private set; }

        /// <summary>Null before the first.</summary>
        public Scene? Scene { get; private set; }

        /// <summary>Rises with every scene: who builds something of it compares it with the one it built.</summary>
        public int SceneNumber { get; private set; }

        /// <summary>Since the newest state came [s]; infinite before the first. Above 1 something is wrong.</summary>
        public double SecondsSinceState
        {
            get { return HasState ? (MonotonicClock.NowNs() - state.ReceivedNs) * 1e-9 : double.PositiveInfinity; }
        }

        // Not in OnEnable: who adds this component by script sets its port right after.
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

        // Before all other components of this package, so that they have the newest in this very step.
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

        /// <summary>The connection that a component uses: the one it names, or the one above it. Null, and an error
        /// that says what to do, where there is none.</summary>
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
