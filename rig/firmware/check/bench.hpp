// A bench for the board's core: pins and line as the checks want them, and a servo pin that refuses what it must never see.
#pragma once
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <vector>

#include "../core/board.hpp"

#define CHECK(condition)                                                       \
  do {                                                                         \
    if (!(condition)) {                                                        \
      std::fprintf(stderr, "%s:%d: not so: %s\n", __FILE__, __LINE__, #condition); \
      std::exit(1);                                                            \
    }                                                                          \
  } while (false)

using rig::Type;

class Bench final : public rig::Hardware {
 public:
  std::uint32_t micros() override { return static_cast<std::uint32_t>(now_us); }
  std::uint32_t boot_id() override { return 0xB007; }
  int read_byte() override {
    if (in.empty()) return -1;
    const int byte = in.front();
    in.pop_front();
    return byte;
  }
  std::size_t write_bytes(const std::uint8_t* data, std::size_t size) override {
    rig::Frame frame;
    for (std::size_t i = 0; i < size; ++i)
      if (parser.take(data[i], frame) == rig::Parsed::kFrame) out.push_back(frame);
    return size;
  }
  void servo_pulse(std::uint16_t microseconds) override {
    CHECK(microseconds >= rig::kHardPulseMin && microseconds <= rig::kHardPulseMax);
    CHECK(board != nullptr && board->servo().armed());
    const rig::Limits& limits = board->servo().limits();
    CHECK(limits.contains(board->servo().angle_urad()));
    const double stride = 1e-6 * limits.speed_urad_s * 0.02 * std::abs(limits.us_per_rad) + 1;
    CHECK(pulse == 0 || std::abs(microseconds - pulse) <= stride);
    moves += pulse != 0 && pulse != microseconds;
    pulse = microseconds;
    ++pulses;
  }
  void servo_off() override { pulse = 0; }
  bool servo_angle(std::int32_t&) override { return false; }
  std::uint16_t servo_current_ma() override { return current; }
  bool cell_data() override {
    if (dead) return true;
    if (!ready) return true;
    if (bit == 0) return false;
    return bit > 24 ? !bad_gain : ((value >> (24 - bit)) & 1u) != 0;
  }
  void cell_clock(bool high) override {
    if (high) ++bit;
    if (high && stretch) now_us += 70;
    if (!high && bit >= 25 && !bad_gain) ready = false;
  }
  void interrupts(bool) override {}
  void led(bool on) override { lit = on; }

  void convert(std::uint32_t bits) {
    value = bits & 0xFFFFFFu;
    bit = 0;
    ready = true;
  }
  void send(Type type, std::uint8_t sequence, const std::vector<std::uint8_t>& body) {
    rig::Frame frame;
    frame.type = static_cast<std::uint8_t>(type);
    frame.sequence = sequence;
    for (const std::uint8_t byte : body) frame.body[frame.size++] = byte;
    std::uint8_t bytes[rig::kMaxFrame];
    const std::size_t size = rig::encode(frame, bytes);
    in.insert(in.end(), bytes, bytes + size);
  }
  void run(rig::Board& on, double seconds, std::uint64_t stride_us = 250) {
    board = &on;
    for (const std::uint64_t end = now_us + static_cast<std::uint64_t>(1e6 * seconds); now_us < end; now_us += stride_us) on.step();
  }
  int count(Type type) const {
    int found = 0;
    for (const rig::Frame& frame : out) found += frame.type == static_cast<std::uint8_t>(type);
    return found;
  }
  bool saw(rig::EventCode code) const {
    for (const rig::Frame& frame : out)
      if (frame.type == static_cast<std::uint8_t>(Type::kEvent) && frame.body[12] == static_cast<std::uint8_t>(code)) return true;
    return false;
  }

  std::uint64_t now_us = 4294000000u;  // 32-bit microseconds wrap 0.97 s into every check
  std::deque<std::uint8_t> in;
  std::vector<rig::Frame> out;
  rig::Parser parser;
  rig::Board* board = nullptr;
  std::uint32_t value = 0;
  int bit = 0, pulse = 0;
  long pulses = 0, moves = 0;
  std::uint16_t current = 0;
  bool ready = false, dead = false, bad_gain = false, stretch = false, lit = false;
};

template <typename... Integers>
std::vector<std::uint8_t> body(Integers... values) {
  rig::Frame frame;
  rig::Writer out(frame);
  (out.put(values), ...);
  return {frame.body, frame.body + frame.size};
}

inline std::vector<std::uint8_t> limits(std::int32_t reach = 800000, std::uint32_t speed = 8000000) {
  return body<std::int32_t, std::int32_t, std::uint32_t, std::uint16_t, std::uint16_t, std::int16_t>(-reach, reach, speed, 900, 1500, 637);
}

inline std::vector<std::uint8_t> points(std::uint32_t index, std::uint8_t count, std::int32_t urad) {
  std::vector<std::uint8_t> bytes = body(index, count);
  for (int i = 0; i < count; ++i)
    for (const std::uint8_t byte : body(urad)) bytes.push_back(byte);
  return bytes;
}

inline void arm_and_start(Bench& bench, rig::Board& board, std::int32_t urad, int chunks, std::uint32_t total) {
  bench.send(Type::kLimits, 1, limits());
  bench.run(board, 0.05);
  for (int i = 0; i < chunks; ++i) bench.send(Type::kPoints, static_cast<std::uint8_t>(2 + i), points(static_cast<std::uint32_t>(24 * i), 24, urad));
  bench.send(Type::kStart, 100, body<std::uint64_t, std::uint32_t, std::uint32_t>(bench.now_us + 50000, 20000, total));
  bench.run(board, 0.02);
  CHECK(bench.count(Type::kNak) == 0);
}
