// The JSON of `--stats` and of `estimate --json`: stable keys, fixed by the contract.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "meshfront/v1/events.pb.h"
#include "meshfront/v1/remesh_service.pb.h"

namespace meshfront {

// What the client measures itself. Seconds of wall time.
struct ClientFigures {
  double read = 0, upload = 0, first_chunk = 0, engine = 0, write = 0, total = 0;
  uint64_t peak_rss_bytes = 0;
  uint64_t chunks = 0;
  bool remote = false;  // the summary's peak memory is another process's
};

// `version` is the client's.
nlohmann::ordered_json StatsJson(const std::string& version, const v1::Summary& summary, const ClientFigures& client);
// One element of "lods": the same keys where they are a level's own.
nlohmann::ordered_json LevelJson(const std::string& file, const v1::Summary& summary, const ClientFigures& client);
nlohmann::ordered_json EstimateJson(const v1::EstimateResponse& estimate);

}  // namespace meshfront
