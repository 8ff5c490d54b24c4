// A pty that looks like the board's serial port. A symbolic link keeps its name over unplugging and replugging.
#pragma once
#include <fcntl.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <string>

class Port {
 public:
  explicit Port(std::string link) : link_(std::move(link)) {}
  ~Port() { unplug(); }
  Port(const Port&) = delete;
  Port& operator=(const Port&) = delete;

  bool plug() {
    master_ = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
    if (master_ < 0 || grantpt(master_) != 0 || unlockpt(master_) != 0) return false;
    const char* name = ptsname(master_);
    // Held open here too: otherwise the pty reads as hung up until, and after, a host has it open.
    slave_ = open(name, O_RDWR | O_NOCTTY);
    termios raw{};
    if (slave_ < 0 || tcgetattr(slave_, &raw) != 0) return false;
    cfmakeraw(&raw);
    tcsetattr(slave_, TCSANOW, &raw);
    const std::string fresh = link_ + ".new";
    ::unlink(fresh.c_str());
    return symlink(name, fresh.c_str()) == 0 && rename(fresh.c_str(), link_.c_str()) == 0;
  }

  void unplug() {
    if (master_ >= 0) close(master_);
    if (slave_ >= 0) close(slave_);
    master_ = slave_ = -1;
    ::unlink(link_.c_str());
  }

  int descriptor() const { return master_; }  // -1 while unplugged

  long receive(std::uint8_t* buffer, std::size_t size) { return master_ < 0 ? -1 : ::read(master_, buffer, size); }
  // Bytes that nobody takes are lost, as on a real UART.
  void transmit(const std::uint8_t* bytes, std::size_t size) {
    if (master_ >= 0 && ::write(master_, bytes, size) < 0 && errno != EAGAIN) std::perror("pty");
  }

 private:
  std::string link_;
  int master_ = -1, slave_ = -1;
};
