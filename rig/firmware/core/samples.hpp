// Samples and events in one numbered sequence. A sample stays here after it was sent, so that the host can ask for it again.
#pragma once
#include <cstdint>

#include "messages.hpp"
#include "wire.hpp"

namespace rig {

struct Sample {
  Type type = Type::kEvent;
  std::uint64_t time_us = 0;
  std::int32_t first = 0;   // load: counts; servo: command urad; event: value
  std::int32_t second = 0;  // servo: measured urad, kNoAngle without feedback
  std::uint16_t third = 0;  // servo: pulse us; event: code
  std::uint16_t fourth = 0; // servo: current mA
};

constexpr std::int32_t kNoAngle = INT32_MIN;

class Samples {
 public:
  static constexpr std::uint32_t kCapacity = 1024;  // 7 s of load cell (93.5 Hz) and servo (50 Hz)

  std::uint32_t add(const Sample& sample) {
    ring_[next_ % kCapacity] = sample;
    return next_++;
  }
  std::uint32_t next() const { return next_; }
  bool holds(std::uint32_t number) const { return number < next_ && next_ - number <= kCapacity; }
  void frame(std::uint32_t number, Frame& frame) const {
    const Sample& sample = ring_[number % kCapacity];
    frame.type = static_cast<std::uint8_t>(sample.type);
    frame.sequence = static_cast<std::uint8_t>(number);
    Writer out(frame);
    out.put(number).put(sample.time_us);
    switch (sample.type) {
      case Type::kLoad: out.put(sample.first); break;
      case Type::kServo: out.put(sample.first).put(sample.second).put(sample.third).put(sample.fourth); break;
      default: out.put(static_cast<std::uint8_t>(sample.third)).put(sample.first); break;
    }
  }

 private:
  Sample ring_[kCapacity];
  std::uint32_t next_ = 0;
};

}  // namespace rig
