using wholehand.protocol;

namespace Wholehand
{
    /// <summary>How a client connects.</summary>
    public sealed class ClientOptions
    {
        public string Host = "127.0.0.1";

        /// <summary>Of the program's pages. Where its datagrams go, the program says.</summary>
        public int Port = 8080;

        /// <summary>States a second by datagram, 0 to 1000. Without datagrams 60 come by WebSocket.</summary>
        public int RateHz = 1000;

        /// <summary>What the program asks for; empty where it asks for none.</summary>
        public string Token = "";

        /// <summary>True: events are raised by Poll(), on its caller's thread (a game's main thread), and
        /// the game counts as alive only while it polls at least every 100 ms; where it hangs, the exercise
        /// fades out. False: events are raised on the client's own thread, as they come.</summary>
        public bool Polled = false;
    }

    /// <summary>The program's answer to a command.</summary>
    public sealed class CommandReply
    {
        internal static readonly RefusedBody[] NoItems = new RefusedBody[0];

        public readonly bool Accepted;
        public readonly string Reason; // for a person; of what was accepted: what it waits for, or empty

        /// <summary>Why, for the game to say in its person's language; None of what the program did not
        /// answer.</summary>
        public readonly Refusal Refusal;

        /// <summary>Of Refusal.BodiesRefused, the bodies that were refused; all others were handed to the
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
