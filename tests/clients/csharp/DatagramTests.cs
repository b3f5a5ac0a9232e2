using System;
using System.Collections.Generic;
using System.Text;
using Wholehand;

[Tests]
public static class DatagramTests
{
    private static DatagramHeader SomeHeader()
    {
        return new DatagramHeader
        {
            Kind = DatagramKind.State, Session = 0x01020304, Sequence = 5, MonotonicNs = -2, FragmentCount = 1
        };
    }

    private static byte[] Written(DatagramHeader header, byte[] payload)
    {
        var datagram = new byte[Datagram.LargestSize];
        int size = Datagram.Write(datagram, header, payload, 0, payload.Length);
        Array.Resize(ref datagram, size);
        return datagram;
    }

    private static DatagramFlaw FlawOf(byte[] bytes)
    {
        DatagramHeader header;
        return Datagram.Read(bytes, bytes.Length, out header);
    }

    // A byte changed, and the checksum made right again.
    private static DatagramFlaw FlawOfForged(byte[] good, int at, byte value)
    {
        var forged = (byte[])good.Clone();
        forged[at] = value;
        uint crc = Crc32.Of(forged, 36, forged.Length - 36, Crc32.Of(forged, 0, 32));
        for (int i = 0; i < 4; ++i) forged[32 + i] = (byte)(crc >> (8 * i));
        return FlawOf(forged);
    }

    public static void Crc32_OfTheCheckString_IsTheCataloguedOne()
    {
        // CRC-32/ISO-HDLC: check = 0xcbf43926.
        byte[] text = Encoding.ASCII.GetBytes("123456789");
        Check.Equal(0xCBF43926u, Crc32.Of(text, 0, 9), "check value");
        Check.Equal(0xCBF43926u, Crc32.Of(text, 4, 5, Crc32.Of(text, 0, 4)), "in two parts");
    }

    public static void Written_IsByteByByteWhatTheDocumentSays()
    {
        // docs/udp.md, "An example"; the C++ side is held against the same bytes.
        const string Expected = "57485544010011000403020105000000feffffffffffffff"
            + "0000010003000000301d27ed616263";
        byte[] datagram = Written(SomeHeader(), Encoding.ASCII.GetBytes("abc"));
        Check.Equal(Expected, BitConverter.ToString(datagram).Replace("-", "").ToLowerInvariant(), "bytes");
        DatagramHeader header;
        Check.Equal(DatagramFlaw.None, Datagram.Read(datagram, datagram.Length, out header), "flaw");
        Check.Equal(DatagramKind.State, header.Kind, "kind");
        Check.Equal(0x01020304u, header.Session, "session");
        Check.Equal(5u, header.Sequence, "sequence");
        Check.Equal(-2L, header.MonotonicNs, "time");
        Check.Equal((ushort)3, header.PayloadLength, "length");
    }

    public static void AnyBitFlipped_IsRefused()
    {
        byte[] datagram = Written(SomeHeader(), new byte[50]);
        for (int bit = 0; bit < 8 * datagram.Length; ++bit)
        {
            datagram[bit / 8] ^= (byte)(1 << (bit % 8));
            Check.True(FlawOf(datagram) != DatagramFlaw.None, "bit " + bit + " may be wrong unseen");
            datagram[bit / 8] ^= (byte)(1 << (bit % 8));
        }
        Check.Equal(DatagramFlaw.None, FlawOf(datagram), "at the end");
    }

