// What the program knows of its own process: age, memory, and that somebody wants it to end.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

namespace meshfront {

// Seconds of wall time since the process was started (before main; 10 ms resolution).
double SecondsSinceProcessStart();
// Largest resident memory of the process so far.
uint64_t PeakRssBytes();

// Takes over Ctrl-C, SIGTERM and SIGHUP for its lifetime. Created before any other thread, so that they inherit the blocked signals.
// Until OnSignal gives a handler, a signal ends the process with exit code 6; afterwards the first one runs the handler, on a thread of
// its own, and the second ends the process.
class Interruption {
 public:
  Interruption();
  ~Interruption();
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;

  void OnSignal(std::function<void()> handler);
  bool requested() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace meshfront
