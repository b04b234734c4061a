#include "core/io/links.h"

#include <unistd.h>

#include <climits>
#include <cstdlib>

namespace meshfront {
namespace {

constexpr int kMostLinks = 40;  // as the system

std::string FolderOf(const std::string& path) {
  const size_t slash = path.rfind('/');
  return slash == std::string::npos ? "." : slash == 0 ? "/" : path.substr(0, slash);
}

}  // namespace

std::string FileBehindLinks(const std::string& path) {
  char real[PATH_MAX];
  if (::realpath(path.c_str(), real) != nullptr) return real;
  std::string name = path;
  for (int links = 0; links < kMostLinks; ++links) {
    char target[PATH_MAX];
    const ssize_t length = ::readlink(name.c_str(), target, sizeof target);
    if (length <= 0) {  // no link: a file to be made
      if (::realpath(FolderOf(name).c_str(), real) == nullptr) return path;
      const std::string folder = real;
      return (folder == "/" ? "" : folder) + "/" + name.substr(name.rfind('/') + 1);
    }
    const std::string next(target, length);
    name = next[0] == '/' ? next : FolderOf(name) + "/" + next;
  }
  return path;
}

}  // namespace meshfront
