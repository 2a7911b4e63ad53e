#pragma once
#include "supple/io/json_node.h"
#include "supple/material/material.h"

namespace supple::io {

inline constexpr double kMostPascal = 1e15;

/// A hyperelastic law by its name: its keys, checked. mu_pa and lambda_pa may also be given as young_pa and poisson.
/// @param law  StVenantKirchhoff, NeoHookean, StableNeoHookean, MooneyRivlin, ArrudaBoyce, VerondaWestman or Ogden
Material read_hyperelastic(const JsonNode& node, const std::string& law);

}  // namespace supple::io
