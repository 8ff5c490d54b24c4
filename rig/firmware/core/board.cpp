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

// ---- commands ----

void Board::receive(std::uint64_t now_us) {
  Frame frame;
  for (int budget = 256; budget > 0; --budget) {
    const int byte = hardware_.read_byte();
    if (byte < 0) return;
    switch (parser_.take(static_cast<std::uint8_t>(byte), frame)) {
      case Parsed::kFrame:
        heard_us_ = now_us;
        handle(frame, now_us);
        break;
      case Parsed::kBad: ++bad_frames_; break;
      case Parsed::kNothing: break;
    }
  }
}

void Board::handle(const Frame& command, std::uint64_t now_us) {
  Frame answer;
  answer.sequence = command.sequence;
  Reader in(command);
  switch (static_cast<Type>(command.type)) {
    case Type::kPing: {
      const auto token = in.get<std::uint32_t>();
      if (!in.complete()) return;
      answer.type = static_cast<std::uint8_t>(Type::kPong);
      Writer(answer)
          .put(token)
          .put(now_us)
          .put(hardware_.boot_id())
          .put(static_cast<std::uint8_t>(state_))
          .put(static_cast<std::uint16_t>(player_.room()))
          .put(player_.played())
          .put(samples_.next())
          .put(bad_frames_);
      return send(answer);
    }
    case Type::kResend: return resend(in);
    case Type::kHello: {
      const auto version = in.get<std::uint8_t>();
      if (!in.complete() || version != kProtocolVersion) break;  // answered below, with the reason
      if (state_ != State::kUnarmed) to_neutral(EventCode::kStopped, 0, now_us);
      player_.clear();
      streaming_ = false;
      answered_ = false;
      return send_boot(command.sequence, now_us);
    }
    default: break;
  }
  const bool repeated = answered_ && last_sequence_ == command.sequence && last_type_ == command.type;
  if (!repeated) {
    last_reason_ = execute(command, now_us);
    last_sequence_ = command.sequence;
    last_type_ = command.type;
    answered_ = true;
  }
  const bool done = last_reason_ == Reason{};
  answer.type = static_cast<std::uint8_t>(done ? Type::kAck : Type::kNak);
  Writer out(answer);
  out.put(command.type);
  if (!done) out.put(static_cast<std::uint8_t>(last_reason_));
  send(answer);
}

Reason Board::execute(const Frame& command, std::uint64_t now_us) {
  Reader in(command);
  switch (static_cast<Type>(command.type)) {
    case Type::kHello: return command.size == 1 ? Reason::kBadVersion : Reason::kBadLength;
    case Type::kLimits: return take_limits(in);
    case Type::kStream: {
      const auto on = in.get<std::uint8_t>();
      if (!in.complete()) return Reason::kBadLength;
      streaming_ = on != 0;
      return Reason{};
    }
    case Type::kPoints: return take_points(in, command.size);
    case Type::kStart: return take_start(in, now_us);
    case Type::kNeutral:
      if (!in.complete()) return Reason::kBadLength;
      if (servo_.armed()) to_neutral(EventCode::kStopped, 0, now_us);
      return Reason{};
    case Type::kFlash: {
      const auto milliseconds = in.get<std::uint16_t>();
      if (!in.complete()) return Reason::kBadLength;
      if (flash_until_us_ != 0) return Reason::kBusy;
      hardware_.led(true);
      flash_until_us_ = now_us + 1000u * static_cast<std::uint64_t>(milliseconds) + 1;
      event(EventCode::kFlashOn, milliseconds, now_us);
      return Reason{};
    }
    case Type::kClear:
      if (!in.complete()) return Reason::kBadLength;
      if (player_.running()) return Reason::kBusy;
      player_.clear();
      return Reason{};
    default: return Reason::kUnknownType;
  }
}

Reason Board::take_limits(Reader& in) {
  Limits limits;
  limits.min_urad = in.get<std::int32_t>();
  limits.max_urad = in.get<std::int32_t>();
  limits.speed_urad_s = in.get<std::uint32_t>();
  limits.current_ma = in.get<std::uint16_t>();
  limits.centre_us = in.get<std::uint16_t>();
  limits.us_per_rad = in.get<std::int16_t>();
  if (!in.complete()) return Reason::kBadLength;
  if (!limits.usable()) return Reason::kBadLimits;
  if (player_.running() || !servo_.at_neutral()) return Reason::kBusy;  // new limits never move a deflected arm
  servo_.arm(limits);
  player_.clear();  // what was queued was checked against the old limits
  state_ = State::kReturning;
  return Reason{};
}

Reason Board::take_points(Reader& in, std::size_t size) {
  const auto index = in.get<std::uint32_t>();
  const auto count = in.get<std::uint8_t>();
  if (count == 0 || size != 5u + 4u * count) return Reason::kBadLength;
  if (!servo_.armed()) return Reason::kNoLimits;
  if (index != player_.next_index()) return Reason::kBadIndex;
  if (count > player_.room()) return Reason::kQueueFull;
  std::int32_t points[kMaxBody / 4];
  for (unsigned i = 0; i < count; ++i) {
    points[i] = in.get<std::int32_t>();
    if (!servo_.limits().contains(points[i])) return Reason::kOutsideLimits;
  }
  for (unsigned i = 0; i < count; ++i) player_.push(points[i]);
  return Reason{};
}

Reason Board::take_start(Reader& in, std::uint64_t now_us) {
  const auto at_us = in.get<std::uint64_t>();
  const auto period_us = in.get<std::uint32_t>();
  const auto total = in.get<std::uint32_t>();
  if (!in.complete()) return Reason::kBadLength;
  if (!servo_.armed()) return Reason::kNoLimits;
  if (state_ != State::kReady) return Reason::kBusy;
  if (at_us < now_us || at_us > now_us + 60000000u || period_us < 1000u || total < 2) return Reason::kBadStart;
  const std::uint32_t ahead = total < 10 ? total : 10;
  if (player_.next_index() < ahead) return Reason::kTooFewPoints;
  player_.start(at_us, period_us, total);
  state_ = State::kWaiting;
  clipped_ = false;
  return Reason{};
}

void Board::resend(Reader& in) {
  const auto first = in.get<std::uint32_t>();
  const auto count = in.get<std::uint8_t>();
  if (!in.complete()) return;
  std::uint8_t gone = 0;
  Frame frame;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t number = first + i;
    if (!samples_.holds(number)) {
      gone = static_cast<std::uint8_t>(i + 1);
      continue;
    }
    samples_.frame(number, frame);
    send(frame);
  }
  if (gone == 0) return;
  frame.type = static_cast<std::uint8_t>(Type::kGone);
  frame.sequence = 0;
  Writer(frame).put(first).put(gone);
  send(frame);
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

  if (current <= servo_.limits().current_ma) current_high_since_us_ = 0;
  else if (current_high_since_us_ == 0) current_high_since_us_ = now_us;
  else if (now_us - current_high_since_us_ > kOvercurrentUs && player_.running())
    to_neutral(EventCode::kOvercurrent, current, now_us);
}

void Board::watch(std::uint64_t now_us) {
  if (player_.running() && now_us - heard_us_ > kWatchdogUs)
    to_neutral(EventCode::kWatchdog, static_cast<std::int32_t>((now_us - heard_us_) / 1000u), now_us);
}

void Board::to_neutral(EventCode why, std::int32_t value, std::uint64_t now_us) {
  player_.stop();
  state_ = servo_.armed() ? State::kReturning : State::kUnarmed;
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
