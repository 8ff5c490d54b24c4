// The servo pin: the only place that writes a pulse, and it obeys the limits whatever the rest of the board asks for.
#pragma once
#include <cstdint>

#include "hardware.hpp"

namespace rig {

// Limits of the build, not of a run: no message widens them. Pulses that every hobby servo survives.
constexpr std::uint16_t kHardPulseMin = 900, kHardPulseMax = 2100;  // us
constexpr std::int32_t kHardAngle = 1600000;                        // urad
constexpr std::uint32_t kHardSpeed = 20000000;                      // urad/s
constexpr std::uint32_t kServoFrameUs = 20000;                      // 50 Hz

struct Limits {
  std::int32_t min_urad = 0, max_urad = 0;
  std::uint32_t speed_urad_s = 0;
  std::uint16_t current_ma = 0;
  std::uint16_t centre_us = 0;      // pulse at angle 0
  std::int16_t us_per_rad = 0;      // negative where the servo turns the other way

  bool usable() const;
  bool contains(std::int64_t urad) const { return urad >= min_urad && urad <= max_urad; }
  std::int32_t pulse(std::int32_t urad) const;
};

class Servo {
 public:
  // Takes limits that are usable(). From then on every frame puts out a pulse; before it the servo is limp.
  void arm(const Limits& limits);
  // Ends the pulses until it is armed again.
  void release(Hardware& hardware);
  bool armed() const { return armed_; }
  const Limits& limits() const { return limits_; }

  // One servo frame: moves towards `target_urad` as far as angle and speed limits let it. True if they held it back.
  bool move(Hardware& hardware, std::int32_t target_urad);

  std::int32_t angle_urad() const { return angle_urad_; }
  std::uint16_t pulse_us() const { return pulse_us_; }
  bool at_neutral() const { return angle_urad_ == 0 && (!armed_ || pulse_us_ == limits_.pulse(0)); }

 private:
  std::int32_t frame_step_us(std::int64_t step_urad) const;

  bool armed_ = false;
  Limits limits_;
  std::int32_t angle_urad_ = 0;
  std::uint16_t pulse_us_ = 0;
};

}  // namespace rig