    public static void EveryFlaw_IsTold()
    {
        byte[] good = Written(SomeHeader(), new byte[] { 1, 2, 3 });
        Check.Equal(DatagramFlaw.TooShort, FlawOf(new byte[0]), "nothing");
        Check.Equal(DatagramFlaw.TooShort, FlawOf(new byte[35]), "less than a header");
        Check.Equal(DatagramFlaw.TooLong, FlawOf(new byte[1201]), "1201 bytes");
        Check.Equal(DatagramFlaw.Magic, FlawOfForged(good, 0, 0), "magic");
        Check.Equal(DatagramFlaw.Version, FlawOfForged(good, 4, 2), "version");
        Check.Equal(DatagramFlaw.Length, FlawOfForged(good, 28, 4), "length");
        Check.Equal(DatagramFlaw.Header, FlawOfForged(good, 6, 99), "kind");
        Check.Equal(DatagramFlaw.Header, FlawOfForged(good, 7, 1), "flags");
        Check.Equal(DatagramFlaw.Header, FlawOfForged(good, 24, 1), "fragment 1 of 1");
        Check.Equal(DatagramFlaw.Header, FlawOfForged(good, 26, 0), "of none");
        Check.Equal(DatagramFlaw.Header, FlawOfForged(good, 27, 5), "of 1281");
        Check.Equal(DatagramFlaw.Header, FlawOfForged(good, 30, 1), "reserved");
        good[38] ^= 1;
        Check.Equal(DatagramFlaw.Checksum, FlawOf(good), "checksum");
    }

    public static void RandomBytes_AreNeverTakenForOne()
    {
        var random = new Random(Runner.Seed);
        for (int i = 0; i < 5000; ++i)
        {
            var bytes = new byte[random.Next(1300)];
            random.NextBytes(bytes);
            Check.True(FlawOf(bytes) != DatagramFlaw.None, "random bytes were accepted");
        }
    }

    internal static List<byte[]> Fragments(DatagramHeader header, byte[] message)
    {
        var datagrams = new List<byte[]>();
        int count = Math.Max(1, (message.Length + Datagram.LargestPayload - 1) / Datagram.LargestPayload);
        for (int i = 0; i < count; ++i)
        {
            int from = i * Datagram.LargestPayload;
            var part = new byte[Math.Min(Datagram.LargestPayload, message.Length - from)];
            Buffer.BlockCopy(message, from, part, 0, part.Length);
            header.FragmentIndex = (ushort)i;
            header.FragmentCount = (ushort)count;
            datagrams.Add(Written(header, part));
        }
        return datagrams;
    }

    internal static DatagramHeader HeaderOf(byte[] datagram)
    {
        DatagramHeader header;
        Check.Equal(DatagramFlaw.None, Datagram.Read(datagram, datagram.Length, out header), "flaw");
        return header;
    }

    internal static void Shuffle<T>(List<T> list, Random random)
    {
        for (int i = list.Count - 1; i > 0; --i)
        {
            int j = random.Next(i + 1);
            T other = list[i];
            list[i] = list[j];
            list[j] = other;
        }
    }

    public static void Fragments_InAnyOrderWithRepetitions_MakeTheMessage()
    {
        var random = new Random(Runner.Seed);
        var assembler = new MessageAssembler(100000);
        for (uint round = 0; round < 100; ++round)
        {
            var message = new byte[random.Next(20000)];
            random.NextBytes(message);
            DatagramHeader header = SomeHeader();
            header.Sequence = round;
            List<byte[]> datagrams = Fragments(header, message);
            Shuffle(datagrams, random);
            for (int i = 0; i < datagrams.Count; ++i)
            {
                bool last = i + 1 == datagrams.Count;
                Check.Equal(last ? MessageAssembler.Result.Complete : MessageAssembler.Result.Incomplete,
                    assembler.Add(HeaderOf(datagrams[i]), datagrams[i]), "fragment");
                if (last) break;
                Check.Equal(MessageAssembler.Result.Repeated,
                    assembler.Add(HeaderOf(datagrams[i]), datagrams[i]), "repeated");
            }
            Check.Equal(message.Length, assembler.Length, "length");
            for (int i = 0; i < message.Length; ++i) Check.Equal(message[i], assembler.Bytes.Get(i), "byte");
        }
    }

