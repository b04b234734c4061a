// Levels of detail at the command line: where each goes, and when it is to be shown.
#pragma once

#include <string>
#include <vector>

#include "meshfront/v1/events.pb.h"

namespace meshfront {

// Where level `level` goes when each has a file of its own: "a/b.ply.gz" is "a/b.lod1.ply.gz".
std::string LevelPath(const std::string& out, size_t level);

// MSFT_screencoverage of each level: it is shown until, with the error bound of the one after it, that one is a pixel off on a screen of
// 1000. Falling, the first at most 0.5, the last 0: the coarsest is never hidden.
std::vector<double> ScreenCoverages(const std::vector<v1::Summary>& levels);

}  // namespace meshfront
