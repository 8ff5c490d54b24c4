// The board's core behind a pty. Speaks on stdout ("ready", answers), is told of faults on stdin, ends when stdin ends.
//   rig_host --link PATH [--trace PATH] [--seed N] [--rate R] [--skew-ppm P] [--period-us U] [--offset COUNTS]
//            [--counts-per-newton C] [--noise-counts S] [--plant-in FD --plant-out FD --plant-step-s S]
#include <poll.h>
#include <time.h>

#include <csignal>
#include <cstdio>
#include <cstring>
#include <iostream>
#include <map>
#include <memory>
#include <new>
#include <sstream>
#include <string>


#include "../core/board.hpp"
#include "simulated.hpp"

namespace {

double host_seconds() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

std::map<std::string, std::string> options(int count, char** words) {
  std::map<std::string, std::string> found;
  for (int i = 1; i + 1 < count; i += 2) found[words[i]] = words[i + 1];
  return found;
}

double number(const std::map<std::string, std::string>& given, const std::string& name, double otherwise) {
  const auto at = given.find(name);
  return at == given.end() ? otherwise : std::stod(at->second);
}

constexpr double kStepUs = 250;  // the core is stepped four times a millisecond of board time
constexpr double kUsPerRadian = 2000.0 / 3.14159265358979;

}  // namespace

int main(int count, char** words) {
  const auto given = options(count, words);
  if (given.find("--link") == given.end()) {
    std::fputs("rig_host: --link PATH is needed\n", stderr);
    return 2;
  }
  std::signal(SIGPIPE, SIG_IGN);
  const auto seed = static_cast<std::uint64_t>(number(given, "--seed", 1));
  CellSettings cell;
  cell.period_us = number(given, "--period-us", cell.period_us);
  cell.offset = number(given, "--offset", cell.offset);
  cell.counts_per_newton = number(given, "--counts-per-newton", cell.counts_per_newton);
  cell.noise_counts = number(given, "--noise-counts", cell.noise_counts);

  std::unique_ptr<Plant> plant;
  if (given.count("--plant-in") != 0)
    plant = std::make_unique<PipePlant>(static_cast<int>(number(given, "--plant-in", 0)),
                                        static_cast<int>(number(given, "--plant-out", 0)),
                                        number(given, "--plant-step-s", 0.002));
  else
    plant = std::make_unique<Paddle>();

  Port port(given.at("--link"));
  Trace trace;
  if (!port.plug()) return std::perror("rig_host: pty"), 2;
  if (given.count("--trace") != 0 && !trace.open(given.at("--trace"))) return std::perror("rig_host: trace"), 2;
  Simulated hardware(port, *plant, cell, seed);
  hardware.boot = static_cast<std::uint32_t>(seed * 2654435761u + 1);
  auto board = std::make_unique<rig::Board>(hardware);

  TraceState truth;
  truth.rate = number(given, "--rate", 1) * (1.0 + 1e-6 * number(given, "--skew-ppm", 0));
  truth.boot_offset_us = 1e6 * number(given, "--boot-s", 3);
  plant->advance(0, 0, false);  // it may have to compile first; time starts when it has answered
  truth.host_zero_s = host_seconds();
  double time_us = 0, hung_n = 0;
  hardware.now_us = truth.boot_offset_us;

  const auto obey = [&](const std::string& line) -> bool {
    std::istringstream in(line);
    std::string verb;
    double a = 0, b = 0, c = 0;
    in >> verb >> a >> b >> c;
    if (verb == "quit") return false;
    if (verb == "unplug") port.unplug();
    else if (verb == "replug") port.plug();
    else if (verb == "reset") {
      hardware.reset();
      board = std::make_unique<rig::Board>(hardware);
    } else if (verb == "line") {
      for (ByteFaults* faults : {&hardware.from_host, &hardware.to_host}) {
        faults->corrupt = a;
        faults->drop = b;
        faults->twice = c;
      }
    } else if (verb == "mute") hardware.mute_until_us = hardware.now_us + 1e6 * a;
    else if (verb == "cell_off") hardware.chip.stuck = a != 0;
    else if (verb == "cell_glitch") hardware.stretch = 12;  // the 12th clock pulse from now is stretched
    else if (verb == "load") hung_n = a;
    else if (verb == "jam") hardware.jammed = a != 0;
    else std::printf("unknown %s\n", verb.c_str());
    std::printf("done %s\n", verb.c_str());
    std::fflush(stdout);
    return true;
  };

  std::printf("ready\n");
  std::fflush(stdout);
  std::string typed;
  int since_publish = 0;
  for (;;) {
    // Woken by bytes at once; they are handled at the board time at which they came.
    pollfd waiting[2] = {{0, POLLIN, 0}, {port.descriptor(), POLLIN, 0}};
    const timespec nap{0, 1000000};
    const bool woken = ppoll(waiting, 2, &nap, nullptr) > 0;
    if (woken && waiting[0].revents != 0) {
      char buffer[256];
      const ssize_t got = read(0, buffer, sizeof buffer);
      if (got <= 0) return 0;
      typed.append(buffer, static_cast<std::size_t>(got));
      for (std::size_t end; (end = typed.find('\n')) != std::string::npos; typed.erase(0, end + 1))
        if (!obey(typed.substr(0, end))) return 0;
    }
    const double until_us = 1e6 * truth.rate * (host_seconds() - truth.host_zero_s);
    // After a long stop of this process bytes are read early, lest the watchdog bite for the computer's sake.
    const bool stalled = until_us - time_us > 50000;
    while (time_us < until_us) {
      const double left_us = until_us - time_us;
      time_us += left_us < kStepUs ? left_us : kStepUs;
      const double board_us = truth.boot_offset_us + time_us;
      if (board_us > hardware.now_us) hardware.now_us = board_us;
      const bool armed = hardware.pulse_us != 0;
      plant->advance(1e-6 * time_us, armed ? (hardware.pulse_us - 1500.0) / kUsPerRadian : 0.0, armed);
      hardware.chip.advance(hardware.now_us, plant->state().force_n + hung_n);
      if (stalled || left_us <= kStepUs) hardware.receive();
      board->step();
      hardware.transmit();
      if (++since_publish % 4 != 0) continue;
      truth.board_us = hardware.now_us;
      truth.led_on_us = hardware.led_on_us;
      truth.led_off_us = hardware.led_off_us;
      truth.pulse_us = hardware.pulse_us;
      truth.pulse_since_us = hardware.pulse_since_us;
      truth.conversions = static_cast<double>(hardware.chip.conversions());
      truth.boots = hardware.boots;
      truth.plant = plant->state();
      trace.publish(truth);
    }
  }
}
