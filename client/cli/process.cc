#include "client/cli/process.h"

#include <pthread.h>
#include <signal.h>
#include <time.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <fstream>
#include <mutex>
#include <sstream>
#include <string>
#include <thread>

#include "client/cli/exit_code.h"

namespace meshfront {
namespace {

const auto kLoaded = std::chrono::steady_clock::now();

// Field 22 of /proc/self/stat, in clock ticks since boot; 0 when it can't be had.
double StartedSecondsAfterBoot() {
  std::ifstream file("/proc/self/stat");
  std::string text((std::istreambuf_iterator<char>(file)), {});
  const size_t name_end = text.rfind(')');  // the name before it may hold anything
  if (name_end == std::string::npos) return 0;
  std::istringstream fields(text.substr(name_end + 1));
  std::string field;
  constexpr int start_time = 22, first = 3;
  for (int i = first; i <= start_time; ++i) fields >> field;
  return std::strtod(field.c_str(), nullptr) / sysconf(_SC_CLK_TCK);
}

}  // namespace

double SecondsSinceProcessStart() {
  const double since_loaded = std::chrono::duration<double>(std::chrono::steady_clock::now() - kLoaded).count();
  timespec now;
  static const double started = StartedSecondsAfterBoot();
  if (started <= 0 || clock_gettime(CLOCK_BOOTTIME, &now) != 0) return since_loaded;
  return std::max(since_loaded, now.tv_sec + 1e-9 * now.tv_nsec - started);
}

uint64_t PeakRssBytes() {
  std::ifstream file("/proc/self/status");  // getrusage would count the parent's memory before exec
  std::string line;
  while (std::getline(file, line)) {
    if (line.rfind("VmHWM:", 0) == 0) return std::strtoull(line.c_str() + 6, nullptr, 10) * 1024;
  }
  return 0;
}

struct Interruption::State {
  std::mutex mutex;
  std::function<void()> handler;
  std::atomic<bool> requested{false};
  sigset_t signals, before;
  std::thread waiter;

  static constexpr int kWakeUp = SIGUSR2;

  void Wait() {
    for (;;) {
      int signal = 0;
      if (sigwait(&signals, &signal) != 0) continue;
      if (signal == kWakeUp) return;
      const std::lock_guard<std::mutex> lock(mutex);
      if (!handler || requested.exchange(true)) _exit(static_cast<int>(ExitCode::kCancelled));
      handler();
    }
  }
};

Interruption::Interruption() : state_(std::make_unique<State>()) {
  sigemptyset(&state_->signals);
  sigaddset(&state_->signals, State::kWakeUp);
  // SIGINT even where it is ignored: a shell does that to the background jobs of a script, which sends it on purpose.
  for (const int signal : {SIGINT, SIGTERM}) sigaddset(&state_->signals, signal);
  struct sigaction action;  // nohup had us ignore SIGHUP: that stays
  if (sigaction(SIGHUP, nullptr, &action) == 0 && action.sa_handler != SIG_IGN) sigaddset(&state_->signals, SIGHUP);
  pthread_sigmask(SIG_BLOCK, &state_->signals, &state_->before);
  state_->waiter = std::thread([state = state_.get()] { state->Wait(); });
}

Interruption::~Interruption() {
  pthread_kill(state_->waiter.native_handle(), State::kWakeUp);
  state_->waiter.join();
  pthread_sigmask(SIG_SETMASK, &state_->before, nullptr);
}

void Interruption::OnSignal(std::function<void()> handler) {
  const std::lock_guard<std::mutex> lock(state_->mutex);
  state_->handler = std::move(handler);
}

bool Interruption::requested() const { return state_->requested; }

}  // namespace meshfront
