// Checks of the core on this machine: byte examples of docs/protocol.md, the HX711's error rules, the watchdog, and fuzz.
//   core_check [--vectors docs/protocol.md] [--random N] [--mutated N] [--seed N]
#include <cstdio>
#include <cstring>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "bench.hpp"
#include "fuzz.hpp"

namespace {

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
    CHECK(bench.pulse == (jam ? 0 : 1500));
  }
}

// A servo that stalls is off in every state, and stays off until CLEAR and LIMITS; a queue that was played is not
// played again before CLEAR.
void check_latch() {
  Bench bench;
  rig::Board board(bench);
  bench.run(board, 0.001);
  bench.send(Type::kLimits, 1, limits());
  bench.run(board, 0.05);
  CHECK(board.state() == rig::State::kReady && bench.pulse == 1500);
  bench.current = 5000;  // nothing runs
  bench.run(board, 0.2);
  CHECK(bench.saw(rig::EventCode::kOvercurrent) && board.state() == rig::State::kLatched && bench.pulse == 0);
  bench.current = 0;
  bench.send(Type::kLimits, 2, limits());
  bench.send(Type::kPoints, 3, points(0, 24, 100000));
  bench.send(Type::kStart, 4, body<std::uint64_t, std::uint32_t, std::uint32_t>(bench.now_us + 50000, 20000, 24));
  bench.send(Type::kNeutral, 5, {});
  bench.send(Type::kHello, 6, body<std::uint8_t>(rig::kProtocolVersion));
  bench.run(board, 0.1);
  CHECK(bench.count(Type::kNak) == 2 && board.state() == rig::State::kLatched && bench.pulse == 0);
  bench.send(Type::kClear, 7, {});
  bench.run(board, 0.05);
  CHECK(board.state() == rig::State::kUnarmed && bench.pulse == 0);

  const auto start = [&](std::uint8_t sequence) {
    bench.send(Type::kStart, sequence, body<std::uint64_t, std::uint32_t, std::uint32_t>(bench.now_us + 50000, 20000, 48));
    bench.run(board, 0.1);
  };
  bench.send(Type::kLimits, 8, limits());
  bench.run(board, 0.05);
  bench.send(Type::kPoints, 9, points(0, 24, 100000));
  bench.send(Type::kPoints, 10, points(24, 24, 100000));
  start(11);
  CHECK(board.state() == rig::State::kPlaying);
  bench.send(Type::kNeutral, 12, {});
  bench.run(board, 0.2);
  const int refused = bench.count(Type::kNak);
  start(13);
  CHECK(bench.count(Type::kNak) == refused + 1 && board.state() == rig::State::kReady);
  bench.send(Type::kClear, 14, {});
  bench.send(Type::kPoints, 15, points(0, 24, 100000));
  bench.send(Type::kPoints, 16, points(24, 24, 100000));
  start(17);
  CHECK(bench.count(Type::kNak) == refused + 1 && board.state() == rig::State::kPlaying);
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

// A line that loses frames brings points late and twice: they are played in order, the first that came of each.
void check_points_in_any_order() {
  Bench bench;
  rig::Board board(bench);
  bench.run(board, 0.001);
  bench.send(Type::kLimits, 1, limits());
  bench.run(board, 0.05);
  const auto start = [&](std::uint8_t sequence) {
    bench.send(Type::kStart, sequence, body<std::uint64_t, std::uint32_t, std::uint32_t>(bench.now_us + 50000, 20000, 72));
    bench.run(board, 0.005);
  };
  bench.send(Type::kPoints, 2, points(48, 24, 300000));
  bench.send(Type::kPoints, 3, points(4, 20, 300000));
  start(4);
  CHECK(bench.count(Type::kNak) == 1);  // the first four are missing: it does not start
  bench.send(Type::kPoints, 5, points(0, 4, 300000));
  bench.send(Type::kPoints, 6, points(0, 4, -300000));  // these are there already
  bench.send(Type::kPoints, 7, points(2040, 8, 300000));
  bench.send(Type::kPoints, 8, points(2041, 8, 300000));  // one more than the queue holds
  bench.send(Type::kPoints, 9, points(0xFFFFFFFF, 8, 300000));
  bench.run(board, 0.005);
  CHECK(bench.count(Type::kNak) == 3);
  start(10);
  CHECK(bench.count(Type::kNak) == 3);
  for (int i = 0; i < 3; ++i) {
    bench.send(Type::kPing, 0, body<std::uint32_t>(7));
    bench.run(board, 0.1);
  }
  CHECK(bench.pulse == 1500 + 191);  // 0.3 rad, whichever came second
  for (int i = 0; i < 10; ++i) {
    bench.send(Type::kPing, 0, body<std::uint32_t>(7));
    bench.run(board, 0.1);
  }
  CHECK(bench.saw(rig::EventCode::kUnderrun) && !bench.saw(rig::EventCode::kComplete));  // 24 to 47 never came
  CHECK(bench.pulse == 1500);
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
  check_latch();
  check_repeated_command();
  check_points_in_any_order();
  check_cell();
  fuzz(random, false, seed);
  fuzz(mutated, true, seed);
  std::puts("core: all checks passed");
  return 0;
}
