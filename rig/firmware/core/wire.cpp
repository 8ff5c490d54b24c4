#include "wire.hpp"

namespace rig {

std::uint32_t crc32(const std::uint8_t* data, std::size_t size) {
  // Table for four bits at a time: 64 bytes of flash, fast enough for 115200 baud on a Cortex-M3.
  static constexpr std::uint32_t kTable[16] = {0x00000000, 0x1DB71064, 0x3B6E20C8, 0x26D930AC, 0x76DC4190, 0x6B6B51F4,
                                               0x4DB26158, 0x5005713C, 0xEDB88320, 0xF00F9344, 0xD6D6A3E8, 0xCB61B38C,
                                               0x9B64C2B0, 0x86D3D2D4, 0xA00AE278, 0xBDBDF21C};
  std::uint32_t crc = 0xFFFFFFFFu;
  for (std::size_t i = 0; i < size; ++i) {
    crc ^= data[i];
    crc = (crc >> 4) ^ kTable[crc & 15u];
    crc = (crc >> 4) ^ kTable[crc & 15u];
  }
  return ~crc;
}

std::size_t encode(const Frame& frame, std::uint8_t* out) {
  std::uint8_t payload[kMaxPayload];
  std::size_t size = 0;
  payload[size++] = frame.type;
  payload[size++] = frame.sequence;
  for (std::size_t i = 0; i < frame.size && i < kMaxBody; ++i) payload[size++] = frame.body[i];
  const std::uint32_t crc = crc32(payload, size);
  for (unsigned shift = 0; shift < 32; shift += 8) payload[size++] = static_cast<std::uint8_t>((crc >> shift) & 0xFF);

  // COBS: every zero is replaced by the distance to the next one; payloads are shorter than 254, so one code byte leads.
  std::size_t code_at = 0, written = 1;
  std::uint8_t code = 1;
  for (std::size_t i = 0; i < size; ++i) {
    if (payload[i] == 0) {
      out[code_at] = code;
      code_at = written++;
      code = 1;
    } else {
      out[written++] = payload[i];
      ++code;
    }
  }
  out[code_at] = code;
  out[written++] = 0;
  return written;
}

Parsed Parser::take(std::uint8_t byte, Frame& frame) {
  if (byte != 0) {
    if (size_ < kMaxFrame - 1)
      buffer_[size_++] = byte;
    else
      overflow_ = true;
    return Parsed::kNothing;
  }
  const bool empty = size_ == 0 && !overflow_;  // a lone delimiter is idle line, not an error
  const Parsed result = empty ? Parsed::kNothing : overflow_ ? Parsed::kBad : finish(frame);
  size_ = 0;
  overflow_ = false;
  return result;
}

Parsed Parser::finish(Frame& frame) const {
  std::uint8_t payload[kMaxFrame];
  std::size_t size = 0, at = 0;
  while (at < size_) {
    const std::uint8_t code = buffer_[at++];
    if (code - 1u > size_ - at) return Parsed::kBad;
    for (unsigned i = 1; i < code; ++i) payload[size++] = buffer_[at++];
    if (at < size_ && code < 0xFF) payload[size++] = 0;
  }
  if (size < 6 || size > kMaxPayload) return Parsed::kBad;
  std::uint32_t stated = 0;
  for (std::size_t i = 0; i < 4; ++i) stated |= static_cast<std::uint32_t>(payload[size - 4 + i]) << (8 * i);
  if (stated != crc32(payload, size - 4)) return Parsed::kBad;
  frame.type = payload[0];
  frame.sequence = payload[1];
  frame.size = size - 6;
  for (std::size_t i = 0; i < frame.size; ++i) frame.body[i] = payload[2 + i];
  return Parsed::kFrame;
}

}  // namespace rig
