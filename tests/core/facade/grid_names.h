// Names for the cases of a grid of shapes × rho × eta.
#pragma once

#include <cmath>
#include <string>
#include <tuple>

#include "gtest/gtest.h"

namespace meshfront::testing {

// "CubeRho50Eta120". `Shape` has a name.
template <class Shape>
std::string NameOfGridCase(const ::testing::TestParamInfo<std::tuple<Shape, double, double>>& info) {
  const auto digits = [](double x) { return std::to_string(static_cast<int>(std::lround(100 * x))); };
  return std::get<0>(info.param).name + "Rho" + digits(std::get<1>(info.param)) + "Eta" +
         digits(std::get<2>(info.param));
}

}  // namespace meshfront::testing
