// Where a name leads to when it is a symbolic link.
#pragma once

#include <string>

namespace meshfront {

// The file that would be written through `path`: symbolic links are followed, the last one also to a file that is not there
// yet, and its folder has no link, "." or ".." in it. Two names of one file give the same. The path itself where its folder
// does not exist or the links go round in circles.
std::string FileBehindLinks(const std::string& path);

}  // namespace meshfront
