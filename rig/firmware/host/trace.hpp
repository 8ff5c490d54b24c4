// What truly happens, in a small shared file: the emulated camera films it and the tests compare with it.
#pragma once
#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <atomic>
#include <cstdint>
#include <cstring>
#include <string>

#include "plant.hpp"

struct TraceState {  // rig/emulator.py reads this layout
  std::uint64_t sequence = 0;  // odd while being written
  double host_zero_s = 0;      // CLOCK_MONOTONIC at board time 0 (before the boot offset)
  double rate = 1;             // board seconds per host second, skew included
  double boot_offset_us = 0;   // the board's microseconds at host_zero_s
  double board_us = 0;
  double led_on_us = -1, led_off_us = -1;  // the last flash; off < on while lit
  double pulse_us = 0, pulse_since_us = 0;
  double conversions = 0, boots = 0;
  PlantState plant;
};

// Where the arm was of late: a camera's frame is drawn after its exposure, by a process that may come late.
constexpr int kPast = 512;  // half a second of board time
struct TracePast {
  double board_us = -1;
  double points[kPlantPoints][2] = {};
};

class Trace {
 public:
  bool open(const std::string& path) {
    const int file = ::open(path.c_str(), O_RDWR | O_CREAT | O_TRUNC, 0600);
    constexpr std::size_t size = sizeof(TraceState) + kPast * sizeof(TracePast);
    if (file < 0 || ftruncate(file, size) != 0) return false;
    void* memory = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    ::close(file);
    if (memory == MAP_FAILED) return false;
    shared_ = static_cast<TraceState*>(memory);
    past_ = reinterpret_cast<TracePast*>(shared_ + 1);
    for (int i = 0; i < kPast; ++i) past_[i] = TracePast{};
    return true;
  }
  void publish(TraceState& state) {
    if (shared_ == nullptr) return;
    auto* sequence = reinterpret_cast<std::atomic<std::uint64_t>*>(&shared_->sequence);
    const std::uint64_t number = sequence->load(std::memory_order_relaxed);
    sequence->store(number + 1, std::memory_order_release);
    std::atomic_thread_fence(std::memory_order_seq_cst);
    state.sequence = number + 1;
    std::memcpy(reinterpret_cast<char*>(shared_) + sizeof(std::uint64_t),
                reinterpret_cast<const char*>(&state) + sizeof(std::uint64_t), sizeof(TraceState) - sizeof(std::uint64_t));
    TracePast& slot = past_[(number / 2) % kPast];
    slot.board_us = state.board_us;
    std::memcpy(slot.points, state.plant.points, sizeof slot.points);
    std::atomic_thread_fence(std::memory_order_seq_cst);
    sequence->store(number + 2, std::memory_order_release);
  }

 private:
  TraceState* shared_ = nullptr;
  TracePast* past_ = nullptr;
};
