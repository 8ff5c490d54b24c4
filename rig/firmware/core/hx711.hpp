// HX711 load-cell amplifier, channel A, gain 128 (25 clock pulses a reading), with the rules that keep bad readings out.
#pragma once
#include <cstdint>

#include "hardware.hpp"

namespace rig {

enum class CellError : std::uint8_t {
  kNone = 0,
  kNotReady = 1,      // no conversion within 400 ms: unplugged, or powered down
  kGainBits = 2,      // DOUT did not return high after the 25th pulse: bits were lost or gained
  kStretched = 3,     // a clock pulse stayed high over 50 us: at 60 us the chip powers down and the rest reads as ones
  kSaturated = 4,     // at an end of the 24-bit range
  kWentSilent = 5,    // all ones, and then no further conversion: the read had failed
};

struct CellReading {
  std::uint64_t time_us = 0;
  std::int32_t counts = 0;
};

// After an error the chip is restarted (power-down, then up) and four good readings pass before one is reported.
class Hx711 {
 public:
  // Reads when a conversion waits. Puts 0, 1 or 2 readings in `out` and returns how many; changed() tells of errors.
  int poll(Hardware& hardware, std::uint64_t now_us, CellReading out[2]);
  CellError error() const { return error_; }
  // The error state when it has changed since the last call (kNone: good again).
  bool changed(CellError& error);
  std::uint64_t last_good_us() const { return last_seen_us_; }

 private:
  void fail(CellError error, std::uint64_t now_us);
  bool restart(Hardware& hardware, std::uint64_t now_us);

  CellError error_ = CellError::kNone;
  bool changed_ = false;
  bool begun_ = false;
  bool powered_down_ = false;
  bool restart_due_ = false;
  std::uint8_t warm_up_ = 4;  // readings still to be passed over; also at power-up (settling, data sheet)
  std::uint64_t last_seen_us_ = 0;
  std::uint64_t power_down_us_ = 0;
  bool held_ = false;  // an all-ones reading waits for the next conversion to prove that the chip lives
  CellReading held_reading_;
};

}  // namespace rig
