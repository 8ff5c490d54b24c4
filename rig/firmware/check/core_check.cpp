// Checks of the core on this machine: byte examples of docs/protocol.md, the HX711's error rules, the watchdog, and fuzz.
//   core_check [--vectors docs/protocol.md] [--random N] [--mutated N] [--seed N]
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <fstream>
#include <memory>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "../core/board.hpp"

#define CHECK(condition)                                                       \
  do {                                                                         \
    if (!(condition)) {                                                        \
      std::fprintf(stderr, "%s:%d: not so: %s\n", __FILE__, __LINE__, #condition); \
      std::exit(1);                                                            \
    }                                                                          \
  } while (false)

namespace {

using rig::Type;

// A bench whose servo pin refuses what it must never see.
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
    pulse = microseconds;
    ++pulses;
  }
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
  long pulses = 0;
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

std::vector<std::uint8_t> limits(std::int32_t reach = 800000, std::uint32_t speed = 8000000) {
  return body<std::int32_t, std::int32_t, std::uint32_t, std::uint16_t, std::uint16_t, std::int16_t>(-reach, reach, speed, 900, 1500, 637);
}

std::vector<std::uint8_t> points(std::uint32_t index, std::uint8_t count, std::int32_t urad) {
  std::vector<std::uint8_t> bytes = body(index, count);
  for (int i = 0; i < count; ++i)
    for (const std::uint8_t byte : body(urad)) bytes.push_back(byte);
  return bytes;
}

void arm_and_start(Bench& bench, rig::Board& board, std::int32_t urad, int chunks, std::uint32_t total) {
  bench.send(Type::kLimits, 1, limits());
  bench.run(board, 0.05);
  for (int i = 0; i < chunks; ++i) bench.send(Type::kPoints, static_cast<std::uint8_t>(2 + i), points(static_cast<std::uint32_t>(24 * i), 24, urad));
  bench.send(Type::kStart, 100, body<std::uint64_t, std::uint32_t, std::uint32_t>(bench.now_us + 50000, 20000, total));
  bench.run(board, 0.02);
  CHECK(bench.count(Type::kNak) == 0);
}

std::vector<std::uint8_t> bytes_of(const std::string& hex) {
  std::vector<std::uint8_t> bytes;
  if (hex == "-") return bytes;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2) bytes.push_back(static_cast<std::uint8_t>(std::stoi(hex.substr(i, 2), nullptr, 16)));
  return bytes;
}

int check_vectors(const std::string& path) {
  std::ifstream file(path);
  CHECK(file.good());
  std::string line;
  bool inside = false;
  int checked = 0;
  while (std::getline(file, line)) {
    if (line.rfind("```", 0) == 0) {
      inside = line == "```vectors";
      continue;
    }
    if (!inside) continue;
    std::istringstream in(line);
    std::string name, type, sequence, body_hex, frame_hex;
    in >> name >> type >> sequence >> body_hex >> frame_hex;
    rig::Frame frame;
    frame.type = bytes_of(type)[0];
    frame.sequence = bytes_of(sequence)[0];
    for (const std::uint8_t byte : bytes_of(body_hex)) frame.body[frame.size++] = byte;
    std::uint8_t encoded[rig::kMaxFrame];
    const std::size_t size = rig::encode(frame, encoded);
    const auto expected = bytes_of(frame_hex);
    CHECK(size == expected.size() && std::memcmp(encoded, expected.data(), size) == 0);
    rig::Parser parser;
    rig::Frame back;
    rig::Parsed result = rig::Parsed::kNothing;
    for (const std::uint8_t byte : expected) result = parser.take(byte, back);
    CHECK(result == rig::Parsed::kFrame && back.type == frame.type && back.size == frame.size);
    CHECK(std::memcmp(back.body, frame.body, back.size) == 0);
    ++checked;
  }
  CHECK(checked > 0);
  return checked;
}

void check_run_and_clock_wrap() {
  Bench bench;
  rig::Board board(bench);
  bench.run(board, 0.001);
  CHECK(bench.count(Type::kBoot) == 1);
  CHECK(bench.pulses == 0);  // no limits yet: no pulse
  bench.send(Type::kPoints, 1, points(0, 4, 0));
  bench.run(board, 0.01);
  CHECK(bench.count(Type::kNak) == 1);
  bench.out.clear();
  arm_and_start(bench, board, 500000, 3, 72);
  for (int i = 0; i < 20; ++i) {
    bench.send(Type::kPing, 0, body<std::uint32_t>(7));
    bench.run(board, 0.1);
  }
  CHECK(bench.saw(rig::EventCode::kStarted) && bench.saw(rig::EventCode::kComplete));
  CHECK(!bench.saw(rig::EventCode::kWatchdog));
  CHECK(board.state() == rig::State::kReady && bench.pulse == 1500);
  CHECK(bench.now_us > 4294967296u);  // the run went over the wrap of the 32-bit clock
}

