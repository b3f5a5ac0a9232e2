using System;

namespace Wholehand
{
    /// <summary>What a datagram is; docs/udp.md.</summary>
    public enum DatagramKind : byte
    {
        Hello = 1,
        Message = 2,
        Heartbeat = 3,
        Goodbye = 4,
        Welcome = 16,
        State = 17,
        Reliable = 18,
        Refused = 19
    }

    /// <summary>Why a datagram is no good, in the order in which it is looked at.</summary>
    public enum DatagramFlaw
    {
        None,
        TooLong,
        TooShort,
        Magic,
        Version,
        Length,
        Checksum,
        Header
    }

    /// <summary>The header of every datagram.</summary>
    public struct DatagramHeader
    {
        public DatagramKind Kind;
        public uint Session;         // of the conversation; 0 in a Hello
        public uint Sequence;        // of the message; its fragments share it
        public long MonotonicNs;     // the sender's clock
        public ushort FragmentIndex;
        public ushort FragmentCount;
        public ushort PayloadLength;
    }

    /// <summary>Writes and checks datagrams: 36 bytes of header, little-endian, and a payload. Allocates
    /// nothing.</summary>
    public static class Datagram
    {
        public const int LargestSize = 1200;
        public const int HeaderSize = 36;
        public const int LargestPayload = LargestSize - HeaderSize;
        public const int MostFragments = 1024;
        public const uint Magic = 0x44554857; // "WHUD"
        public const ushort Version = 1;

        private const int ChecksumAt = 32;

        /// <summary>Writes one datagram; its size.</summary>
        public static int Write(byte[] datagram, DatagramHeader header, byte[] payload, int offset, int length)
        {
            if (length > LargestPayload) throw new ArgumentException("the payload is too large", "length");
            LittleEndian.Put(datagram, 0, Magic);
            LittleEndian.Put(datagram, 4, Version);
            datagram[6] = (byte)header.Kind;
            datagram[7] = 0;
            LittleEndian.Put(datagram, 8, header.Session);
            LittleEndian.Put(datagram, 12, header.Sequence);
            LittleEndian.Put(datagram, 16, (ulong)header.MonotonicNs);
            LittleEndian.Put(datagram, 24, header.FragmentIndex);
            LittleEndian.Put(datagram, 26, header.FragmentCount);
            LittleEndian.Put(datagram, 28, (ushort)length);
            LittleEndian.Put(datagram, 30, (ushort)0);
            if (length > 0) Buffer.BlockCopy(payload, offset, datagram, HeaderSize, length);
            LittleEndian.Put(datagram, ChecksumAt, Checksum(datagram, HeaderSize + length));
            return HeaderSize + length;
        }

        /// <summary>Checks the first <paramref name="size"/> bytes and reads their header; the payload
        /// begins at HeaderSize.</summary>
        public static DatagramFlaw Read(byte[] bytes, int size, out DatagramHeader header)
        {
            header = new DatagramHeader();
            if (size > LargestSize) return DatagramFlaw.TooLong;
            if (size < HeaderSize) return DatagramFlaw.TooShort;
            if (LittleEndian.U32(bytes, 0) != Magic) return DatagramFlaw.Magic;
            if (LittleEndian.U16(bytes, 4) != Version) return DatagramFlaw.Version;
            header.PayloadLength = LittleEndian.U16(bytes, 28);
            if (header.PayloadLength != size - HeaderSize) return DatagramFlaw.Length;
            if (LittleEndian.U32(bytes, ChecksumAt) != Checksum(bytes, size)) return DatagramFlaw.Checksum;
            header.Kind = (DatagramKind)bytes[6];
            header.Session = LittleEndian.U32(bytes, 8);
            header.Sequence = LittleEndian.U32(bytes, 12);
            header.MonotonicNs = (long)LittleEndian.U64(bytes, 16);
            header.FragmentIndex = LittleEndian.U16(bytes, 24);
            header.FragmentCount = LittleEndian.U16(bytes, 26);
            bool sound = IsKnown(bytes[6]) && bytes[7] == 0 && LittleEndian.U16(bytes, 30) == 0
                && header.FragmentCount >= 1 && header.FragmentCount <= MostFragments
                && header.FragmentIndex < header.FragmentCount;
            return sound ? DatagramFlaw.None : DatagramFlaw.Header;
        }

        private static bool IsKnown(byte kind)
        {
            return (kind >= 1 && kind <= 4) || (kind >= 16 && kind <= 19);
        }

        // Of everything but the checksum itself.
        private static uint Checksum(byte[] datagram, int size)
        {
            return Crc32.Of(datagram, HeaderSize, size - HeaderSize, Crc32.Of(datagram, 0, ChecksumAt));
        }
    }

    internal static class LittleEndian
    {
        public static ushort U16(byte[] b, int i)
        {
            return (ushort)(b[i] | b[i + 1] << 8);
        }

        public static uint U32(byte[] b, int i)
        {
            return U16(b, i) | (uint)U16(b, i + 2) << 16;
        }

        public static ulong U64(byte[] b, int i)
        {
            return U32(b, i) | (ulong)U32(b, i + 4) << 32;
        }

        public static void Put(byte[] b, int i, ushort value)
        {
            b[i] = (byte)value;
            b[i + 1] = (byte)(value >> 8);
        }

        public static void Put(byte[] b, int i, uint value)
        {
            Put(b, i, (ushort)value);
            Put(b, i + 2, (ushort)(value >> 16));
        }

        public static void Put(byte[] b, int i, ulong value)
        {
            Put(b, i, (uint)value);
            Put(b, i + 4, (uint)(value >> 32));
        }
    }
}
