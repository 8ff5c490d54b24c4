#include "hx711.hpp"

namespace rig {
namespace {

constexpr std::uint64_t kReadyTimeoutUs = 400000;  // four conversions at the slow rate (85.6 ms) and a margin
constexpr std::uint64_t kRestartPauseUs = 100;     // power-down takes 60 us of a high clock
constexpr std::uint32_t kStretchedUs = 50;
constexpr std::uint8_t kGoodReadings = 4;

// Shifts out 24 bits and sends the 25th pulse. Interrupts are masked for one bit at a time, not for the whole read.
std::uint32_t shift_out(Hardware& hardware, bool& stretched) {
  std::uint32_t bits = 0;
  for (int pulse = 0; pulse < 25; ++pulse) {
    hardware.interrupts(false);
    const std::uint32_t rise = hardware.micros();
    hardware.cell_clock(true);
    const bool bit = hardware.cell_data();
    hardware.cell_clock(false);
    stretched |= hardware.micros() - rise > kStretchedUs;
    hardware.interrupts(true);
    if (pulse < 24) bits = (bits << 1) | (bit ? 1u : 0u);
  }
  return bits;
}

}  // namespace

bool Hx711::changed(CellError& error) {
  error = error_;
  const bool was = changed_;
  changed_ = false;
  return was;
}

void Hx711::fail(CellError error, std::uint64_t now_us) {
  changed_ |= error_ != error;
  error_ = error;
  held_ = false;
  warm_up_ = kGoodReadings;
  restart_due_ = true;
  last_seen_us_ = now_us;
}

bool Hx711::restart(Hardware& hardware, std::uint64_t now_us) {
  if (!restart_due_) return true;
  if (!powered_down_) {
    hardware.cell_clock(true);
    powered_down_ = true;
    power_down_us_ = now_us;
    return false;
  }
  if (now_us - power_down_us_ < kRestartPauseUs) return false;
  hardware.cell_clock(false);
  powered_down_ = false;
  restart_due_ = false;
  last_seen_us_ = now_us;
  return true;
}

int Hx711::poll(Hardware& hardware, std::uint64_t now_us, CellReading out[2]) {
  if (!begun_) {
    begun_ = true;
    last_seen_us_ = now_us;
  }
  if (!restart(hardware, now_us)) return 0;
  if (hardware.cell_data()) {  // high: still converting
    if (now_us - last_seen_us_ > kReadyTimeoutUs) fail(held_ ? CellError::kWentSilent : CellError::kNotReady, now_us);
    return 0;
  }
  bool stretched = false;
  const std::uint32_t bits = shift_out(hardware, stretched);
  if (stretched) return fail(CellError::kStretched, now_us), 0;
  if (!hardware.cell_data()) return fail(CellError::kGainBits, now_us), 0;
  if (bits == 0x7FFFFFu || bits == 0x800000u) return fail(CellError::kSaturated, now_us), 0;
  last_seen_us_ = now_us;

  if (warm_up_ > 0) {
    if (--warm_up_ > 0 || error_ == CellError::kNone) return 0;
    error_ = CellError::kNone;
    changed_ = true;
    return 0;
  }
  int count = 0;
  if (held_) out[count++] = held_reading_;
  const CellReading reading{now_us, static_cast<std::int32_t>(bits << 8) / 256};
  held_ = bits == 0xFFFFFFu;  // -1 count, or a chip that has died: the next conversion tells
  if (held_)
    held_reading_ = reading;
  else
    out[count++] = reading;
  return count;
}

}  // namespace rig
