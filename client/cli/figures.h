// What `--stats` holds, as a small table for people.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace meshfront {

// A few lines: counts before and after, shape, error bound, time, memory. Leaves out what the JSON lacks.
std::string FiguresTable(const nlohmann::ordered_json& stats);

}  // namespace meshfront