    public static void Fragments_ThatContradictOrGrowTooLarge_AreRefused()
    {
        var assembler = new MessageAssembler(3 * Datagram.LargestPayload);
        var datagram = new byte[Datagram.LargestSize];
        DatagramHeader header = SomeHeader();
        header.FragmentCount = 3;
        header.PayloadLength = Datagram.LargestPayload;
        Check.Equal(MessageAssembler.Result.Incomplete, assembler.Add(header, datagram), "first");
        header.FragmentIndex = 1;
        header.PayloadLength = 10;
        Check.Equal(MessageAssembler.Result.Refused, assembler.Add(header, datagram), "not full");
        header.FragmentCount = 2;
        header.PayloadLength = Datagram.LargestPayload;
        Check.Equal(MessageAssembler.Result.Refused, assembler.Add(header, datagram), "of 2, not of 3");
        header.FragmentCount = 4;
        header.FragmentIndex = 3;
        header.PayloadLength = 1;
        Check.Equal(MessageAssembler.Result.Refused, assembler.Add(header, datagram), "too large");
    }

    public static void Inbox_OverALosingNetwork_DeliversAllInOrderOnce()
    {
        var random = new Random(Runner.Seed);
        var inbox = new ReliableInbox();
        const int Messages = 500;
        var unacknowledged = new SortedDictionary<uint, List<byte[]>>();
        uint sent = 0;
        int next = 0;
        for (int round = 0; round < 100000 && next < Messages; ++round)
        {
            while (sent < Messages && unacknowledged.Count < ReliableInbox.MostUnderway)
            {
                var message = new byte[4 + random.Next(3000)];
                LittleEndianNumber(message, ++sent);
                DatagramHeader header = SomeHeader();
                header.Sequence = sent;
                unacknowledged.Add(sent, Fragments(header, message));
            }
            var way = new List<byte[]>();
            foreach (List<byte[]> datagrams in unacknowledged.Values) way.AddRange(datagrams);
            Shuffle(way, random);
            foreach (byte[] datagram in way)
            {
                if (random.Next(10) < 3) continue; // lost
                DatagramHeader header = HeaderOf(datagram);
                bool acknowledged = inbox.Add(header, datagram);
                if (acknowledged && random.Next(10) >= 3) unacknowledged.Remove(header.Sequence);
            }
            MessageAssembler taken;
            while ((taken = inbox.Take()) != null) Check.Equal((uint)++next, taken.Bytes.GetUint(0), "order");
        }
        Check.Equal(Messages, next, "delivered");
    }

    private static void LittleEndianNumber(byte[] bytes, uint value)
    {
        for (int i = 0; i < 4; ++i) bytes[i] = (byte)(value >> (8 * i));
    }

    public static void Statistics_CountGapsOrderAndPercentiles()
    {
        var statistics = new ClientStatistics();
        statistics.BeginConversation();
        // 1, then 3 .. 101 with latencies of 1 .. 99 ms/10, then 2 late and 101 again.
        statistics.Count(1, 50000);
        for (uint i = 3; i <= 101; ++i)
        {
            Check.True(statistics.IsNewer(i), "newer");
            statistics.Count(i, (i - 2) * 100000L);
        }
        Check.True(!statistics.IsNewer(2) && !statistics.IsNewer(101), "old ones");
        Check.Equal(100L, statistics.Received, "received");
        Check.Equal(1L, statistics.Lost, "lost");
        Check.Equal(2L, statistics.OutOfOrder, "out of order");
        Check.Near(100.0 / 101.0, statistics.Share, 1e-12, "share");
        // Nearest rank: of 100 sorted latencies the 50th and 99th; bins of 0.01 ms.
        Check.Near(4.9, statistics.LatencyMs(50), 0.0101, "p50");
        Check.Near(9.8, statistics.LatencyMs(99), 0.0101, "p99");
        Check.Near(9.9, statistics.MaxLatencyMs, 1e-9, "max");
        statistics.Count(uint.MaxValue / 2, 70000000);
        Check.Near(70.0, statistics.LatencyMs(100), 1e-9, "slower than the last bin");
    }

    public static void Statistics_NumbersThatWrap_AreInOrder()
    {
        var statistics = new ClientStatistics();
        for (uint i = uint.MaxValue - 2; i != 3; i = unchecked(i + 1))
        {
            Check.True(statistics.IsNewer(i), "newer " + i);
            statistics.Count(i, 1);
        }
        Check.Equal(0L, statistics.Lost, "lost");
    }
}
