// Plays set points that the host streams ahead of time: linear between points, stopped where the next one has not come.
#pragma once
#include <cstddef>
#include <cstdint>

namespace rig {

class Player {
 public:
  static constexpr std::uint32_t kCapacity = 2048;  // 41 s at 50 Hz
  enum class Step { kIdle, kWaiting, kAngle, kComplete, kUnderrun };

  void clear();
  std::uint32_t end() const { return end_; }  // all points before this one have come
  std::uint32_t room() const { return kCapacity - (end_ - first_); }
  std::uint32_t played() const { return first_; }
  bool running() const { return running_; }

  // Points come in any order, as the line lets them through: up to kCapacity ahead of the oldest still needed.
  bool has_room_for(std::uint32_t index, std::uint32_t count) const {
    return std::uint64_t{index} + count <= std::uint64_t{first_} + kCapacity;
  }
  // The caller has checked that there is room. A point that has come already, or was played, stays as it was.
  void put(std::uint32_t index, std::int32_t urad);
  // `total` >= 2 points, one each `period_us` from `at_us`.
  void start(std::uint64_t at_us, std::uint32_t period_us, std::uint32_t total);
  void stop() { running_ = false; }
  Step step(std::uint64_t now_us, std::int32_t& urad);

 private:
  std::int32_t points_[kCapacity] = {};
  bool here_[kCapacity] = {};
  std::uint32_t first_ = 0, end_ = 0;  // indices of the oldest point still needed, and of the first that is missing
  bool running_ = false;
  std::uint64_t at_us_ = 0;
  std::uint32_t period_us_ = 0, total_ = 0;
};

}  // namespace rig
