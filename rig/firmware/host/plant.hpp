// What the servo moves and the load cell feels: a small stand-in here, or a process behind a pipe (the MuJoCo arm).
#pragma once
#include <poll.h>
#include <unistd.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

constexpr int kPlantPoints = 24;

struct PlantState {
  double angle_rad = 0;   // the servo's true angle
  double force_n = 0;     // what the load cell feels, along +y of the base frame
  double current_ma = 0;
  double points[kPlantPoints][2] = {};  // the midline, base frame [m], base to tip
};

class Plant {
 public:
  virtual ~Plant() = default;
  // Brings the plant to `to_s` with the servo commanded to `command_rad` (limp while not armed).
  virtual void advance(double to_s, double command_rad, bool armed) = 0;
  const PlantState& state() const { return state_; }

 protected:
  PlantState state_;
};

// Two rigid links in water: the first turned by the servo, the second on a spring. Quadratic normal drag on both, and
// added mass in the hinge's inertia. Enough to swim, to ring and to have a best gait; no model of a soft arm.
class Paddle : public Plant {
 public:
  void advance(double to_s, double command_rad, bool armed) override {
    while (time_s_ < to_s) step(command_rad, armed);
  }

 private:
  static constexpr double kStep = 0.0005, kLink = 0.07, kRadius = 0.008, kWater = 998.0, kDrag = 1.1;
  static constexpr double kSpring = 4e-3, kDamping = 1e-5, kInertia = 3.4e-5;  // N m/rad, N m s/rad, kg m^2
  static constexpr int kNodes = 6;

  void step(double command_rad, bool armed) {
    // Position servo: critically damped, 25 rad/s, as a small digital servo under load.
    const double wanted = armed ? command_rad : state_.angle_rad;
    const double acceleration = 625.0 * (wanted - state_.angle_rad) - 50.0 * rate_;
    rate_ += kStep * acceleration;
    state_.angle_rad += kStep * rate_;

    double torque = 0, force = 0;
    const double theta = state_.angle_rad, phi = theta + bend_;
    for (int link = 0; link < 2; ++link) {
      const double angle = link == 0 ? theta : phi, turning = link == 0 ? rate_ : rate_ + bend_rate_;
      for (int node = 0; node < kNodes; ++node) {
        const double along = kLink * (node + 0.5) / kNodes;
        const double carried = link == 0 ? 0.0 : kLink * rate_;
        const double normal_speed = carried * std::cos(bend_) + turning * along;
        const double drag = kWater * kDrag * kRadius * std::fabs(normal_speed) * normal_speed * kLink / kNodes;
        force += drag * std::sin(angle);  // turning onward moves a link along -n; the drag is along n = (cos, sin) phi
        if (link == 1) torque -= drag * along;
      }
    }
    const double hinge = torque - kSpring * bend_ - kDamping * bend_rate_ - kInertia * acceleration;
    bend_rate_ += kStep * hinge / kInertia;
    bend_ += kStep * bend_rate_;
    state_.force_n = force;
    state_.current_ma = 30.0 + 2.0 * std::fabs(acceleration);
    time_s_ += kStep;
    for (int i = 0; i < kPlantPoints; ++i) {
      const double along = 2.0 * kLink * i / (kPlantPoints - 1), first = std::fmin(along, kLink), second = along - first;
      state_.points[i][0] = -first * std::sin(theta) - second * std::sin(phi);
      state_.points[i][1] = first * std::cos(theta) + second * std::cos(phi);
    }
  }

  double time_s_ = 0, rate_ = 0, bend_ = 0, bend_rate_ = 0;
};

// A process that keeps step: it reads (to_s, command_rad, armed) and writes a PlantState, as native doubles. It is one step
// ahead, under the command of that step's begin; in between the state is interpolated.
class PipePlant : public Plant {
 public:
  PipePlant(int from, int to, double step_s) : from_(from), to_(to), step_s_(step_s) {}

  void advance(double to_s, double command_rad, bool armed) override {
    while (steps_ == 0 || to_s > static_cast<double>(steps_) * step_s_) {
      before_ = after_;
      ask(static_cast<double>(++steps_) * step_s_, command_rad, armed);
      if (steps_ == 1) before_ = after_;
    }
    const double share = 1.0 + to_s / step_s_ - static_cast<double>(steps_);
    const auto between = [share](double from, double to) { return from + share * (to - from); };
    state_.angle_rad = between(before_.angle_rad, after_.angle_rad);
    state_.force_n = between(before_.force_n, after_.force_n);
    state_.current_ma = between(before_.current_ma, after_.current_ma);
    for (int i = 0; i < kPlantPoints; ++i)
      for (int k = 0; k < 2; ++k) state_.points[i][k] = between(before_.points[i][k], after_.points[i][k]);
  }

 private:
  void ask(double to_s, double command_rad, bool armed) {
    const double request[3] = {to_s, command_rad, armed ? 1.0 : 0.0};
    if (::write(to_, request, sizeof request) != static_cast<ssize_t>(sizeof request)) leave();
    auto* bytes = reinterpret_cast<char*>(&after_);
    for (std::size_t have = 0; have < sizeof after_;) {
      const ssize_t got = ::read(from_, bytes + have, sizeof after_ - have);
      if (got <= 0) leave();
      have += static_cast<std::size_t>(got);
    }
  }
  [[noreturn]] static void leave() {
    std::fputs("the plant's process has ended\n", stderr);
    std::exit(3);
  }
  int from_, to_;
  double step_s_;
  std::uint64_t steps_ = 0;
  PlantState before_, after_;
};
