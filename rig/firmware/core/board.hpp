// The board: answers the host, plays set points, samples, and goes to neutral when anything is wrong.
#pragma once
#include <cstddef>
#include <cstdint>

#include "hardware.hpp"
#include "hx711.hpp"
#include "messages.hpp"
#include "player.hpp"
#include "samples.hpp"
#include "servo.hpp"
#include "wire.hpp"

namespace rig {

constexpr std::uint64_t kWatchdogUs = 250000;      // silence of the host that ends a run
constexpr std::uint64_t kOvercurrentUs = 100000;   // a stall current is tolerated for so long (start-up peaks)

class Board {
 public:
  explicit Board(Hardware& hardware) : hardware_(hardware) {}

  // Call as often as possible, at least every millisecond; never blocks.
  void step();

  State state() const { return state_; }
  const Servo& servo() const { return servo_; }

 private:
  void receive(std::uint64_t now_us);
  void handle(const Frame& command, std::uint64_t now_us);
  Reason execute(const Frame& command, std::uint64_t now_us);  // 0: done
  Reason take_limits(Reader& in);
  Reason take_points(Reader& in, std::size_t size);
  Reason take_start(Reader& in, std::uint64_t now_us);
  void resend(Reader& in);

  void sample_cell(std::uint64_t now_us);
  void servo_frame(std::uint64_t now_us);
  void watch(std::uint64_t now_us);
  void watch_current(std::uint16_t current, std::uint64_t now_us);
  void to_neutral(EventCode why, std::int32_t value, std::uint64_t now_us);
  void event(EventCode code, std::int32_t value, std::uint64_t now_us);
  void add(const Sample& sample);

  void send(const Frame& frame);
  void send_answer(const Frame& command, Reason reason);
  void send_boot(std::uint8_t sequence, std::uint64_t now_us);
  void flush();

  Hardware& hardware_;
  Clock clock_;
  Parser parser_;
  Servo servo_;
  Player player_;
  Hx711 cell_;
  Samples samples_;
  State state_ = State::kUnarmed;
  bool booted_ = false;
  bool streaming_ = false;
  bool clipped_ = false;
  bool stale_ = false;  // what is queued is of a run that has ended
  std::uint64_t heard_us_ = 0;
  std::uint64_t next_servo_us_ = 0;
  std::uint64_t current_high_since_us_ = 0;
  std::uint64_t flash_until_us_ = 0;
  std::uint32_t bad_frames_ = 0;
  bool answered_ = false;       // the last command's answer is kept: a repeated command is answered, not repeated (POINTS may be)
  std::uint8_t last_type_ = 0;
  std::uint8_t last_sequence_ = 0;
  Reason last_reason_ = Reason{};
  static constexpr std::size_t kOutCapacity = 8192;
  std::uint8_t out_[kOutCapacity] = {};
  std::size_t out_first_ = 0, out_size_ = 0;
};

}  // namespace rig
