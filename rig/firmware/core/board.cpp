#include "board.hpp"

namespace rig {

void Board::step() {
  const std::uint64_t now_us = clock_.now(hardware_);
  if (!booted_) {
    booted_ = true;
    heard_us_ = now_us;
    next_servo_us_ = now_us;
    hardware_.led(false);
    send_boot(0, now_us);
  }
  receive(now_us);
  sample_cell(now_us);
  if (flash_until_us_ != 0 && now_us >= flash_until_us_) {
    flash_until_us_ = 0;
    hardware_.led(false);
    event(EventCode::kFlashOff, 0, now_us);
  }
  watch(now_us);
  if (now_us >= next_servo_us_) {
    next_servo_us_ += kServoFrameUs;
    if (now_us > next_servo_us_) next_servo_us_ = now_us + kServoFrameUs;  // after a long stop: do not hurry after it
    servo_frame(now_us);
  }
  flush();
}

// ---- sampling ----

void Board::add(const Sample& sample) {
  const std::uint32_t number = samples_.add(sample);
  Frame frame;
  samples_.frame(number, frame);
  send(frame);
}

void Board::event(EventCode code, std::int32_t value, std::uint64_t now_us) {
  add({Type::kEvent, now_us, value, 0, static_cast<std::uint16_t>(code), 0});
}

void Board::sample_cell(std::uint64_t now_us) {
  CellReading readings[2];
  const int count = cell_.poll(hardware_, now_us, readings);
  CellError error;
  if (cell_.changed(error)) {
    const bool good = error == CellError::kNone;
    event(good ? EventCode::kCellGood : EventCode::kCellError, static_cast<std::int32_t>(error), now_us);
  }
  if (!streaming_) return;
  for (int i = 0; i < count; ++i) add({Type::kLoad, readings[i].time_us, readings[i].counts, 0, 0, 0});
}

// ---- motion ----

void Board::servo_frame(std::uint64_t now_us) {
  if (!servo_.armed()) return;
  std::int32_t target = 0;
  switch (player_.step(now_us, target)) {
    case Player::Step::kAngle:
      if (state_ == State::kWaiting) {
        state_ = State::kPlaying;
        event(EventCode::kStarted, 0, now_us);
      }
      break;
    case Player::Step::kComplete: to_neutral(EventCode::kComplete, 0, now_us); break;
    case Player::Step::kUnderrun: to_neutral(EventCode::kUnderrun, static_cast<std::int32_t>(player_.played()), now_us); break;
    case Player::Step::kWaiting:
    case Player::Step::kIdle: break;
  }
  const bool held_back = servo_.move(hardware_, target);
  if (state_ == State::kPlaying && held_back && !clipped_) {
    clipped_ = true;
    event(EventCode::kClipped, target, now_us);
  }
  if (state_ == State::kReturning && servo_.at_neutral()) state_ = State::kReady;

  std::int32_t measured = kNoAngle;
  if (!hardware_.servo_angle(measured)) measured = kNoAngle;
  const std::uint16_t current = hardware_.servo_current_ma();
  if (streaming_) add({Type::kServo, now_us, servo_.angle_urad(), measured, servo_.pulse_us(), current});

  watch_current(current, now_us);
}

// In every state: a servo that stalls at neutral burns as well as one in a run. It stays off until it is told otherwise.
void Board::watch_current(std::uint16_t current, std::uint64_t now_us) {
  if (current <= servo_.limits().current_ma) {
    current_high_since_us_ = 0;
  } else if (current_high_since_us_ == 0) {
    current_high_since_us_ = now_us;
  } else if (now_us - current_high_since_us_ > kOvercurrentUs) {
    current_high_since_us_ = 0;
    servo_.release(hardware_);
    to_neutral(EventCode::kOvercurrent, current, now_us);
    state_ = State::kLatched;
  }
}

void Board::watch(std::uint64_t now_us) {
  if (player_.running() && now_us - heard_us_ > kWatchdogUs)
    to_neutral(EventCode::kWatchdog, static_cast<std::int32_t>((now_us - heard_us_) / 1000u), now_us);
}

void Board::to_neutral(EventCode why, std::int32_t value, std::uint64_t now_us) {
  player_.stop();
  stale_ = true;
  if (state_ != State::kLatched) state_ = servo_.armed() ? State::kReturning : State::kUnarmed;
  event(why, value, now_us);
}

// ---- sending ----

void Board::send_boot(std::uint8_t sequence, std::uint64_t now_us) {
  Frame frame;
  frame.type = static_cast<std::uint8_t>(Type::kBoot);
  frame.sequence = sequence;
  Writer(frame)
      .put(kProtocolVersion)
      .put(hardware_.boot_id())
      .put(now_us)
      .put(kHardPulseMin)
      .put(kHardPulseMax)
      .put(kHardAngle)
      .put(kHardSpeed)
      .put(static_cast<std::uint32_t>(kWatchdogUs))
      .put(samples_.next());
  send(frame);
}

void Board::send_answer(const Frame& command, Reason reason) {
  const bool done = reason == Reason{};
  Frame answer;
  answer.type = static_cast<std::uint8_t>(done ? Type::kAck : Type::kNak);
  answer.sequence = command.sequence;
  Writer out(answer);
  out.put(command.type);
  if (!done) out.put(static_cast<std::uint8_t>(reason));
  send(answer);
}

void Board::send(const Frame& frame) {
  std::uint8_t bytes[kMaxFrame];
  const std::size_t size = encode(frame, bytes);
  if (size > kOutCapacity - out_size_) return;  // a whole frame or none; a lost sample can be asked for again
  for (std::size_t i = 0; i < size; ++i) out_[(out_first_ + out_size_++) % kOutCapacity] = bytes[i];
}

void Board::flush() {
  while (out_size_ > 0) {
    const std::size_t until_end = kOutCapacity - out_first_;
    const std::size_t taken = hardware_.write_bytes(out_ + out_first_, out_size_ < until_end ? out_size_ : until_end);
    if (taken == 0) return;
    out_first_ = (out_first_ + taken) % kOutCapacity;
    out_size_ -= taken;
  }
}

}  // namespace rig
