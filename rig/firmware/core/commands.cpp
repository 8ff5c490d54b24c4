// What the board does with each command, and what it answers.
#include "board.hpp"

namespace rig {

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
  Reader in(command);
  switch (static_cast<Type>(command.type)) {
    case Type::kPing: {
      const auto token = in.get<std::uint32_t>();
      if (!in.complete()) return;
      Frame answer;
      answer.type = static_cast<std::uint8_t>(Type::kPong);
      answer.sequence = command.sequence;
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
      if (servo_.armed()) to_neutral(EventCode::kStopped, 0, now_us);
      player_.clear();
      stale_ = false;
      streaming_ = false;
      answered_ = false;
      return send_boot(command.sequence, now_us);
    }
    default: break;
  }
  if (command.type == static_cast<std::uint8_t>(Type::kPoints)) return send_answer(command, take_points(in, command.size));
  const bool repeated = answered_ && last_sequence_ == command.sequence && last_type_ == command.type;
  if (!repeated) {
    last_reason_ = execute(command, now_us);
    last_sequence_ = command.sequence;
    last_type_ = command.type;
    answered_ = true;
  }
  send_answer(command, last_reason_);
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
      stale_ = false;
      if (state_ == State::kLatched) state_ = State::kUnarmed;
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
  if (state_ == State::kLatched) return Reason::kLatched;
  if (player_.running() || !servo_.at_neutral()) return Reason::kBusy;  // new limits never move a deflected arm
  servo_.arm(limits);
  player_.clear();  // what was queued was checked against the old limits
  stale_ = false;
  state_ = State::kReturning;
  return Reason{};
}

Reason Board::take_points(Reader& in, std::size_t size) {
  const auto index = in.get<std::uint32_t>();
  const auto count = in.get<std::uint8_t>();
  if (count == 0 || size != 5u + 4u * count) return Reason::kBadLength;
  if (!servo_.armed() && state_ != State::kLatched) return Reason::kNoLimits;  // those under way at a fault do no harm
  if (!player_.has_room_for(index, count)) return Reason::kQueueFull;
  std::int32_t points[kMaxBody / 4];
  for (unsigned i = 0; i < count; ++i) {
    points[i] = in.get<std::int32_t>();
    if (!servo_.limits().contains(points[i])) return Reason::kOutsideLimits;
  }
  for (unsigned i = 0; i < count; ++i) player_.put(index + i, points[i]);
  return Reason{};
}

Reason Board::take_start(Reader& in, std::uint64_t now_us) {
  const auto at_us = in.get<std::uint64_t>();
  const auto period_us = in.get<std::uint32_t>();
  const auto total = in.get<std::uint32_t>();
  if (!in.complete()) return Reason::kBadLength;
  if (state_ == State::kLatched) return Reason::kLatched;
  if (!servo_.armed()) return Reason::kNoLimits;
  if (stale_) return Reason::kNotCleared;
  if (state_ != State::kReady) return Reason::kBusy;
  if (at_us < now_us || at_us > now_us + 60000000u || period_us < 1000u || total < 2) return Reason::kBadStart;
  const std::uint32_t ahead = total < 10 ? total : 10;
  if (player_.end() < ahead) return Reason::kTooFewPoints;
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

}  // namespace rig
