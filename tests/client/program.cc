#include "tests/client/program.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

namespace meshfront::testing {
namespace {

std::string NewFolder() {
  std::string name = ::testing::TempDir() + "meshfront_program_XXXXXX";
  return mkdtemp(name.data());
}

std::string ReadFile(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void Redirect(const std::string& path, int flags, int descriptor) { dup2(open(path.c_str(), flags, 0600), descriptor); }

}  // namespace

ProgramTest::ProgramTest() : folder_(NewFolder()), captured_(NewFolder()) {}

ProgramTest::~ProgramTest() {
  std::filesystem::remove_all(folder_);
  std::filesystem::remove_all(captured_);
}

int ProgramTest::Spawn(const std::vector<std::string>& arguments, uint64_t address_space) const {
  const int pid = fork();
  if (pid != 0) return pid;
  std::vector<char*> argv = {const_cast<char*>("meshfront")};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  if (chdir(folder_.c_str()) != 0) _exit(127);
  Redirect(captured_ + "/in", O_RDONLY, STDIN_FILENO);
  Redirect(captured_ + "/out", O_WRONLY | O_CREAT | O_TRUNC, STDOUT_FILENO);
  Redirect(captured_ + "/err", O_WRONLY | O_CREAT | O_TRUNC, STDERR_FILENO);
  const rlimit limit{address_space, address_space};
  if (address_space != RLIM_INFINITY && setrlimit(RLIMIT_AS, &limit) != 0) _exit(127);
  execv(MESHFRONT_PROGRAM, argv.data());
  _exit(127);
}

Outcome ProgramTest::Collect(int pid) const {
  int status = 0;
  waitpid(pid, &status, 0);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), ReadFile(captured_ + "/out"),
          ReadFile(captured_ + "/err")};
}

Outcome ProgramTest::Run(const std::vector<std::string>& arguments, const std::string& in) const {
  std::ofstream(captured_ + "/in", std::ios::binary) << in;
  return Collect(Spawn(arguments));
}

Outcome ProgramTest::RunWith(const std::vector<std::string>& arguments,
                             const std::function<void(int pid)>& during) const {
  std::ofstream(captured_ + "/in").flush();
  const int pid = Spawn(arguments);
  during(pid);
  return Collect(pid);
}

Outcome ProgramTest::RunWithin(uint64_t bytes, const std::vector<std::string>& arguments) const {
  std::ofstream(captured_ + "/in").flush();
  return Collect(Spawn(arguments, bytes));
}

bool ProgramTest::Exists(const std::string& name) const { return std::filesystem::exists(PathOf(name)); }
std::string ProgramTest::Contents(const std::string& name) const { return ReadFile(PathOf(name)); }

std::vector<std::string> ProgramTest::Files() const {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder_)) names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace meshfront::testing
