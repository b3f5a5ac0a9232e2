using wholehand.protocol;

namespace Wholehand
{
    /// <summary>Options of a connection.</summary>
    public sealed class ClientOptions
    {
        public string Host = "127.0.0.1";

        /// <summary>Port of the program's pages. The program reports the port of its datagrams.</summary>
        public int Port = 8080;

        /// <summary>States a second by datagram, 0 to 1000. Without datagrams 60 come by WebSocket.</summary>
        public int RateHz = 1000;

        /// <summary>The token that the program requires; empty if it requires none.</summary>
        public string Token = "";

        /// <summary>True: Poll() raises the events on its caller's thread (a game's main thread), and
        /// the game counts as alive only while it polls at least every 100 ms; if it hangs, the exercise
        /// fades out. False: events are raised on the client's own thread, as they come.</summary>
        public bool Polled = false;
    }

    /// <summary>The program's answer to a command.</summary>
    public sealed class CommandReply
    {
        internal static readonly RefusedBody[] NoItems = new RefusedBody[0];

        public readonly bool Accepted;
        public readonly string Reason; // for a person; for an accepted command: what it waits for, or empty

        /// <summary>The reason of a refusal, for texts in the person's language; None if the program did not
        /// answer.</summary>
        public readonly Refusal Refusal;

        /// <summary>For Refusal.BodiesRefused: the refused bodies; all others were handed to the
        /// loop.</summary>
        public readonly RefusedBody[] Items;

        public CommandReply(bool accepted, string reason) : this(accepted, reason, Refusal.None, NoItems)
        {
        }

        internal CommandReply(bool accepted, string reason, Refusal refusal, RefusedBody[] items)
        {
            Accepted = accepted;
            Reason = reason ?? "";
            Refusal = refusal;
            Items = items;
        }
    }
}
