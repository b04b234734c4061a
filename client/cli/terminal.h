// Whether somebody is looking.
#pragma once

#include <unistd.h>

#include <iostream>

namespace meshfront {

inline bool IsTerminal(const std::ostream& stream) {
  return isatty(&stream == &std::cout ? STDOUT_FILENO : STDERR_FILENO) == 1;
}

}  // namespace meshfront
