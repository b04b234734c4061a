// The version of the project, from CMake.
#pragma once

namespace meshfront {

inline constexpr char kClientVersion[] = MESHFRONT_VERSION;

}  // namespace meshfront
