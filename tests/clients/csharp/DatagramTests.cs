using System;
using System.Text;
using Wholehand;

[Tests]
public static class DatagramTests
{
    private static DatagramHeader SomeHeader()
    {
        return new DatagramHeader
        {
            Kind = DatagramKind.State, HoldsControls = true, Key = 0x0102030405060708, Sequence = 5, RateOrStop = 7,
            SentNs = -2, EchoNs = 3, EchoAgeUs = 4
        };
    }

    internal static byte[] Written(DatagramHeader header, byte[] payload)
    {
        var datagram = new byte[Datagram.LargestSize];
        int size = Datagram.Write(datagram, header, payload, 0, payload.Length);
        Array.Resize(ref datagram, size);
        return datagram;
    }

    private static DatagramFlaw FlawOf(byte[] bytes)
    {
        return Datagram.Read(bytes, bytes.Length, out DatagramHeader header);
    }

    public static void Crc32OfTheCheckString_IsThePublishedValue()
    {
        // CRC-32/ISO-HDLC: check = 0xcbf43926.
        byte[] text = Encoding.ASCII.GetBytes("123456789");
        Check.Equal(0xCBF43926u, Crc32.Of(text, 0, 9), "check value");
        Check.Equal(0xCBF43926u, Crc32.Of(text, 4, 5, Crc32.Of(text, 0, 4)), "in two parts");
    }

    public static void WrittenDatagram_MatchesTheDocumentByteByByte()
    {
        // The example of docs/udp.md, "An example"; the C++ side is tested with the same bytes.
        const string Expected = "57485544020010010807060504030201" + "0500000007000000feffffffffffffff"
            + "03000000000000000400000026fe6db6" + "616263";
        byte[] datagram = Written(SomeHeader(), Encoding.ASCII.GetBytes("abc"));
        Check.Equal(Expected, BitConverter.ToString(datagram).Replace("-", "").ToLowerInvariant(), "bytes");
        Check.Equal(DatagramFlaw.None, Datagram.Read(datagram, datagram.Length, out DatagramHeader header), "flaw");
        Check.Equal(DatagramKind.State, header.Kind, "kind");
        Check.True(header.HoldsControls, "controls");
        Check.Equal(0x0102030405060708UL, header.Key, "key");
        Check.Equal(5u, header.Sequence, "sequence");
        Check.Equal(7u, header.RateOrStop, "number");
        Check.Equal(-2L, header.SentNs, "time");
        Check.Equal(3L, header.EchoNs, "echo");
        Check.Equal(4u, header.EchoAgeUs, "its age");
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

    public static void RandomBytes_AreNeverAccepted()
    {
        var random = new Random(Runner.Seed);
        for (int i = 0; i < 5000; ++i)
        {
            var bytes = new byte[random.Next(1300)];
            random.NextBytes(bytes);
            Check.True(FlawOf(bytes) != DatagramFlaw.None, "random bytes were accepted");
        }
    }

    internal static DatagramHeader HeaderOf(byte[] datagram)
    {
        Check.Equal(DatagramFlaw.None, Datagram.Read(datagram, datagram.Length, out DatagramHeader header), "flaw");
        return header;
    }

    public static void Statistics_CountGapsOrderAndPercentiles()
    {
        var statistics = new ClientStatistics();
        statistics.BeginConversation();
        // Datagrams 1, then 3 .. 101 with latencies of 1 .. 99 ms/10, then 2 late and 101 again.
        Check.True(statistics.IsNewer(1), "newer");
        statistics.CountState(50000);
        for (uint i = 3; i <= 101; ++i)
        {
            Check.True(statistics.IsNewer(i), "newer");
            statistics.CountState((i - 2) * 100000L);
        }
        Check.True(!statistics.IsNewer(2) && !statistics.IsNewer(101), "old ones");
        Check.Equal(100L, statistics.Received, "received");
        Check.Equal(1L, statistics.Lost, "lost");
        Check.Equal(2L, statistics.OutOfOrder, "out of order");
        Check.Near(100.0 / 101.0, statistics.Share, 1e-12, "share");
        // Nearest rank: the 50th and 99th of 100 sorted latencies, in bins of 0.01 ms.
        Check.Near(4.9, statistics.LatencyMs(50), 0.0101, "p50");
        Check.Near(9.8, statistics.LatencyMs(99), 0.0101, "p99");
        Check.Near(9.9, statistics.MaxLatencyMs, 1e-9, "max");
        statistics.CountState(70000000);
        Check.Near(70.0, statistics.LatencyMs(100), 1e-9, "slower than the last bin");
    }

    public static void StatisticsOfWrappedNumbers_AreInOrder()
    {
        var statistics = new ClientStatistics();
        for (uint i = uint.MaxValue - 2; i != 3; i = unchecked(i + 1))
        {
            Check.True(statistics.IsNewer(i), "newer " + i);
        }
        Check.Equal(0L, statistics.Lost, "lost");
    }
}
