// Plays set points that the host streams ahead of time: linear between points, stopped by an empty queue.
#pragma once
#include <cstddef>
#include <cstdint>

namespace rig {

class Player {
 public:
  static constexpr std::uint32_t kCapacity = 2048;  // 41 s at 50 Hz
  enum class Step { kIdle, kWaiting, kAngle, kComplete, kUnderrun };

  void clear();
  std::uint32_t next_index() const { return end_; }
  std::uint32_t room() const { return kCapacity - (end_ - first_); }
  std::uint32_t played() const { return first_; }
  bool running() const { return running_; }

  // The caller has checked that there is room.
  void push(std::int32_t urad) { points_[end_++ % kCapacity] = urad; }
  // `total` >= 2 points, one each `period_us` from `at_us`.
  void start(std::uint64_t at_us, std::uint32_t period_us, std::uint32_t total);
  void stop() { running_ = false; }
  Step step(std::uint64_t now_us, std::int32_t& urad);

 private:
  std::int32_t points_[kCapacity] = {};
  std::uint32_t first_ = 0, end_ = 0;  // indices of the oldest point still needed, and of the next to come
  bool running_ = false;
  std::uint64_t at_us_ = 0;
  std::uint32_t period_us_ = 0, total_ = 0;
};

}  // namespace rig
