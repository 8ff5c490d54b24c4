// Message types, states, reasons and events of protocol version 1. rig/protocol.py says the same in Python.
#pragma once
#include <cstdint>

namespace rig {

constexpr std::uint8_t kProtocolVersion = 1;

enum class Type : std::uint8_t {
  // host to board
  kHello = 0x01,
  kPing = 0x02,
  kLimits = 0x03,
  kStream = 0x04,
  kPoints = 0x05,
  kStart = 0x06,
  kNeutral = 0x07,
  kFlash = 0x08,
  kResend = 0x09,
  kClear = 0x0A,
  // board to host
  kBoot = 0x81,
  kAck = 0x82,
  kNak = 0x83,
  kPong = 0x84,
  kLoad = 0x85,
  kServo = 0x86,
  kEvent = 0x87,
  kGone = 0x88,
};

enum class Reason : std::uint8_t {
  kUnknownType = 1,
  kBadLength = 2,
  kBadVersion = 3,
  kNoLimits = 4,
  kBadLimits = 5,
  kOutsideLimits = 6,
  kQueueFull = 7,
  kTooFewPoints = 8,
  kBadStart = 9,
  kBusy = 10,
  kLatched = 11,     // the servo is off after a fault: CLEAR, then LIMITS
  kNotCleared = 12,  // the queue is of a run that has ended: CLEAR first
};

enum class State : std::uint8_t { kUnarmed = 0, kReady = 1, kWaiting = 2, kPlaying = 3, kReturning = 4, kLatched = 5 };

enum class EventCode : std::uint8_t {
  kStarted = 1,
  kComplete = 2,
  kUnderrun = 3,
  kWatchdog = 4,
  kClipped = 5,
  kOvercurrent = 6,
  kFlashOn = 7,
  kFlashOff = 8,
  kCellError = 9,
  kCellGood = 10,
  kStopped = 11,
};

}  // namespace rig