void check_watchdog() {
  Bench bench;
  rig::Board board(bench);
  bench.run(board, 0.001);
  arm_and_start(bench, board, 800000, 10, 240);
  for (int i = 0; i < 10; ++i) {
    bench.send(Type::kPing, 0, body<std::uint32_t>(7));
    bench.run(board, 0.1);
  }
  CHECK(bench.pulse > 2000);
  bench.run(board, 0.25 + 0.02 + 0.1 + 0.04);  // silence, one frame, 0.8 rad at 8 rad/s, and two frames more
  CHECK(bench.saw(rig::EventCode::kWatchdog));
  CHECK(bench.pulse == 1500);
}

void check_overcurrent_and_underrun() {
  for (const bool jam : {true, false}) {
    Bench bench;
    rig::Board board(bench);
    bench.run(board, 0.001);
    arm_and_start(bench, board, 300000, jam ? 5 : 1, 120);
    bench.current = jam ? 5000 : 0;
    for (int i = 0; i < 10; ++i) {
      bench.send(Type::kPing, 0, body<std::uint32_t>(7));
      bench.run(board, 0.1);
    }
    CHECK(bench.saw(jam ? rig::EventCode::kOvercurrent : rig::EventCode::kUnderrun));
    CHECK(bench.pulse == 1500);
  }
}

void check_repeated_command() {
  Bench bench;
  rig::Board board(bench);
  bench.run(board, 0.001);
  bench.send(Type::kLimits, 1, limits());
  bench.run(board, 0.05);
  for (int i = 0; i < 3; ++i) bench.send(Type::kPoints, 2, points(0, 4, 100));
  bench.run(board, 0.01);
  CHECK(bench.count(Type::kAck) == 4 && bench.count(Type::kNak) == 0);
  bench.send(Type::kPoints, 3, points(4, 4, 900000));  // outside the limits
  bench.run(board, 0.01);
  CHECK(bench.count(Type::kNak) == 1);
}

void check_cell() {
  struct Case {
    rig::CellError expected;
    void (*spoil)(Bench&);
  };
  const Case cases[] = {
      {rig::CellError::kNotReady, [](Bench& bench) { bench.dead = true; }},
      {rig::CellError::kGainBits, [](Bench& bench) { bench.bad_gain = true; }},
      {rig::CellError::kStretched, [](Bench& bench) { bench.stretch = true; }},
      {rig::CellError::kSaturated, [](Bench& bench) { bench.convert(0x7FFFFF); }},
  };
  for (const Case& one : cases) {
    Bench bench;
    rig::Hx711 cell;
    rig::CellReading out[2];
    int reported = 0;
    const auto convert = [&](std::uint32_t bits) {
      bench.convert(bits);
      for (int i = 0; i < 4; ++i, bench.now_us += 2700) reported += cell.poll(bench, bench.now_us, out);
    };
    for (int i = 0; i < 4; ++i) convert(1000);
    CHECK(reported == 0);  // settling after power-up
    convert(0xFFFFFE);
    CHECK(reported == 1 && out[0].counts == -2);
    convert(0xFFFFFF);  // -1, or a dead chip: withheld until the next conversion
    CHECK(reported == 1);
    convert(5);
    CHECK(reported == 3 && out[0].counts == -1 && out[1].counts == 5);
    rig::CellError error;
    CHECK(!cell.changed(error));

    bench.convert(123);
    one.spoil(bench);
    for (int i = 0; i < 200 && cell.error() == rig::CellError::kNone; ++i, bench.now_us += 2700)
      reported += cell.poll(bench, bench.now_us, out);
    CHECK(cell.changed(error) && error == one.expected && reported == 3);
    bench.dead = bench.bad_gain = bench.stretch = bench.ready = false;
    bench.now_us += 1000;
    reported += cell.poll(bench, bench.now_us, out);  // powers the chip down
    bench.now_us += 1000;
    reported += cell.poll(bench, bench.now_us, out);  // and up
    for (int i = 0; i < 4; ++i) convert(1000);
    CHECK(reported == 3 && cell.changed(error) && error == rig::CellError::kNone);
    convert(77);
    CHECK(reported == 4 && out[0].counts == 77);
  }
  Bench bench;  // all ones, then silence: the held reading is never reported
  rig::Hx711 cell;
  rig::CellReading out[2];
  int reported = 0;
  for (int i = 0; i < 5; ++i) {
    bench.convert(i < 4 ? 10u : 0xFFFFFFu);
    for (int j = 0; j < 4; ++j, bench.now_us += 2700) reported += cell.poll(bench, bench.now_us, out);
  }
  bench.dead = true;
  for (int i = 0; i < 200; ++i, bench.now_us += 2700) reported += cell.poll(bench, bench.now_us, out);
  CHECK(reported == 0 && cell.error() == rig::CellError::kWentSilent);
}

