// The version of the server and its engine, from CMake.
#pragma once

namespace meshfront {

inline constexpr char kVersion[] = MESHFRONT_VERSION;

}  // namespace meshfront
