namespace Wholehand
{
    /// <summary>CRC-32 of IEEE 802.3 and zlib. FlatBuffers has no verifier in C#: the checksum shows
    /// that a datagram is complete.</summary>
    public static class Crc32
    {
        private static readonly uint[] Table = MakeTable();

        /// <summary>Continues from <paramref name="before"/>. Allocates nothing.</summary>
        public static uint Of(byte[] bytes, int offset, int count, uint before = 0)
        {
            uint c = ~before;
            for (int i = offset; i < offset + count; ++i)
            {
                c = Table[(c ^ bytes[i]) & 0xFF] ^ (c >> 8);
            }
            return ~c;
        }

        private static uint[] MakeTable()
        {
            var table = new uint[256];
            for (uint i = 0; i < 256; ++i)
            {
                uint c = i;
                for (int bit = 0; bit < 8; ++bit)
                {
                    c = (c & 1) != 0 ? 0xEDB88320u ^ (c >> 1) : c >> 1;
                }
                table[i] = c;
            }
            return table;
        }
    }
}
