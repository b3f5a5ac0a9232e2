import * as flatbuffers from 'flatbuffers';

/**
 * Bytes of a message whose vectors can be no longer than the message. A damaged length of 2^31 elements would keep the
 * page busy until its memory is spent.
 */
export class BoundedBuffer extends flatbuffers.ByteBuffer {
  private left = this.capacity();  // each element takes a byte at least, and is unpacked once

  override __vector_len(offset: number): number {
    const count = super.__vector_len(offset);
    this.left -= count;
    if (count < 0 || this.left < 0) throw new RangeError(`a vector of ${count} elements in ${this.capacity()} bytes`);
    return count;
  }
}
