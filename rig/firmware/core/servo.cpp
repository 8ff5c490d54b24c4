#include "servo.hpp"

namespace rig {

std::int32_t Limits::pulse(std::int32_t urad) const {
  const std::int64_t offset = static_cast<std::int64_t>(urad) * us_per_rad;
  return static_cast<std::int32_t>(centre_us + (offset + (offset >= 0 ? 500000 : -500000)) / 1000000);
}

bool Limits::usable() const {
  if (min_urad < -kHardAngle || max_urad > kHardAngle || min_urad > 0 || max_urad < 0 || min_urad >= max_urad) return false;
  if (speed_urad_s == 0 || speed_urad_s > kHardSpeed || current_ma == 0 || us_per_rad == 0) return false;
  const std::int32_t ends[] = {pulse(min_urad), pulse(0), pulse(max_urad)};
  for (const std::int32_t end : ends)
    if (end < kHardPulseMin || end > kHardPulseMax) return false;
  return true;
}

void Servo::arm(const Limits& limits) {
  limits_ = limits;
  armed_ = true;
}

void Servo::release(Hardware& hardware) {
  armed_ = false;
  angle_urad_ = 0;
  pulse_us_ = 0;
  hardware.servo_off();
}

std::int32_t Servo::frame_step_us(std::int64_t step_urad) const {
  const std::int64_t slope = limits_.us_per_rad < 0 ? -limits_.us_per_rad : limits_.us_per_rad;
  return static_cast<std::int32_t>(step_urad * slope / 1000000 + 1);  // the pin counts whole microseconds
}

bool Servo::move(Hardware& hardware, std::int32_t target_urad) {
  if (!armed_) return false;  // no limits, no pulse: a servo without pulses is limp
  std::int64_t wanted = target_urad;
  if (wanted < limits_.min_urad) wanted = limits_.min_urad;
  if (wanted > limits_.max_urad) wanted = limits_.max_urad;
  const std::int64_t step = static_cast<std::int64_t>(limits_.speed_urad_s) * kServoFrameUs / 1000000;
  const std::int64_t difference = wanted - angle_urad_;
  if (difference > step) wanted = angle_urad_ + step;
  if (difference < -step) wanted = angle_urad_ - step;
  angle_urad_ = static_cast<std::int32_t>(wanted);

  std::int32_t pulse = limits_.pulse(angle_urad_);
  if (pulse_us_ != 0) {  // the speed limit holds at the pin too, when new limits have moved the centre
    const std::int32_t stride = frame_step_us(step);
    if (pulse > pulse_us_ + stride) pulse = pulse_us_ + stride;
    if (pulse < pulse_us_ - stride) pulse = pulse_us_ - stride;
  }
  if (pulse < kHardPulseMin) pulse = kHardPulseMin;
  if (pulse > kHardPulseMax) pulse = kHardPulseMax;
  pulse_us_ = static_cast<std::uint16_t>(pulse);
  hardware.servo_pulse(pulse_us_);
  return wanted != target_urad;
}

}  // namespace rig
