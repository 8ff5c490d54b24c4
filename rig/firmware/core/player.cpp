#include "player.hpp"

namespace rig {

void Player::clear() {
  first_ = end_ = 0;
  for (bool& here : here_) here = false;
  running_ = false;
}

void Player::put(std::uint32_t index, std::int32_t urad) {
  if (index < end_ || here_[index % kCapacity]) return;
  points_[index % kCapacity] = urad;
  here_[index % kCapacity] = true;
  while (room() > 0 && here_[end_ % kCapacity]) ++end_;
}

void Player::start(std::uint64_t at_us, std::uint32_t period_us, std::uint32_t total) {
  at_us_ = at_us;
  period_us_ = period_us;
  total_ = total;
  running_ = true;
}

Player::Step Player::step(std::uint64_t now_us, std::int32_t& urad) {
  if (!running_) return Step::kIdle;
  if (now_us < at_us_) return Step::kWaiting;
  const std::uint64_t elapsed = now_us - at_us_;
  const std::uint64_t index = elapsed / period_us_;
  if (index + 1 >= total_) {
    running_ = false;
    return Step::kComplete;
  }
  const auto k = static_cast<std::uint32_t>(index);
  if (k + 1 >= end_) {
    running_ = false;
    return Step::kUnderrun;
  }
  for (; first_ < k; ++first_) here_[first_ % kCapacity] = false;
  const std::int64_t from = points_[k % kCapacity], to = points_[(k + 1) % kCapacity];
  const auto into = static_cast<std::int64_t>(elapsed % period_us_);
  urad = static_cast<std::int32_t>(from + (to - from) * into / period_us_);
  return Step::kAngle;
}

}  // namespace rig
