using System;
using System.Collections.Generic;
using System.Linq;
using Wholehand;

/// <summary>Golden datagrams of the program, as the client's socket receives them.</summary>
internal static class Datagrams
{
    /// <summary>The content of a datagram, and whether the client accepts it after the earlier ones.</summary>
    public static object Judge(Dictionary<string, object> entry)
    {
        byte[][] conversation = ((List<object>)entry["conversation"]).Select(Golden.BytesOf).ToArray();
        byte[] last = conversation.Last();
        var answer = new Dictionary<string, object>();
        DatagramFlaw flaw = Datagram.Read(last, last.Length, out DatagramHeader header);
        if (flaw != DatagramFlaw.None) answer["flaw"] = Snake(flaw.ToString());
        else
        {
            answer["header"] = Described(header);
            answer["written_the_same"] = WrittenAgain(header, last).SequenceEqual(last);
        }
        answer["taken"] = Taken(Convert.ToUInt64((string)entry["key"], 16), conversation);
        return answer;
    }

    private static byte[] WrittenAgain(DatagramHeader header, byte[] datagram)
    {
        var again = new byte[Datagram.LargestSize];
        int size = Datagram.Write(again, header, datagram, Datagram.HeaderSize, datagram.Length - Datagram.HeaderSize);
        return again.Take(size).ToArray();
    }

    private static string Taken(ulong key, byte[][] conversation)
    {
        using (var client = new WholehandClient(new ClientOptions()))
        {
            Golden.Set(client, "key", key);
            client.Statistics.BeginConversation();
            long ignored = 0, stale = 0;
            foreach (byte[] datagram in conversation)
            {
                ignored = client.Statistics.Ignored;
                stale = client.Statistics.OutOfOrder;
                client.Receive(datagram, datagram.Length, 1);
            }
            if (client.Statistics.OutOfOrder > stale) return "stale";
            return client.Statistics.Ignored > ignored ? "ignored" : "";
        }
    }

    private static string Snake(string name)
    {
        return string.Concat(name.Select((c, i) => (char.IsUpper(c) && i > 0 ? "_" : "") + char.ToLowerInvariant(c)));
    }

    private static object Described(DatagramHeader h)
    {
        return new Dictionary<string, object>
        {
            { "kind", (long)h.Kind }, { "holds_controls", h.HoldsControls }, { "key", h.Key.ToString("x16") },
            { "sequence", (long)h.Sequence }, { "rate_or_stop", (long)h.RateOrStop }, { "sent_ns", h.SentNs.ToString("x16") },
            { "echo_ns", h.EchoNs.ToString("x16") }, { "echo_age_us", (long)h.EchoAgeUs }
        };
    }
}
