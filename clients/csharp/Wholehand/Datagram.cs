using System;

namespace Wholehand
{
    /// <summary>The kind of a datagram; docs/udp.md.</summary>
    public enum DatagramKind : byte
    {
        Command = 1,
        Alive = 2,
        State = 16,
        Present = 17
    }

    /// <summary>Why a datagram is invalid, in the order of the checks.</summary>
    public enum DatagramFlaw
    {
        None,
        TooShort,
        TooLong,
        Magic,
        Version,
        Checksum,
        Header
    }

    /// <summary>The header of every datagram.</summary>
    public struct DatagramHeader
    {
        public DatagramKind Kind;
        public bool HoldsControls;   // from the program: this game holds the controls
        public ulong Key;            // key of the conversation
        public uint Sequence;        // increases with every datagram of the sender
        public uint RateOrStop;      // from a game: states per second; from the program: last obeyed emergency stop
        public long SentNs;          // the sender's clock
        public long EchoNs;          // SentNs of the newest datagram of the other side; 0: none
        public uint EchoAgeUs;       // time since that one came
    }

    /// <summary>Writes and checks datagrams: 48 bytes of header, little-endian, and a payload. Allocates
    /// nothing.</summary>
    public static class Datagram
    {
        public const int LargestSize = 1200;
        public const int HeaderSize = 48;
        public const int LargestPayload = LargestSize - HeaderSize;
        public const uint Magic = 0x44554857; // "WHUD"
        public const ushort Version = 2;

        private const int ChecksumAt = 44;

        /// <summary>Writes one datagram; returns its size.</summary>
        public static int Write(byte[] datagram, DatagramHeader header, byte[] payload, int offset, int length)
        {
            if (length > LargestPayload) throw new ArgumentException("the payload is too large", "length");
            Put(datagram, 0, Magic, 4);
            Put(datagram, 4, Version, 2);
            Put(datagram, 6, (byte)header.Kind, 1);
            Put(datagram, 7, header.HoldsControls ? 1u : 0u, 1);
            Put(datagram, 8, header.Key, 8);
            Put(datagram, 16, header.Sequence, 4);
            Put(datagram, 20, header.RateOrStop, 4);
            Put(datagram, 24, (ulong)header.SentNs, 8);
            Put(datagram, 32, (ulong)header.EchoNs, 8);
            Put(datagram, 40, header.EchoAgeUs, 4);
            if (length > 0) Buffer.BlockCopy(payload, offset, datagram, HeaderSize, length);
            Put(datagram, ChecksumAt, Checksum(datagram, HeaderSize + length), 4);
            return HeaderSize + length;
        }

        /// <summary>Checks the first <paramref name="size"/> bytes and reads their header; the payload
        /// begins at HeaderSize.</summary>
        public static DatagramFlaw Read(byte[] bytes, int size, out DatagramHeader header)
        {
            header = new DatagramHeader();
            if (size < HeaderSize) return DatagramFlaw.TooShort;
            if (size > LargestSize) return DatagramFlaw.TooLong;
            if (Get(bytes, 0, 4) != Magic) return DatagramFlaw.Magic;
            if (Get(bytes, 4, 2) != Version) return DatagramFlaw.Version;
            if (Get(bytes, ChecksumAt, 4) != Checksum(bytes, size)) return DatagramFlaw.Checksum;
            header.Kind = (DatagramKind)bytes[6];
            header.HoldsControls = bytes[7] == 1;
            header.Key = Get(bytes, 8, 8);
            header.Sequence = (uint)Get(bytes, 16, 4);
            header.RateOrStop = (uint)Get(bytes, 20, 4);
            header.SentNs = (long)Get(bytes, 24, 8);
            header.EchoNs = (long)Get(bytes, 32, 8);
            header.EchoAgeUs = (uint)Get(bytes, 40, 4);
            return IsSound(header.Kind, bytes[7], size - HeaderSize) ? DatagramFlaw.None : DatagramFlaw.Header;
        }

        private static bool IsSound(DatagramKind kind, byte flags, int payload)
        {
            switch (kind)
            {
                case DatagramKind.Command: return flags == 0 && payload > 0;
                case DatagramKind.Alive: return flags == 0 && payload == 0;
                case DatagramKind.State: return flags <= 1 && payload > 0;
                case DatagramKind.Present: return flags <= 1 && payload == 0;
                default: return false;
            }
        }

        // Checksum of everything except the checksum field.
        private static uint Checksum(byte[] datagram, int size)
        {
            return Crc32.Of(datagram, HeaderSize, size - HeaderSize, Crc32.Of(datagram, 0, ChecksumAt));
        }

        private static ulong Get(byte[] bytes, int at, int count)
        {
            ulong value = 0;
            for (int i = count - 1; i >= 0; --i) value = value << 8 | bytes[at + i];
            return value;
        }

        private static void Put(byte[] bytes, int at, ulong value, int count)
        {
            for (int i = 0; i < count; ++i) bytes[at + i] = (byte)(value >> (8 * i));
        }
    }
}