// Random bytes, and valid frames with bytes changed, lost and doubled. The bench's servo pin does the checking.
void fuzz(long frames, bool mutated, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  Bench bench;
  auto board = std::make_unique<rig::Board>(bench);
  bench.run(*board, 0.001);
  const auto below = [&](std::uint64_t bound) { return random() % bound; };
  for (long i = 0; i < frames; ++i) {
    if (!mutated) {
      const std::size_t size = 1 + below(140);
      for (std::size_t k = 0; k < size; ++k) bench.in.push_back(static_cast<std::uint8_t>(random()));
      bench.in.push_back(0);
    } else {
      static constexpr Type kTypes[] = {Type::kHello, Type::kPing,    Type::kLimits, Type::kStream, Type::kPoints, Type::kStart,
                                        Type::kNeutral, Type::kFlash, Type::kResend, Type::kClear,  Type::kPoints, Type::kPing};
      const Type type = kTypes[below(12)];
      std::vector<std::uint8_t> contents;
      if (type == Type::kLimits)
        contents = limits(static_cast<std::int32_t>(random()) % 1700000, static_cast<std::uint32_t>(below(25000000)));
      else if (type == Type::kPoints)
        contents = points(static_cast<std::uint32_t>(below(4) * 24), static_cast<std::uint8_t>(below(27)), static_cast<std::int32_t>(random()) % 900000);
      else if (type == Type::kStart)
        contents = body<std::uint64_t, std::uint32_t, std::uint32_t>(bench.now_us + below(100000), static_cast<std::uint32_t>(below(40000)), static_cast<std::uint32_t>(below(200)));
      else
        for (std::size_t k = below(8); k > 0; --k) contents.push_back(static_cast<std::uint8_t>(random()));
      // Half stay whole at the level of bytes (their contents are odd enough), half are damaged on the way.
      const std::size_t before = bench.in.size();
      bench.send(type, static_cast<std::uint8_t>(random()), contents);
      if (below(2) == 0) {
        const std::size_t at = before + below(bench.in.size() - before);
        const auto place = bench.in.begin() + static_cast<std::ptrdiff_t>(at);
        switch (below(3)) {
          case 0: *place = static_cast<std::uint8_t>(random()); break;
          case 1: bench.in.erase(place); break;
          default: bench.in.insert(place, *place); break;
        }
      }
    }
    if (below(3) == 0) bench.convert(static_cast<std::uint32_t>(random()));
    bench.run(*board, 0.004, 2000);
    if (bench.out.size() > 4096) bench.out.clear();
  }
  std::printf("%ld %s frames: %ld pulses, none beyond a limit\n", frames, mutated ? "mutated" : "random", bench.pulses);
}

}  // namespace

int main(int count, char** words) {
  long random = 2000, mutated = 2000;
  std::uint64_t seed = 1;
  for (int i = 1; i + 1 < count; i += 2) {
    const std::string name = words[i];
    if (name == "--vectors") std::printf("%d byte examples agree\n", check_vectors(words[i + 1]));
    else if (name == "--random") random = std::stol(words[i + 1]);
    else if (name == "--mutated") mutated = std::stol(words[i + 1]);
    else if (name == "--seed") seed = std::stoull(words[i + 1]);
    else return std::fprintf(stderr, "core_check: %s is not known\n", words[i]), 2;
  }
  const std::uint8_t digits[] = {'1', '2', '3', '4', '5', '6', '7', '8', '9'};
  CHECK(rig::crc32(digits, sizeof digits) == 0xCBF43926u);
  check_run_and_clock_wrap();
  check_watchdog();
  check_overcurrent_and_underrun();
  check_repeated_command();
  check_cell();
  fuzz(random, false, seed);
  fuzz(mutated, true, seed);
  std::puts("core: all checks passed");
  return 0;
}
