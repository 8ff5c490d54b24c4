// The wire: little-endian integers, CRC-32, COBS frames. Nothing here allocates, blocks or throws.
// docs/protocol.md is the contract; its byte examples are checked by tests on both sides.
#pragma once
#include <cstddef>
#include <cstdint>

namespace rig {

constexpr std::size_t kMaxBody = 112;
constexpr std::size_t kMaxPayload = 2 + kMaxBody + 4;   // type, sequence, body, CRC
constexpr std::size_t kMaxFrame = kMaxPayload + 2;      // one COBS byte (payload < 254), one delimiter

// CRC-32 (IEEE 802.3, reflected, as zlib's crc32); "123456789" gives 0xCBF43926.
std::uint32_t crc32(const std::uint8_t* data, std::size_t size);

struct Frame {
  std::uint8_t type = 0;
  std::uint8_t sequence = 0;
  std::uint8_t body[kMaxBody] = {};
  std::size_t size = 0;  // of the body
};

// Writes `frame` as COBS bytes with a trailing zero; `out` holds kMaxFrame. Returns the number of bytes.
std::size_t encode(const Frame& frame, std::uint8_t* out);

enum class Parsed { kNothing, kFrame, kBad };

// Takes bytes one at a time. A frame that is too long, badly stuffed or whose CRC is wrong is kBad: never a frame.
class Parser {
 public:
  Parsed take(std::uint8_t byte, Frame& frame);

 private:
  Parsed finish(Frame& frame) const;

  std::uint8_t buffer_[kMaxFrame] = {};
  std::size_t size_ = 0;
  bool overflow_ = false;
};

// Appends and reads little-endian integers; a reader past the end gives zero and remembers that it failed.
class Writer {
 public:
  explicit Writer(Frame& frame) : frame_(frame) { frame_.size = 0; }
  template <typename Integer>
  Writer& put(Integer value) {
    auto bits = static_cast<std::uint64_t>(value);
    for (std::size_t i = 0; i < sizeof(Integer) && frame_.size < kMaxBody; ++i, bits >>= 8)
      frame_.body[frame_.size++] = static_cast<std::uint8_t>(bits & 0xFF);
    return *this;
  }

 private:
  Frame& frame_;
};

class Reader {
 public:
  explicit Reader(const Frame& frame) : frame_(frame) {}
  template <typename Integer>
  Integer get() {
    if (sizeof(Integer) > frame_.size - at_) {
      at_ = frame_.size;
      failed_ = true;
      return 0;
    }
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < sizeof(Integer); ++i) bits |= static_cast<std::uint64_t>(frame_.body[at_++]) << (8 * i);
    return static_cast<Integer>(bits);
  }
  // True when the body was exactly as long as what was read from it.
  bool complete() const { return !failed_ && at_ == frame_.size; }

 private:
  const Frame& frame_;
  std::size_t at_ = 0;
  bool failed_ = false;
};

}  // namespace rig
