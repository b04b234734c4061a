// Runs the program as a user does: in a folder of its own, and looks at what it leaves.
#pragma once

#include <sys/resource.h>

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "gtest/gtest.h"

namespace meshfront::testing {

struct Outcome {
  int exit_code = -1;  // 128 + n when signal n ended it
  std::string out, err;
};

// Every test gets a folder, which is the program's working folder.
class ProgramTest : public ::testing::Test {
 protected:
  ProgramTest();
  ~ProgramTest() override;

  // `meshfront ARGUMENTS…`; `in` is its standard input.
  Outcome Run(const std::vector<std::string>& arguments, const std::string& in = "") const;
  // The same, with no more address space than `bytes`.
  Outcome RunWithin(uint64_t bytes, const std::vector<std::string>& arguments) const;
  // The same as Run, with `during` called with its process id while it runs.
  Outcome RunWith(const std::vector<std::string>& arguments, const std::function<void(int pid)>& during) const;

  std::string PathOf(const std::string& name) const { return folder_ + "/" + name; }
  bool Exists(const std::string& name) const;
  std::string Contents(const std::string& name) const;
  // Names in the folder, in order.
  std::vector<std::string> Files() const;

 private:
  Outcome Collect(int pid) const;
  int Spawn(const std::vector<std::string>& arguments, uint64_t address_space = RLIM_INFINITY) const;

  std::string folder_, captured_;
};

}  // namespace meshfront::testing
